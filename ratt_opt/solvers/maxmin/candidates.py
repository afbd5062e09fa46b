"""Plans judged by the known outcomes: their ranking, and climbing from one to a better one."""

from __future__ import annotations

import heapq
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from ratt_opt._validation import FloatArray, IntArray
    from ratt_opt.budget import Budget
    from ratt_opt.solvers.maxmin.outcome_pool import OutcomePool

__all__ = ["Candidates", "climb"]


def climb(pool: OutcomePool, plan: IntArray, budget: Budget, block: int, softness: float = 0.0) -> IntArray:
    """Pass over the robots, each taking the element of largest value on the known outcomes, until none changes.

    ``plan`` : (N,) element of each robot to start from; not changed. If the time is up, the pass ends where it is.
    ``block`` : numbers of a block of plans at most: memory
    ``softness`` : of the mean of small values that judges; 0 for the smallest value

    If no more robots may be busy, an idle one takes an element as a busy one rests.
    """
    problem, objective, limit = pool.problem, pool.objective, pool.problem.choice_limit
    current = plan.copy()
    as_it_is = _Rested.of(pool, current, None)
    value = float(_judged(pool.outcome_values(as_it_is.values[0]), softness))
    rested: list[_Rested] | None = None
    unchanged, i = 0, 0
    seen = {current.tobytes()}  # with information of 1e12 times the prior, rounding makes plans improve in a circle
    while unchanged < problem.n_robots and not budget.is_over:
        unchanged += 1
        waits = limit is not None and not limit.busy(current)[i] and limit.busy(current).sum() >= limit.most
        if waits and rested is None:
            rested = _Rested.one_each(pool, current, block)
        least = value + objective.least_improvement(value)  # a tie is no improvement
        found = [one.best_exchange(pool, i, softness) for one in ((rested or []) if waits else [as_it_is])]
        best = max(found, key=lambda exchange: exchange[0], default=(-np.inf, current))
        if best[0] > least:
            current, value = best[1], best[0]
            as_it_is, rested, unchanged = _Rested.of(pool, current, None), None, 0
            if (key := current.tobytes()) in seen:
                return current
            seen.add(key)
        i = (i + 1) % problem.n_robots
    return current


@dataclass(frozen=True, slots=True)
class _Rested:
    """Plans (K, N), the posterior information (K, G, M, d, d) of each group, and its value (K, G)."""

    plans: IntArray
    points: FloatArray
    values: FloatArray

    @classmethod
    def of(cls, pool: OutcomePool, plan: IntArray, resting: IntArray | None) -> _Rested:
        """The plan as it is, or plans in which one robot each is idle."""
        objective, membership, limit = pool.objective, pool.membership(), pool.problem.choice_limit
        points = pool.group_points(objective.information[plan])[None]
        if limit is None or resting is None:
            return cls(plan[None], points, objective.value(points))
        plans = np.repeat(plan[None], len(resting), axis=0)
        plans[np.arange(len(resting)), resting] = limit.idle[resting]
        lost = objective.information[limit.idle[resting]] - objective.information[plan[resting]]
        points = points + membership[:, resting].T[..., None, None, None] * lost[:, None]
        return cls(plans, points, objective.value(points))

    @classmethod
    def one_each(cls, pool: OutcomePool, plan: IntArray, block: int) -> list[_Rested]:
        """Every plan in which one of the busy robots is idle, in blocks."""
        limit = pool.problem.choice_limit
        assert limit is not None
        busy = np.flatnonzero(limit.busy(plan))
        widest = max(map(len, pool.problem.choices)) * len(pool.groups) * pool.objective.information[0].size
        most = max(block // widest, 1)
        return [cls.of(pool, plan, busy[k : k + most]) for k in range(0, len(busy), most)]

    def best_exchange(self, pool: OutcomePool, robot: int, softness: float) -> tuple[float, IntArray]:
        """The largest value that another element of a robot leaves, and its plan; none if it is in no group."""
        objective, plan = pool.objective, self.plans[0]
        choice, rows = pool.problem.choices[robot], np.flatnonzero(pool.membership()[:, robot])
        others = choice[choice != plan[robot]]
        if not (len(others) and len(rows)):
            return -np.inf, plan
        change = objective.information[others] - objective.information[plan[robot]]
        values = np.repeat(self.values[:, None], len(others), axis=1)
        values[..., rows] = objective.value(self.points[:, None, rows] + change[None, :, None])
        worst = _judged(pool.outcome_values(values), softness)
        k, e = np.unravel_index(int(worst.argmax()), worst.shape)
        changed = self.plans[k].copy()
        changed[robot] = others[e]
        return float(worst[k, e]), changed


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
