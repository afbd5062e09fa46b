"""Stage: among plans of the same worst case, one that is worth more without attack."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.problem import Attack
from ratt_opt.solvers.maxmin.incumbent import PROVED, ProvedPlan
from ratt_opt.solvers.maxmin.outcome_pool import OutcomePool
from ratt_opt.solvers.maxmin.plan_stage import PlanPhase, PlanShare, PlanStage

if TYPE_CHECKING:
    from ratt_opt._validation import IntArray
    from ratt_opt.budget import Budget
    from ratt_opt.solvers.maxmin.incumbent import Incumbent
    from ratt_opt.solvers.maxmin.plan_stage import LowerEnd

__all__ = ["TiesStage", "break_ties"]


class TiesStage(PlanStage):
    """Stage that breaks ties by the value without attack."""

    name = "ties"
    phase = PlanPhase.AFTER

    def applies(self, state: LowerEnd) -> bool:
        """The best plan's value is proved, and time is left."""
        return state.incumbent.is_proved and not state.incumbent.budget.is_over

    def share(self, incumbent: Incumbent) -> PlanShare:
        """Return a tenth of the remaining time by default."""
        return PlanShare(part=incumbent.params.ties.share)

    def run(self, state: LowerEnd, budget: Budget) -> None:
        """Exchange elements while the worst case stays as it is and the value without attack rises."""
        break_ties(state.incumbent, budget)


def break_ties(incumbent: Incumbent, part: Budget) -> None:
    """Exchange elements of the proved plan while its worst case stays as it is and its value without attack rises.

    The new plan is attacked exactly, and kept only if as much is proved of it.

    Raises ``OutOfBudget`` : the user interrupted the attack; the old plan stays.
    """
    params, proved = incumbent.params.ties, incumbent.proved
    for _ in range(params.rounds):
        plan = _richer(incumbent, proved.elements, part)
        if np.array_equal(plan, proved.elements) or part.is_over:
            return
        tied = ProvedPlan(incumbent.adversary, plan)
        tied.attack(plan, part.part(max_nodes=params.nodes))
        tied.evaluations += proved.evaluations
        if tied.worst_case is not None and tied.lower >= proved.lower - PROVED * abs(proved.lower):
            incumbent.proved = tied
            return


def _richer(incumbent: Incumbent, plan: IntArray, budget: Budget) -> IntArray:
    """A plan of no smaller value under the known outcomes that no exchange makes worth more without attack."""
    problem, pool, limit = incumbent.problem, incumbent.pool, incumbent.problem.choice_limit
    rounding, unattacked = problem.objective.rounding, OutcomePool(problem)
    unattacked.add(Attack())
    least = min(incumbent.proved.lower, pool.plan_value(plan))
    least -= PROVED * abs(least) + rounding
    no_more = 1e-9  # relative difference of values without attack that counts as none
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
                if limit is not None and not limit.allows(other):
                    continue
                value = unattacked.plan_value(other)
                if value > best + no_more * abs(best) + rounding and pool.plan_value(other) >= least:
                    best, current, improved = value, other, True
    return current
