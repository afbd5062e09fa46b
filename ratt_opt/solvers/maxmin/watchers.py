"""A plan whose least watched targets have many watchers, so that few attacks take all watchers of one.

An element *watches* a target if it alone tells a share of what all elements together tell about it. If sensors are
precise, a worst attack takes all watchers of some targets. Whether it can is a matter of counting: a walk keeps the
sum over targets of ``exp(-watchers)`` small. That depends on no attack and takes microseconds a step.

Source: iterated local search (Lourenço, Martin and Stützle 2003) on a soft minimum of the numbers of watchers.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from ratt_opt._validation import BoolArray, FloatArray, IntArray
    from ratt_opt.budget import Budget
    from ratt_opt.problem import Problem
    from ratt_opt.setfunctions.information import InformationObjective
    from ratt_opt.solvers.maxmin.params import WatcherParams

__all__ = ["watched_plan"]


def watched_plan(problem: Problem, budget: Budget, params: WatcherParams) -> IntArray | None:
    """(N,) the plan whose least watched targets have most watchers, as far as a walk finds it.

    ``None`` if elements see most targets, or most of those that see one do not watch it. ``None``, too, if a value is
    no sum over targets, few robots may be busy, or the time is up
    """
    objective = problem.information_objective
    seeing = objective.information.any(axis=(-2, -1))
    if (
        1 - seeing.mean() < params.unseen
        or not objective.overrides("target_tangents")
        or problem.at_most is not None
        or budget.is_over
    ):
        return None
    watching = _watches(objective, params.watching)
    if watching.sum() < params.precise * seeing.sum():
        return None
    return _Walk(problem, watching).run(budget.part(params.share), params.kicks)


def _watches(objective: InformationObjective, share: float) -> BoolArray:
    """(E, M) whether each element alone tells at least a share of what all of them tell about a target."""
    least = share * objective.target_values(objective.posterior_mixture(np.ones(objective.n)))
    watching = np.zeros(objective.information.shape[:2], dtype=np.bool_)
    block = 1_024  # elements whose values are computed at once
    for k in range(0, objective.n, block):
        own = objective.information[k : k + block]
        watching[k : k + block] = objective.target_values(objective.prior_information + own) >= least
    return watching & objective.information.any(axis=(-2, -1))


class _Walk:
    """Kicks and descents; a target's term ``exp(-watchers)`` is multiplied by ``_factors`` (E, M) of each element."""

    def __init__(self, problem: Problem, watching: BoolArray) -> None:
        self._choices, self._factors = problem.choices, np.exp(-watching.astype(np.float64))
        self._watching, self._rng = watching, np.random.default_rng(0)

    def run(self, budget: Budget, kicks: int) -> IntArray:
        """Kick the best plan and descend, up to that many times or until the time is up; return the best plan."""
        robots = len(self._choices)
        best = self._descended(np.array([self._rng.choice(choice) for choice in self._choices]))
        least, most = self._terms(best).sum(), max(2, robots // 3)
        for _ in range(kicks):
            if budget.is_over:
                break
            plan = best.copy()
            for i in self._rng.choice(robots, min(int(self._rng.integers(1, most + 1)), robots), replace=False):
                plan[i] = self._rng.choice(self._choices[i])
            plan = self._descended(plan)
            if (terms := self._terms(plan).sum()) <= least:
                best, least = plan, terms
        return best

    def _terms(self, plan: IntArray) -> FloatArray:
        return np.asarray(np.exp(-self._watching[plan].sum(axis=0, dtype=np.float64)))

    def _descended(self, plan: IntArray) -> IntArray:
        """Let one robot after the other take its best element, until none changes."""
        terms = self._terms(plan)
        unchanged, i = 0, 0
        while unchanged < len(plan):
            rest = terms / self._factors[plan[i]]
            costs = self._factors[self._choices[i]] @ rest
            best = int(self._choices[i][costs.argmin()])
            is_better = costs.min() < self._factors[plan[i]] @ rest * (1 - 1e-9)  # less is rounding
            unchanged = 0 if is_better else unchanged + 1
            plan[i] = best if is_better else plan[i]
            terms = rest * self._factors[plan[i]]
            i = (i + 1) % len(plan)
        return plan
