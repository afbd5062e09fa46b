"""The linear program of the covers known: is there a relaxed plan that meets them all?

Minimise ``v`` so that every cover counts at least ``enough - v`` and each robot's shares of its elements sum to 1. If
``v > 0``, no plan of the node is worth more than the level. Of the program only the multipliers are used: normalised,
they combine covers into one condition, of which a plan counts at most the sum of its robots' largest terms. Such sums
forbid more than each cover does, and serve the search in depth from then on.
"""

from __future__ import annotations

from ctypes import Structure, c_int64, c_void_p
from typing import TYPE_CHECKING, ClassVar

import numpy as np

from ratt_opt.highs import LinearProgram, rows_of
from ratt_opt.native.library import address, check_numbers, checked
from ratt_opt.solvers.maxmin.proof import CoverLeaf

if TYPE_CHECKING:
    from ratt_opt._validation import BoolArray, FloatArray, IntArray
    from ratt_opt.solvers.maxmin.covers.separation import Separation

__all__ = ["CoverProgram", "CoverSums", "Sums"]

LOWEST = -50.0
"""Of ``v``: how far conditions may be met beyond what is asked counts no further."""
NEGLIGIBLE = 1e-9
"""Multipliers that count as none."""
MOST_ROWS = 400
"""Rows of the program; beyond it, half of the covers go that no multiplier used for longest."""


FIRST_ROOM = 64
MOST_TRIED = 60
"""Sums that are looked at: those that were of most use lately."""
FADING = 0.9
"""How much of earlier use counts when the next one is found."""


class Relaxed:
    """A relaxed plan ``x`` (E,), its ``v``, and the covers with multipliers: numbers, and weights that sum to 1."""

    __slots__ = ("covers", "v", "weights", "x")

    def __init__(self, x: FloatArray, v: float, covers: IntArray, weights: FloatArray) -> None:
        self.x, self.v, self.covers, self.weights = x, v, covers, weights


class CoverProgram:
    """The program over some covers of a pool."""

    def __init__(self, separation: Separation) -> None:
        self.enough, self._count, self._pool = separation.enough, separation.count, separation.pool
        self._n, problem = len(self._count), separation.problem
        cost = np.zeros(self._n + 1)
        cost[-1] = 1.0
        lower = np.zeros(self._n + 1)
        lower[-1] = LOWEST
        upper = np.ones(self._n + 1)
        upper[-1] = np.inf
        one_each = rows_of([(choice.tolist(), [1.0] * len(choice)) for choice in problem.choices], 1.0, 1.0)
        self._program = LinearProgram(cost, lower, upper, rows=one_each, presolve="off", simplex_strategy=1)
        self._first, self._robot = problem.n_robots, problem.robot
        self._rows: list[int] = []
        self._used: dict[int, int] = {}
        self._solves = 0

    def add(self, covers: list[int]) -> int:
        """Add covers that are not in the program yet; how many."""
        known = set(self._rows)
        fresh = [k for k in dict.fromkeys(covers) if k not in known]
        entries = []
        for k in fresh:
            self._used[k] = self._solves
            counted = self._counted(k)
            columns = np.flatnonzero(counted)
            entries.append(([*columns.tolist(), self._n], [*counted[columns].tolist(), 1.0]))
        if fresh:
            self._program.add_rows(rows_of(entries, self.enough))
            self._rows.extend(fresh)
        return len(fresh)

    def solve(self, allowed: BoolArray, seconds: float) -> Relaxed | None:
        """The program over the elements allowed (E,); ``None`` if HiGHS claims no optimum in time."""
        self._forget()
        self._program.bound_columns(np.zeros(self._n), allowed.astype(np.float64))
        answer = self._program.solve(seconds)
        self._solves += 1
        if not answer.is_optimal:
            return None
        duals = answer.duals[self._first :]
        active = np.flatnonzero(duals > NEGLIGIBLE)
        covers = np.array(self._rows, dtype=np.int64)[active]
        for k in covers.tolist():
            self._used[k] = self._solves
        weights = duals[active] / duals[active].sum() if len(active) else duals[active]
        return Relaxed(answer.x[: self._n], float(answer.x[self._n]), covers, weights)

    def lacking(self, relaxed: Relaxed, allowed: BoolArray) -> tuple[float, FloatArray]:
        """By how much all plans of allowed elements fail the combined condition, and what each element counts (E,)."""
        if not len(relaxed.covers):
            return -np.inf, np.zeros(self._n)
        terms = relaxed.weights @ np.array([self._counted(k) for k in relaxed.covers.tolist()])
        largest = np.zeros(self._first)
        np.maximum.at(largest, self._robot[allowed], terms[allowed])
        return self.enough - float(largest.sum()), terms

    def _counted(self, cover: int) -> FloatArray:
        """(E,) what each element counts in a cover."""
        return np.asarray(self._pool.left_out(cover) * self._count)

    def _forget(self) -> None:
        if len(self._rows) <= MOST_ROWS:
            return
        order = sorted(range(len(self._rows)), key=lambda r: self._used[self._rows[r]])
        gone = np.array(sorted(order[: len(order) // 2]))
        self._program.delete_rows(gone + self._first)
        self._rows = [k for r, k in enumerate(self._rows) if r not in set(gone.tolist())]


class SumsRecord(Structure):
    """``Sums`` of ``native/src/covers.h``."""

    _fields_: ClassVar = [("looked_at", c_int64), *((name, c_void_p) for name in ("terms", "tried", "used"))]


class Sums:
    """Sums of covers by number: what each element counts, ``terms`` (R, E), of which plans have to count ``enough``.

    ``tried`` : (A,) those that are looked at; ``used`` : (R,) how often each was of use; it changes

    Raises
    ------
    InputError : a shape or a type is another, or one that is tried is not there.
    """

    def __init__(self, elements: int, terms: FloatArray, tried: IntArray, used: FloatArray) -> None:
        self._arrays = (
            checked("terms", terms, np.float64, (len(used), elements)),
            checked("tried", tried, np.int64, (len(tried),)),
            checked("used", used, np.float64, (len(used),), written=True),
        )
        check_numbers("tried", tried, 0, len(used))
        self.terms, self.record = terms, SumsRecord(len(tried), *map(address, self._arrays))


class CoverSums:
    """Sums by number, with the leaf that each stands for."""

    def __init__(self, elements: int) -> None:
        self._elements, self._terms, self._used = elements, np.zeros((FIRST_ROOM, elements)), np.zeros(FIRST_ROOM)
        self.leaves: list[CoverLeaf] = []

    def add(self, covers: IntArray, weights: FloatArray, terms: FloatArray) -> None:
        """Add the covers' weighted sum; ``terms`` : (E,) what each element counts."""
        number = len(self.leaves)
        if number == len(self._used):
            self._terms = np.concatenate([self._terms, np.zeros_like(self._terms)])
            self._used = np.concatenate([self._used, np.zeros_like(self._used)])
        self._terms[number] = terms
        self._used *= FADING
        self._used[number] = self._used.max() + 1.0
        self.leaves.append(CoverLeaf(covers=tuple(covers.tolist()), weights=tuple(weights.tolist())))

    def rows(self) -> Sums:
        """As the loops of a dive read them."""
        tried = np.argsort(-self._used[: len(self.leaves)], kind="stable")[:MOST_TRIED]
        return Sums(self._elements, self._terms, tried.astype(np.int64), self._used)
