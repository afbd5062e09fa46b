"""Proofs that no groups that an attack may leave cover the team, where all these groups are listed.

The prices, and the sets that say what groups need blinded, are found as the attacker finds them
(``attackers/by_covers/listed_groups.py``).
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from ratt_opt.attack.pricing import Plan
from ratt_opt.attackers.by_covers.cover_prices import HALF_LINK, CoverPrices, CoverProgram
from ratt_opt.budget import Budget, OutOfBudget
from ratt_opt.certificates.group_covers.covers import price_record, refute_covers, set_records
from ratt_opt.certificates.plan_sets import COVERING, NotClosedError
from ratt_opt.certificates.verifier.work import seconds_left, tell, tick

if TYPE_CHECKING:
    from ratt_opt.certificates.plan_sets import PlanSets
    from ratt_opt.graph.separable_groups import SeparableGroups

__all__ = ["all_groups_proof"]

MOST_GROUPS = 1_000_000
"""Groups that are listed; the verifier looks at each, some microseconds."""

NEARLY = 0.5
"""Links that prices may lack for partitions to be tried."""


def all_groups_proof(sets: PlanSets, max_nodes: int) -> dict[str, Any]:
    """Return the record of a proof of the sets' threshold.

    Raises
    ------
    NotClosedError : there are too many groups, the groups cover the team, or a set's tree is too large.
    """
    from ratt_opt.graph.separable_groups import separable_groups  # compiles

    plan, seconds = Plan.of(sets.problem.objective, sets.elements, sets.problem.threat), seconds_left()
    budget = Budget(None if seconds == np.inf else seconds)
    groups = None if plan is None else separable_groups(sets.problem.threat, MOST_GROUPS, budget)
    if plan is None or groups is None:
        raise NotClosedError
    try:
        return _AllGroups(sets, plan, groups).run(max_nodes)
    except OutOfBudget:
        raise NotClosedError from None


class _AllGroups:
    def __init__(self, sets: PlanSets, plan: Plan, listed: SeparableGroups) -> None:
        from ratt_opt.attackers.by_covers.listed_groups import ListedGroups  # compiles
        from ratt_opt.attackers.by_covers.weak_sets import WeakSets

        self.sets, self.threat = sets, listed.threat
        self.weak = WeakSets(plan, sets.threshold, tick)
        self.program = CoverProgram(self.threat, self.weak)
        self.groups = ListedGroups(listed, self.weak, self.program)

    def run(self, max_nodes: int) -> dict[str, Any]:
        """Prices, sets for groups of their solutions, and for those of partitions."""
        prices = self.groups.priced(seconds_left, tick)
        while prices.slack >= 0 and (self.groups.raised() or self._divided(prices)):
            tell(COVERING, 0)
            prices = self.groups.priced(seconds_left, tick)
        record = {"kind": "all_groups", **price_record(prices)}
        cheap = self.groups.masks[self.groups.costs(prices) <= max(prices.slack // 2, -1)]
        refute_covers(self.threat, self.weak, record, cheap.tolist())
        return record | {"sets": set_records(self.weak, self.sets, max_nodes)}

    def _divided(self, prices: CoverPrices) -> bool:
        """Whether triples make fractions of groups dearer, where partitions may be many."""
        return prices.slack > 2 * HALF_LINK * NEARLY and self.program.add_triples()
