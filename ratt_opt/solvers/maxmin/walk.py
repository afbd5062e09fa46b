"""A walk among plans: kick the plan it is at, improve it on the known outcomes, and offer what comes out.

A kicked plan is improved against a mean of the worst attacks known, then against the worst one. The smallest value
alone is flat: most exchanges change an outcome that is not the worst. A mean that counts small values most says where
to go.

Source: iterated local search (Lourenço, Martin and Stützle 2003).
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.solvers.maxmin.candidates import climb
from ratt_opt.solvers.maxmin.plan_stage import PlanShare, PlanStage

if TYPE_CHECKING:
    from ratt_opt._validation import IntArray
    from ratt_opt.budget import Budget
    from ratt_opt.solvers.maxmin.incumbent import Incumbent
    from ratt_opt.solvers.maxmin.plan_stage import LowerEnd

__all__ = ["Walk", "WalkStage"]


class Walk:
    """A walk from plan to plan, each kicked from the one before and climbed from; the best one is attacked exactly."""

    def __init__(self, incumbent: Incumbent, rng: np.random.Generator) -> None:
        self._incumbent, self._rng = incumbent, rng
        self._plan = incumbent.candidates.best
        self._in_vain = 0

    def run(self, budget: Budget, most: int | None = None, patience: int | None = None) -> int:
        """Walk on until the time is up, or after ``most`` kicks, or ``patience`` kicks in vain; how many kicks."""
        kicks = 0
        while not budget.is_over and kicks != most and (patience is None or self._in_vain < patience):
            kicks += 1
            self._step(budget)
        return kicks

    def _step(self, budget: Budget) -> None:
        """Go where a kick leads, unless that is much worse; from the best plan again after some kicks in vain."""
        incumbent, candidates = self._incumbent, self._incumbent.candidates
        params = incumbent.params.walk
        softness = params.softness * abs(candidates.level)
        most = max(params.fewest, len(self._plan) // 3)
        robots = int(self._rng.integers(params.fewest, most + 1)) if len(self._plan) > 1 else 1
        plan, block = self._kicked(robots), incumbent.params.incumbent.block
        plan = climb(incumbent.pool, plan, budget, block, softness)
        plan = climb(incumbent.pool, plan, budget, block)
        self._in_vain += 1
        if incumbent.offer(plan):
            self._in_vain = 0
        value = incumbent.pool.plan_value(plan)
        if value >= incumbent.pool.plan_value(self._plan) - params.worse * abs(candidates.level):
            self._plan = plan
        if self._in_vain % params.back == 0:
            self._plan = candidates.best

    def _kicked(self, robots: int) -> IntArray:
        """The plan that the walk is at, but that many robots choose at random."""
        changed, choices = self._plan.copy(), self._incumbent.problem.choices
        for i in self._rng.choice(len(changed), min(robots, len(changed)), replace=False).tolist():
            changed[i] = self._rng.choice(choices[i])
        limit = self._incumbent.problem.choice_limit
        return changed if limit is None else limit.rest(changed, self._rng.random(len(changed)))


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
