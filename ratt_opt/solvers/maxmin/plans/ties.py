"""Among plans of equal worst case, one that is worth more when nobody attacks."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.problem import Attack
from ratt_opt.solvers.maxmin.plans.incumbent import PROVED, ProvedPlan
from ratt_opt.solvers.maxmin.plans.outcome_pool import OutcomePool

if TYPE_CHECKING:
    from ratt_opt._validation import IntArray
    from ratt_opt.budget import Budget
    from ratt_opt.solvers.maxmin.plans.incumbent import Incumbent

__all__ = ["break_ties"]

SHARE, MOST_NODES = 0.1, 100_000
"""Of the time left, and nodes of each attack on a plan that is worth more."""
NO_MORE = 1e-9
"""Relative difference of values without attack that counts as none."""
ROUNDS = 10
"""Plans that are attacked at most; each that falls teaches an attack."""


def break_ties(incumbent: Incumbent, budget: Budget) -> None:
    """Exchange elements of the proved plan while its worst case stays as it is and its value without attack rises.

    The new plan is attacked exactly, and kept only if as much is proved of it.

    Raises ``OutOfBudget`` : the user interrupted the attack; the old plan stays.
    """
    part, proved = budget.part(SHARE), incumbent.proved
    for _ in range(ROUNDS):
        plan = _richer(incumbent, proved.elements, part)
        if np.array_equal(plan, proved.elements) or part.is_over:
            return
        tied = ProvedPlan(incumbent.adversary, plan)
        tied.attack(plan, part.part(max_nodes=MOST_NODES))
        tied.evaluations += proved.evaluations
        if tied.worst_case is not None and tied.lower >= proved.lower - PROVED * abs(proved.lower):
            incumbent.proved = tied
            return


def _richer(incumbent: Incumbent, plan: IntArray, budget: Budget) -> IntArray:
    """A plan of no smaller value under the known outcomes that no exchange makes worth more without attack."""
    problem, pool = incumbent.problem, incumbent.pool
    rounding, unattacked = problem.objective.rounding, OutcomePool(problem)
    unattacked.add(Attack())
    least = min(incumbent.proved.lower, pool.plan_value(plan))
    least -= PROVED * abs(least) + rounding
    best, current = unattacked.plan_value(plan), plan.copy()
    improved = True
    while improved:
        improved = False
        for i, choice in enumerate(problem.choices):
            for e in choice.tolist():
                if budget.is_over:
                    return current
                other = current.copy()
                other[i] = e
                value = unattacked.plan_value(other)
                if value > best + NO_MORE * abs(best) + rounding and pool.plan_value(other) >= least:
                    best, current, improved = value, other, True
    return current
