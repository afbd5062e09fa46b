"""Parts of a submodular function as sets of robots see them in one plan: what robots add in an order."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.errors import InputError

if TYPE_CHECKING:
    from collections.abc import Callable

    from ratt_opt._validation import BoolArray, FloatArray, IntArray
    from ratt_opt.attack.task import PlanValues
    from ratt_opt.setfunctions.base import SetFunction

__all__ = ["PlanPart", "parts_of_plan", "refuse_larger_gain"]


class PlanPart:
    """One part of the value of a plan's sets of robots.

    ``robots`` : (k,) whose elements touch it, ascending; ``weight`` : its factor in the sum
    ``evaluate`` : maps sets (K, k) of these robots to (K,) values
    """

    def __init__(
        self, robots: IntArray, weight: float, n_robots: int, evaluate: Callable[[BoolArray], FloatArray]
    ) -> None:
        self.robots, self.weight = robots, weight
        self._n, self._evaluate = n_robots, evaluate
        self._table: FloatArray | None = None
        self.most = float(np.ptp(self._values(np.array([np.zeros(len(robots)), np.ones(len(robots))]) > 0)))
        """Value of all robots beyond that of none."""

    def gains(self, order: IntArray) -> FloatArray:
        """(N,) what each robot adds to those before it in an order (N,)."""
        k, gains = len(self.robots), np.zeros(self._n)
        position = np.empty(self._n, dtype=np.int64)
        position[order] = np.arange(self._n)
        own = np.argsort(position[self.robots], kind="stable")
        sets = np.zeros((k + 1, k), dtype=np.bool_)
        sets[1:, own] = np.tri(k, dtype=np.bool_)
        gains[self.robots[own]] = np.diff(self._values(sets))
        return gains

    def _values(self, sets: BoolArray) -> FloatArray:
        k = len(self.robots)
        if k > 10:  # all sets of ten robots are valued at once, and kept: some kilobytes
            return self._evaluate(sets)
        if self._table is None:
            self._table = self._evaluate((np.arange(2**k)[:, None] >> np.arange(k) & 1).astype(np.bool_))
        return np.asarray(self._table[sets @ (1 << np.arange(k))])


def parts_of_plan(values: PlanValues, f: SetFunction) -> list[PlanPart]:
    """The parts that some robot of the plan touches; all of the function as one if its parts are not known."""
    parts, n = f.decomposition(), values.n
    if parts is None or not parts.is_sum:
        return [PlanPart(np.arange(n), 1.0, n, values.evaluate)]
    found = []
    for j in range(parts.n_parts):
        touching = parts.touching(j)
        robots = np.flatnonzero(np.isin(values.plan, touching))
        if len(robots) and parts.weights[j] > 0:
            own = np.searchsorted(touching, values.plan[robots])

            def evaluate(sets: BoolArray, j: int = j, own: IntArray = own, width: int = len(touching)) -> FloatArray:
                membership = np.zeros((len(sets), width), dtype=np.bool_)
                membership[:, own] = sets
                return np.asarray(parts.part_values(j, membership), dtype=np.float64)

            found.append(PlanPart(robots, float(parts.weights[j]), n, evaluate))
    return found


def refuse_larger_gain(f: SetFunction, more: IntArray, fewer: IntArray, element: int) -> None:
    """Refuse a function that says it is submodular if an element adds more to more elements than to fewer of these.

    Raises ``InputError`` with the sets, from which all elements are left out without which that is still so.
    """
    larger, smaller = set(more.tolist()), set(fewer.tolist())
    if _excess(f, larger, smaller, element) <= 0:
        return
    for one in more.tolist():
        if _excess(f, larger - {one}, smaller - {one}, element) > 0:
            larger, smaller = larger - {one}, smaller - {one}
    a, b, slack = sorted(larger), sorted({*smaller, element}), -_excess(f, larger, smaller, element)
    shown = f"f(A) + f(B) - f(A | B) - f(A & B) = {slack:.6g} for A = {a}, B = {b}"
    raise InputError("f", "must be submodular, as it says (is_submodular = True)", shown)


def _excess(f: SetFunction, more: set[int], fewer: set[int], element: int) -> float:
    """Excess of what an element adds to the larger set, if it is no rounding; else 0."""
    larger, smaller = (f([*base, element]) - f(base) for base in (more, fewer))
    least = f.least_improvement(abs(larger) + abs(smaller), terms=4)
    return larger - smaller if larger > smaller + least else 0.0
