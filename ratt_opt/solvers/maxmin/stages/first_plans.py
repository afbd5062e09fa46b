"""Stages: attacks on the plans that a search begins with, and on the best one that comes of them."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.solvers.maxmin.plan_stage import PlanShare, PlanStage

if TYPE_CHECKING:
    from ratt_opt.budget import Budget
    from ratt_opt.solvers.maxmin.incumbent import Incumbent
    from ratt_opt.solvers.maxmin.plan_stage import LowerEnd

__all__ = ["AttackedStage", "BestAttackedStage", "ClimbStage", "QuickValuesStage", "outlast_first_plans"]


class AttackedStage(PlanStage):
    """Stage that attacks RATT's plan exactly; what it proves is kept, whatever ends the rest."""

    name = "RATT's plan"

    def applies(self, state: LowerEnd) -> bool:  # noqa: ARG002  (the shape of a condition)
        """Always."""
        return True

    def share(self, incumbent: Incumbent) -> PlanShare:
        """Return a tenth of the remaining time and some nodes; less on networks: there attacks go on later."""
        shares = incumbent.params.incumbent
        seconds = min(shares.first_seconds, shares.short * incumbent.budget.seconds_left)
        if incumbent.adversary.on_network and np.isfinite(seconds):
            return PlanShare(part=shares.first_on_network, at_least=seconds)
        return PlanShare(part=shares.first, max_nodes=shares.first_nodes, at_least=seconds)

    def run(self, state: LowerEnd, budget: Budget) -> None:
        """Attack RATT's plan exactly."""
        state.incumbent.proved.attack(state.plans[0], budget)


class QuickValuesStage(PlanStage):
    """Stage that keeps one of the other plans if more is known of it at once."""

    name = "other planners"

    def applies(self, state: LowerEnd) -> bool:
        """Other plans are given."""
        return len(state.plans) > 1

    def run(self, state: LowerEnd, budget: Budget) -> None:
        """Bound the greedy and the myopic plan, or an earlier one, at once."""
        for plan in state.plans[1:]:
            state.incumbent.proved.evaluate_quickly(plan, budget)


class ClimbStage(PlanStage):
    """Stage that climbs from the most promising plan and offers all of them."""

    name = "climb"

    def run(self, state: LowerEnd, budget: Budget) -> None:  # noqa: ARG002  (offers and climbs have shares of their own)
        """Attack all plans quickly, climb from the one that seems best, and offer the others."""
        state.incumbent.meet(state.plans)


class BestAttackedStage(AttackedStage):
    """Stage that attacks the best plan so far exactly."""

    name = "best plan so far"

    def applies(self, state: LowerEnd) -> bool:
        """RATT's plan is not the best one, whose value is not proved, and time is left."""
        incumbent = state.incumbent
        is_new = not np.array_equal(incumbent.candidates.best, state.plans[0])
        return is_new and not incumbent.is_proved and not incumbent.budget.is_over

    def run(self, state: LowerEnd, budget: Budget) -> None:
        """Attack the best plan so far exactly, and the next best if that one falls."""
        incumbent = state.incumbent
        while not incumbent.is_proved and not budget.is_over:
            known = len(incumbent.pool)
            incumbent.proved.attack(incumbent.candidates.best, budget)
            if len(incumbent.pool) == known:
                break


def outlast_first_plans(state: LowerEnd, longer: Budget) -> None:
    """Attack the plans that a search began with, beyond its limit, if one may be worth more than is proved so far.

    ``longer`` : the budget and some more seconds
    """
    incumbent, share = state.incumbent, state.incumbent.params.first_plans.climb
    plans = [incumbent.candidates.best, *sorted(state.plans, key=incumbent.pool.plan_value, reverse=True)]
    for plan in plans:
        least = incumbent.proved.lower + incumbent.problem.objective.rounding
        if not longer.is_over and incumbent.pool.plan_value(plan) > least:
            incumbent.proved.attack(plan, longer.part(share))
