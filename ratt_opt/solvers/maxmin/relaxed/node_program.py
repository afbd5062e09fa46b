"""The linear program of a search node: the best relaxed plan under all cuts, solved by HiGHS."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.highs import LinearProgram, Rows, rows_of

if TYPE_CHECKING:
    from collections.abc import Callable

    from ratt_opt._validation import BoolArray, FloatArray, IntArray
    from ratt_opt.solvers.maxmin.task import Choices

__all__ = ["NodeProgram", "RelaxedPlan"]

ROUNDING = 1e-12
"""Weights of elements up to this are the simplex method's rounding."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class RelaxedPlan:
    """What the solver claims: ``selection`` (E,) weights of elements, ``duals`` >= 0 weights of ``cuts``."""

    selection: FloatArray
    cuts: IntArray
    duals: FloatArray
    level: float

    def rounded(self, choices: Choices) -> IntArray:
        """(N,) the element of largest weight of each robot."""
        return np.array([choice[self.selection[choice].argmax()] for choice in choices])


class NodeProgram:
    """``max t`` with ``t <= constant_k + scores_k . z`` for the cuts in use, ``sum_e z_e = 1`` for each robot.

    One program for the whole search: nodes differ in column bounds and in the cuts they use, so each
    solve starts from the last basis. Only the multipliers are used; every bound is derived from them anew.
    """

    def __init__(self, n_elements: int, choices: Choices) -> None:
        self._n, self._robots = n_elements, len(choices)
        zeros, ones = np.zeros(n_elements), np.ones(n_elements)
        owners = rows_of([(choice.tolist(), [1.0] * len(choice)) for choice in choices], 1.0, 1.0)
        cost, lower, upper = np.append(zeros, 1.0), np.append(zeros, -np.inf), np.append(ones, np.inf)
        self._program = LinearProgram(cost, lower, upper, rows=owners, maximise=True, solver="simplex")
        self._allowed = np.ones(n_elements, dtype=np.bool_)
        self.in_use: list[int] = []
        """Cuts that are rows now, in row order."""
        self._idle: dict[int, int] = {}
        self._fresh: list[tuple[float, FloatArray]] = []
        """Constants and scores of the last cuts in use, whose rows are added together before the next solve."""

    def use(self, cut: int, constant: float, scores: FloatArray) -> None:
        """Add one cut as a row."""
        self._fresh.append((constant, scores))
        self.in_use.append(cut)
        self._idle[cut] = 0

    def _add_fresh(self) -> None:
        if not self._fresh:
            return
        columns = [np.append(np.flatnonzero(scores), self._n) for _, scores in self._fresh]
        values = [np.append(-scores[own[:-1]], 1.0) for own, (_, scores) in zip(columns, self._fresh, strict=True)]
        rows = Rows(
            lower=np.full(len(columns), -np.inf),
            upper=np.array([constant for constant, _ in self._fresh]),
            starts=np.cumsum([0, *map(len, columns)]),
            columns=np.concatenate(columns),
            values=np.concatenate(values),
        )
        self._program.add_rows(rows)
        self._fresh.clear()

    def drop(self, gone: Callable[[int], bool]) -> None:
        """Remove the rows of cuts for which ``gone`` is true."""
        self._add_fresh()
        positions = [position for position, cut in enumerate(self.in_use) if gone(cut)]
        if positions:
            self._program.delete_rows(np.array(positions) + self._robots)
            for position in positions:
                del self._idle[self.in_use[position]]
            kept = set(positions)
            self.in_use = [cut for position, cut in enumerate(self.in_use) if position not in kept]

    def drop_idle(self, patience: int) -> None:
        """Remove cuts whose multiplier was zero in the last ``patience`` solves."""
        self.drop(lambda cut: self._idle[cut] > patience)

    def allow(self, choices: Choices) -> None:
        """Set which elements may be chosen."""
        allowed: BoolArray = np.zeros(self._n, dtype=np.bool_)
        allowed[np.concatenate(choices)] = True
        for e in np.flatnonzero(allowed != self._allowed).tolist():
            self._program.bound_column(e, 0.0, 1.0 if allowed[e] else 0.0)
        self._allowed = allowed

    def solve(self, seconds: float = np.inf) -> RelaxedPlan | None:
        """Solve within that many seconds and return what HiGHS claims, or ``None`` when it claims no optimum."""
        self._add_fresh()
        claim = self._program.solve(seconds)
        if not claim.is_optimal:
            return None
        duals = np.abs(claim.duals[self._robots :])
        for cut, dual in zip(self.in_use, duals, strict=True):
            self._idle[cut] = 0 if dual > 0 else self._idle[cut] + 1
        columns = claim.x[: self._n]
        selection = np.where(columns > ROUNDING, np.minimum(columns, 1.0), 0.0)
        cuts, level = np.array(self.in_use, dtype=np.int64), float(claim.x[self._n])
        return RelaxedPlan(selection=selection, cuts=cuts, duals=duals, level=level)
