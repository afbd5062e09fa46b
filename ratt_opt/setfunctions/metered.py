"""Budgeted function: values of another one, checked one by one, counted, and computed only while a budget lasts."""

from __future__ import annotations

from dataclasses import dataclass
from time import monotonic
from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.budget import OutOfBudget, Stop
from ratt_opt.running.pace import Pace, PaceParams
from ratt_opt.setfunctions.base import SetFunction, TableFunction, check_table_size, checked_values, finite_values

if TYPE_CHECKING:
    from collections.abc import Callable

    from ratt_opt._validation import BoolArray, FloatArray, IntArray
    from ratt_opt.budget import Budget

__all__ = ["Metered", "metered", "table_within", "unmetered"]

VALUES = PaceParams(first=1, most=2**14)
"""Sets that are valued at once: however fast they are, their memberships stay in cache."""


@dataclass(frozen=True, slots=True, kw_only=True)
class EstimateParams:
    """Parameters of the time estimate of a table, from values of more and more sets at once.

    ``elements`` : tables of fewer are begun at once [1]; ``first``, ``most`` : sets valued together [1]
    ``seconds`` : a batch that takes longer is the last [s]: more is a better estimate that costs more
    ``patience`` : a table that seems to take this many times the seconds left is not begun [1]: more begins tables that
    are not completed, less leaves some that would be
    """

    elements: int = 16
    first: int = 4
    most: int = 2**14
    seconds: float = 0.1
    patience: float = 2.0


ESTIMATE = EstimateParams()


@dataclass(frozen=True, slots=True, kw_only=True)
class MemoryParams:
    """Parameters of what is stored of a function.

    ``at_once`` : sets of a batch whose values are stored, at most [1]: larger ones enumerate, so none comes twice
    ``values`` : stored in all, at most [1]: they stay within some megabytes; beyond, values are computed again
    """

    at_once: int = 2**12
    values: int = 2**17


MEMORY = MemoryParams()


class Metered(SetFunction):
    """``f`` within ``budget``; raises ``OutOfBudget`` instead of asking for a value that it does not allow.

    However slow ``f`` is, few sets are valued at once, so that the clock is looked at in between.
    """

    __slots__ = ("_budget", "_known", "_pace", "f")

    def __init__(self, f: SetFunction, budget: Budget, known: dict[bytes, float] | None = None) -> None:
        self.f, self._budget, self._pace = f, budget, Pace(VALUES)
        self._known: dict[bytes, float] = {} if known is None else known

    def within(self, budget: Budget) -> Metered:
        """Return the function with another budget; values known already cost nothing."""
        return Metered(self.f, budget, self._known)

    @property
    def n(self) -> int:
        """Size of the ground set."""
        return self.f.n

    @property
    def rounding(self) -> float:
        """Rounding of the function itself."""
        return self.f.rounding

    @property
    def most_total_curvature(self) -> float:
        """Bound of the function itself."""
        return self.f.most_total_curvature

    def are_alike(self, elements: IntArray) -> bool:
        """Ask the function itself."""
        return self.f.are_alike(elements)

    def evaluate(self, membership: BoolArray) -> FloatArray:
        """(K,) values of the subsets in the rows of ``membership`` (K, n)."""
        if len(membership) > MEMORY.at_once or len(self._known) > MEMORY.values:
            return self._asked(membership)
        keys = [row.tobytes() for row in np.packbits(membership, axis=1)]
        new = {key: k for k, key in enumerate(keys) if key not in self._known}
        values = self._asked(membership[list(new.values())]) if new else np.empty(0)
        self._known.update(zip(new, values.tolist(), strict=True))
        return np.array([self._known[key] for key in keys])

    def extensions(self, base: IntArray, candidates: IntArray) -> FloatArray:
        """(C,) values ``f(base + {e})``; by the function's own formula, not kept, if it has one."""
        if type(self.f).extensions is SetFunction.extensions:
            return super().extensions(base, candidates)
        return self._in_parts(len(candidates), lambda rows: finite_values(self.f.extensions(base, candidates[rows])))

    def _asked(self, membership: BoolArray) -> FloatArray:
        return self._in_parts(len(membership), lambda rows: checked_values(self.f, membership[rows]))

    def _in_parts(self, count: int, values_of: Callable[[slice], FloatArray]) -> FloatArray:
        """(count,) values, few at once, so that the clock is looked at in between."""
        values, done = np.empty(count), 0
        while done < count:
            self._budget.check()
            rows = int(min(self._pace.units, count - done, self._budget.evaluations_left))
            with self._pace.timed(rows):
                values[done : done + rows] = values_of(slice(done, done + rows))
            self._budget.evaluate(rows)
            done += rows
        return values


def metered(f: SetFunction, budget: Budget) -> Metered:
    """``f`` within a budget; what an earlier one has asked for is known."""
    return f.within(budget) if isinstance(f, Metered) else Metered(f, budget)


def unmetered(f: SetFunction) -> SetFunction:
    """The function itself."""
    return f.f if isinstance(f, Metered) else f


def table_within(f: SetFunction, budget: Budget) -> FloatArray:
    """The full table of ``f``, as fast as it makes it itself; raises ``OutOfBudget`` if the budget is too small."""
    check_table_size(f.n)
    if isinstance(f, TableFunction):
        return f.values
    budget.check()
    if 2.0**f.n > budget.evaluations_left:
        raise OutOfBudget(Stop.EVALUATIONS)
    if f.n >= ESTIMATE.elements and type(f).table_blocks is SetFunction.table_blocks:
        _check_time(f, budget)
    is_fast = type(f).table_blocks is not SetFunction.table_blocks  # it knows better than one set after the other
    done, values = 0, np.empty(2**f.n)
    for block in (f if is_fast else Metered(f, budget)).table_blocks():
        values[done : done + len(block)] = block
        done += len(block)
        if is_fast:
            budget.evaluate(len(block))
            if done < len(values):
                budget.check()
    return values


def _check_time(f: SetFunction, budget: Budget) -> None:
    """Raise ``OutOfBudget`` if a first few values show that a table takes longer than the seconds left."""
    rows = ESTIMATE.first
    while budget.seconds_left < np.inf and budget.evaluations_left == np.inf:
        masks = np.arange(2**f.n - rows, 2**f.n)
        membership = (masks[:, None] >> np.arange(f.n) & 1).astype(np.bool_)
        began = monotonic()
        checked_values(f, membership)
        budget.evaluate(rows)
        budget.check()
        seconds = monotonic() - began
        if seconds > ESTIMATE.seconds or rows >= ESTIMATE.most:
            if seconds / rows * 2.0**f.n > ESTIMATE.patience * budget.seconds_left:
                raise OutOfBudget(Stop.TIME)
            return
        rows *= 4
