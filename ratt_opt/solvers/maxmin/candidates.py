"""Plans judged by the known outcomes: their ranking, and climbing from one to a better one."""

from __future__ import annotations

import heapq
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from ratt_opt._validation import FloatArray, IntArray
    from ratt_opt.budget import Budget
    from ratt_opt.problem import Problem
    from ratt_opt.solvers.maxmin.outcome_pool import OutcomePool

__all__ = ["Candidates", "climb"]


def climb(problem: Problem, pool: OutcomePool, plan: IntArray, budget: Budget, softness: float = 0.0) -> IntArray:
    """Pass over the robots, each taking the element of largest value on the known outcomes, until none changes.

    ``plan`` : (N,) element of each robot to start from; not changed. If the time is up, the pass ends where it is.
    ``softness`` : of the mean of small values that judges; 0 for the smallest value
    """
    objective = pool.objective
    current = plan.copy()
    points = pool.group_points(objective.information[current])
    base = objective.value(points)
    value = float(_judged(pool.outcome_values(base), softness))
    unchanged, i = 0, 0
    seen = {current.tobytes()}  # with information of 1e12 times the prior, rounding makes plans improve in a circle
    while unchanged < problem.n_robots and not budget.is_over:
        choice = problem.choices[i]
        rows = np.flatnonzero(pool.membership()[:, i])
        others = choice[choice != current[i]]
        unchanged += 1
        if len(others) and len(rows):
            change = objective.information[others] - objective.information[current[i]]
            values = np.repeat(base[None], len(others), axis=0)
            values[:, rows] = objective.value(points[rows][None] + change[:, None])
            worst = _judged(pool.outcome_values(values), softness)
            k = int(worst.argmax())
            if worst[k] > value + objective.least_improvement(value):  # a tie is no improvement
                current[i], value, base = others[k], float(worst[k]), values[k]
                points[rows] += change[k]
                unchanged = 0
                if (key := current.tobytes()) in seen:
                    return current
                seen.add(key)
        i = (i + 1) % problem.n_robots
    return current


def _judged(values: FloatArray, softness: float) -> FloatArray:
    """The smallest of values (..., O), or a mean of small ones: what is ``softness`` more counts e times less."""
    least = values.min(axis=-1, initial=np.inf)
    if softness == 0.0 or not values.shape[-1]:
        return np.asarray(least)
    return np.asarray(least - softness * np.log(np.exp((least[..., None] - values) / softness).sum(axis=-1)))


class Candidates:
    """Plans by their value under the known outcomes, an upper bound on their worst case.

    A new outcome may lower the best one's value; then another may become the best.
    """

    def __init__(self, pool: OutcomePool, first: IntArray) -> None:
        self.pool, self.first = pool, first
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
        """Test whether a plan beats the best one under the known outcomes, by more than rounding."""
        return self.pool.plan_value(plan) > self.level + self.pool.objective.least_improvement(self.level)

    def meet(self, plan: IntArray) -> bool:
        """Note a plan; whether it is met for the first time."""
        known = len(self._met)
        self._met.add(plan.tobytes())
        return len(self._met) > known

    def add(self, plan: IntArray) -> bool:
        """Rank a plan that was met; whether it became the best."""
        value = self.pool.plan_value(plan)
        better = value > self.level
        heapq.heappush(self._ranked, (-value, len(self._met), len(self.pool), plan.copy()))
        return better

    def _top(self) -> tuple[float, int, int, IntArray]:
        """The best candidate; a stored value is out of date, and too large, if outcomes were found since."""
        known = len(self.pool)
        while self._ranked and self._ranked[0][2] < known:
            _, serial, _, plan = self._ranked[0]
            heapq.heapreplace(self._ranked, (-self.pool.plan_value(plan), serial, known, plan))
        return self._ranked[0] if self._ranked else (np.inf, 0, known, self.first)
