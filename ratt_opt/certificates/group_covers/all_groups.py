"""Proofs that no groups that an attack may leave cover the team, where all these groups are listed.

What a group needs blinded is proved only for groups in the program's solutions: each gets a set of its own, as large as
it can be, which says as much of the groups around it. At exact needs the program hardly leaves a part of a link.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from ratt_opt.attackers.by_prices.team import PricedTeam
from ratt_opt.attackers.weakest_set.planar_team import PlanarTeam
from ratt_opt.budget import Budget, OutOfBudget
from ratt_opt.certificates.group_covers.cover_prices import HALF_LINK, CoverPrices, CoverProgram
from ratt_opt.certificates.group_covers.covers import refute_covers
from ratt_opt.certificates.plan_sets import COVERING, NotClosedError
from ratt_opt.certificates.verifier.work import seconds_left, tell, tick

if TYPE_CHECKING:
    from ratt_opt._validation import IntArray
    from ratt_opt.certificates.group_covers.weak_sets import WeakSets
    from ratt_opt.certificates.plan_sets import PlanSets
    from ratt_opt.graph.separable_groups import SeparableGroups

__all__ = ["all_groups_proof"]

MOST_GROUPS = 1_000_000
"""Groups that are listed; the verifier looks at each, some microseconds."""

PAYING = 200
"""Groups added to the program at a time."""

NEARLY = 0.5
"""Links that prices may lack for partitions to be tried."""


def all_groups_proof(sets: PlanSets, max_nodes: int) -> dict[str, Any]:
    """Return the record of a proof of the sets' threshold.

    Raises
    ------
    NotClosedError : there are too many groups, the groups cover the team, or a set's tree is too large.
    """
    from ratt_opt.graph.separable_groups import separable_groups  # compiles

    team, seconds = PricedTeam.of(sets.problem.objective, sets.elements), seconds_left()
    budget = Budget(None if seconds == np.inf else seconds)
    groups = None if team is None else separable_groups(sets.problem.threat, MOST_GROUPS, budget)
    if team is None or groups is None:
        raise NotClosedError
    try:
        return _AllGroups(sets, team, groups, budget).run(max_nodes)
    except OutOfBudget:
        raise NotClosedError from None


class _AllGroups:
    """``groups`` : (G,) masks; ``links`` : (G,) that each loses; ``need`` : (G,) blinded robots at least"""

    def __init__(self, sets: PlanSets, team: PricedTeam, listed: SeparableGroups, budget: Budget) -> None:
        from ratt_opt.attackers.by_prices.groups.weak_sizes import WeakSizes  # compiles
        from ratt_opt.certificates.group_covers.weak_sets import WeakSets

        self.sets, self.threat = sets, listed.threat
        sizes = WeakSizes(team, PlanarTeam.of(sets.problem.objective, sets.elements))
        self.weak: WeakSets = WeakSets(team, sets.threshold, sizes.largest(sets.threshold, budget))
        self.groups = listed.by_robots()
        self.links, self.need = listed.links(), np.zeros(len(self.groups), dtype=np.int64)
        self.seeing, self.asked = sum(1 << i for i in self.threat.protected_robots), 0
        self._raise_needs()
        self.program = CoverProgram(self.threat, self.weak)

    def run(self, max_nodes: int) -> dict[str, Any]:
        """Prices, sets for groups of their solutions, and for those of partitions."""
        prices = self._priced()
        while prices.slack >= 0 and (self._raised() or self._divided(prices)):
            prices = self._priced()
        record = {"kind": "all_groups", **prices.record()}
        cheap = self.groups[self._costs(prices) <= max(prices.slack // 2, -1)]
        refute_covers(self.threat, self.weak, record, cheap.tolist())
        return record | {"sets": self.weak.records(self.sets, max_nodes)}

    def _raise_needs(self) -> None:
        """Of all groups, by the sets that are new; groups of no attack are left out from here on."""
        for robots, room in zip(self.weak.robots[self.asked :], self.weak.room[self.asked :], strict=True):
            held = np.bitwise_count(self.groups & robots).astype(np.int64) - room
            self.need = np.maximum(self.need, held)
            possible = self.need <= self.threat.n_blinded
            possible &= np.bitwise_count(self.groups & (robots & self.seeing)) <= room
            self.groups, self.links, self.need = self.groups[possible], self.links[possible], self.need[possible]
        self.asked = len(self.weak.robots)

    def _priced(self) -> CoverPrices:
        """Prices that no group pays."""
        while True:
            tick()
            prices = self.program.solve(seconds_left())
            costs = self._costs(prices)
            paying = np.argsort(costs, kind="stable")[:PAYING]
            if not self.program.add(self.groups[paying[costs[paying] < 0]].tolist()):
                return prices

    def _costs(self, prices: CoverPrices) -> IntArray:
        """(G,) reduced costs of all groups."""
        costs = HALF_LINK * self.links + prices.blinded * self.need - prices.group
        for i, price in enumerate(prices.robot.tolist()):
            costs -= price * (self.groups >> i & 1)
        for triple, penalty in zip(prices.triple, prices.penalty, strict=True):
            costs += penalty * (np.bitwise_count(self.groups & triple) >= 2)
        return costs

    def _raised(self) -> bool:
        """Whether groups of the program's solution need more than was known."""
        tell(COVERING, 0)
        raised = [self.weak.raise_need(group) for group in self.program.support()]
        if any(raised):
            self._raise_needs()
            self.program.renew()
        return any(raised)

    def _divided(self, prices: CoverPrices) -> bool:
        """Whether triples make fractions of groups dearer, where partitions may be many."""
        return prices.slack > 2 * HALF_LINK * NEARLY and self.program.add_triples()
