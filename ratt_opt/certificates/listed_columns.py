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
    from ratt_opt.certificates.params import CoverProofParams

__all__ = ["LinkDuals", "duals_of_all_groups"]


@dataclass(frozen=True, slots=True)
class LinkDuals:
    """Duals of ``robots`` (N,) and of a ``blinded`` one [links that leave a group], and what was known to find them.

    ``limits`` : those of sets without protected robots
    """

    robots: FloatArray
    blinded: float
    limits: list[Limit]


def duals_of_all_groups(plan: PricingProblem, threshold: float, params: CoverProofParams) -> LinkDuals | None:
    """Return the duals; ``None`` if there are too many groups."""
    if plan.robots > LARGEST_MASK or plan.threat.alpha_c > MOST_CUT:
        return None
    budget = Budget(min(params.seconds, params.share * seconds_left()))
    groups, threat = groups_of(plan.threat), plan.threat
    if not groups.has_listed(params.listed, budget):
        return None
    try:
        columns = ListedColumns(threat, plan.team, groups, threshold)
        found = columns.duals(2 * len(threat.graph.links) + plan.robots, budget)
    except OutOfBudget:
        return None
    robots, blinded = found.robots / UNIT, found.blinding / UNIT
    claim = float(robots.sum()) - threat.n_blinded * blinded
    scale = min(1.0, (2 * threat.alpha_c + params.margin) / claim) if claim > 0 else 1.0
    protected = mask_of(threat.protected_robots)
    limits = [limit for limit in columns.limits if not limit[0] & protected]
    return LinkDuals(robots * scale, blinded * scale, limits)
