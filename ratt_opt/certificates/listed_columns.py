"""Dual prices from a list of all groups that an attack may leave, if there are not too many.

The best duals of the attacker's linear program that has them all: they claim more links than those that a search finds.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from ratt_opt.attack.thresholds.columns import UNIT
from ratt_opt.attack.thresholds.listed_columns import ListedColumns
from ratt_opt.budget import Budget, OutOfBudget
from ratt_opt.certificates.verifier.work import seconds_left
from ratt_opt.graph.communication import mask_of
from ratt_opt.graph.group_list import LARGEST_MASK, MOST_CUT, groups_of

if TYPE_CHECKING:
    from ratt_opt._validation import FloatArray
    from ratt_opt.attack.thresholds.pricing import PricingProblem
    from ratt_opt.certificates.group_tree import Limit

__all__ = ["LinkDuals", "duals_of_all_groups"]

SECONDS, SHARE = 20.0, 0.3
"""Seconds for the list at most, and share of the remaining seconds."""
MOST_LISTED = 1_000_000
"""Groups in the list."""
MARGIN = 0.02
"""Links that the duals claim beyond the budget, counted from both sides: what they could claim besides is slack that
every group has. Measured on fourteen networks of 24 robots: trees are shorter by a tenth than without slack."""


@dataclass(frozen=True, slots=True)
class LinkDuals:
    """Duals of ``robots`` (N,) and of a ``blinded`` one [links that leave a group], and what was known to find them.

    ``limits`` : those of sets without protected robots
    """

    robots: FloatArray
    blinded: float
    limits: list[Limit]


def duals_of_all_groups(plan: PricingProblem, threshold: float) -> LinkDuals | None:
    """Return the duals; ``None`` if there are too many groups."""
    if plan.robots > LARGEST_MASK or plan.threat.alpha_c > MOST_CUT:
        return None
    budget, groups, threat = Budget(min(SECONDS, SHARE * seconds_left())), groups_of(plan.threat), plan.threat
    if not groups.has_listed(MOST_LISTED, budget):
        return None
    try:
        columns = ListedColumns(threat, plan.team, groups, threshold)
        found = columns.duals(2 * len(threat.graph.links) + plan.robots, budget)
    except OutOfBudget:
        return None
    robots, blinded = found.robots / UNIT, found.blinding / UNIT
    claim = float(robots.sum()) - threat.n_blinded * blinded
    scale = min(1.0, (2 * threat.alpha_c + MARGIN) / claim) if claim > 0 else 1.0
    protected = mask_of(threat.protected_robots)
    limits = [limit for limit in columns.limits if not limit[0] & protected]
    return LinkDuals(robots * scale, blinded * scale, limits)
