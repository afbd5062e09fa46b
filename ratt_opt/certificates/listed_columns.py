"""Dual prices from a list of all groups that an attack may leave, if there are not too many.

The best duals of a linear program that has them all: they claim more links than those that a search finds.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.attack.columns import UNIT, Columns
from ratt_opt.attack.master import best_duals
from ratt_opt.attack.sets_below import SetsBelow
from ratt_opt.attack.team import MOST_ROBOTS
from ratt_opt.budget import Budget, OutOfBudget
from ratt_opt.certificates.verifier.work import seconds_left
from ratt_opt.graph.group_list import groups_of

if TYPE_CHECKING:
    from ratt_opt._validation import FloatArray
    from ratt_opt.attack.pricing import Plan

__all__ = ["duals_of_all_groups"]

SECONDS, SHARE = 20.0, 0.3
"""For the list, at most; and of the seconds left. Sparse graphs of 30 robots have too many groups."""
MOST_TABULATED, MOST_ASKED = 24, 20_000
"""Robots whose sets are all looked at, of planar targets; and groups that are asked one by one otherwise."""
EFFORT = 10_000
"""Robots valued to decide for one size what a group needs: a millisecond."""
MARGIN = 0.02
"""Links that the duals claim beyond the budget, counted from both sides: what they could claim besides is slack that
every group has. Measured on fourteen networks of 24 robots: trees are shorter by a tenth than without slack."""


def duals_of_all_groups(plan: Plan, threshold: float) -> tuple[FloatArray, float] | None:
    """Duals of robots (N,) and of a blinded one [links that leave a group]; ``None`` if there are too many groups."""
    if plan.robots > MOST_ROBOTS:
        return None
    budget = Budget(min(SECONDS, SHARE * seconds_left()))
    try:
        columns = _columns(plan, threshold, budget)
        if columns is None:
            return None
        n_blinded, most_cut = plan.threat.n_blinded, 2 * plan.threat.alpha_c
        found = best_duals(columns, n_blinded, 2 * len(plan.threat.graph.links) + plan.robots, budget).duals
    except OutOfBudget:
        return None
    robots, blinded = found.robots / UNIT, found.blinding / UNIT
    claim = float(robots.sum()) - n_blinded * blinded
    scale = min(1.0, (most_cut + MARGIN) / claim) if claim > 0 else 1.0
    return robots * scale, blinded * scale


def _columns(plan: Plan, threshold: float, budget: Budget) -> Columns | None:
    groups, cuts = groups_of(plan.threat).all(budget)
    if plan.robots <= MOST_TABULATED and plan.team.record.dimension <= 2:
        below = SetsBelow(plan.team, plan.threat.protected_robots, groups, plan.threat.n_blinded)
        below.mark(threshold, budget)
        return Columns.of(groups, cuts, below, plan.threat.n_blinded)
    if len(groups) > MOST_ASKED:
        return None
    needs = np.empty(len(groups), np.int64)
    for k, mask in enumerate(groups.tolist()):
        budget.check()
        inside = np.array([mask >> i & 1 for i in range(plan.robots)], dtype=np.bool_)
        needs[k] = mask.bit_count() - plan.most_below(threshold, inside, EFFORT)
    kept = needs <= plan.threat.n_blinded
    return Columns(plan.robots, groups[kept], cuts[kept], np.maximum(needs[kept], 0).astype(np.uint8))
