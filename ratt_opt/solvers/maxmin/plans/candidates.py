"""The plans a search has met, ranked by the known outcomes."""

from __future__ import annotations

import heapq
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from ratt_opt._validation import IntArray
    from ratt_opt.solvers.maxmin.plans.outcome_pool import OutcomePool

__all__ = ["Candidates"]


class Candidates:
    """Plans by their value under the known outcomes, an upper bound on their worst case.

    A new outcome may lower the best one's value; then another may become the best.
    """

    def __init__(self, pool: OutcomePool, first: IntArray) -> None:
        self.pool, self._first = pool, first
        self._ranked: list[tuple[float, int, int, IntArray]] = []
        self._met: set[bytes] = set()

    @property
    def level(self) -> float:
        """Value of :attr:`best` under all known outcomes: no plan of a smaller bound is worth looking for."""
        return -self._top()[0]

    @property
    def best(self) -> IntArray:
        """The plan of largest value under all known outcomes; the first met among equals."""
        return self._top()[3]

    def is_better(self, plan: IntArray) -> bool:
        """Whether a plan is worth more than the best one under the known outcomes, by more than rounding."""
        return self.pool.plan_value(plan) > self.level + self.pool.objective.rounding

    def meet(self, plan: IntArray) -> bool:
        """Note a plan; whether it is met for the first time."""
        known = len(self._met)
        self._met.add(plan.tobytes())
        return len(self._met) > known

    def add(self, plan: IntArray) -> bool:
        """Rank a plan that was met; whether it became the best."""
        value = self.pool.plan_value(plan)
        better = value > self.level
        heapq.heappush(self._ranked, (-value, len(self._met), len(self.pool.attacks), plan.copy()))
        return better

    def _top(self) -> tuple[float, int, int, IntArray]:
        """The best candidate; a stored value is out of date, and too large, where outcomes were found since."""
        known = len(self.pool.attacks)
        while self._ranked and self._ranked[0][2] < known:
            _, serial, _, plan = self._ranked[0]
            heapq.heapreplace(self._ranked, (-self.pool.plan_value(plan), serial, known, plan))
        return self._ranked[0] if self._ranked else (np.inf, 0, known, self._first)
