"""Stage: a walk among plans before the root of the upper end."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.solvers.maxmin.stages.plan_stage import PlanShare, PlanStage
from ratt_opt.solvers.maxmin.walk import Walk

if TYPE_CHECKING:
    from ratt_opt.budget import Budget
    from ratt_opt.solvers.maxmin.incumbent import Incumbent
    from ratt_opt.solvers.maxmin.stages.plan_stage import LowerEnd

__all__ = ["WalkStage"]


class WalkStage(PlanStage):
    """Stage that walks before the root: what closes a node is measured by the best plan."""

    name = "walk"

    def applies(self, state: LowerEnd) -> bool:
        """Rows begin at the root of the upper end, and time is left."""
        return not state.incumbent.budget.is_over and state.known.rows_from == 0

    def share(self, incumbent: Incumbent) -> PlanShare:
        """Return a tenth of the remaining time by default."""
        return PlanShare(part=incumbent.params.depth.walk_share)

    def run(self, state: LowerEnd, budget: Budget) -> None:
        """Kick the best plan and climb, again and again."""
        walk = Walk(state.incumbent, np.random.default_rng(0))
        walk.run(budget, state.incumbent.params.depth.walk_kicks)
