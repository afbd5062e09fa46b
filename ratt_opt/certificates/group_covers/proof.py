"""Proofs that every attack leaves a group worth a threshold: no groups worth less cover the team within the budgets.

The linear program of the prices (``cover_prices.py``) may claim fewer links than the budget, as its partitions may be
fractional. Then the groups that cost no more than what is left are listed by a tree, and their partitions are tried.
"""

from __future__ import annotations

from ctypes import c_uint64
from typing import TYPE_CHECKING, Any

import numpy as np

from ratt_opt.attack.pricing import UNIT, Plan, Question
from ratt_opt.attackers.by_covers.cover_prices import HALF_LINK, CoverPrices, CoverProgram
from ratt_opt.budget import OutOfBudget
from ratt_opt.certificates.group_covers.covers import price_record, refute_covers, set_records
from ratt_opt.certificates.plan_sets import COVERING, NotClosedError
from ratt_opt.certificates.verifier.work import seconds_left, tell, tick

if TYPE_CHECKING:
    from ratt_opt.attackers.by_covers.weak_sets import WeakSets
    from ratt_opt.certificates.group_covers.group_tree import Found
    from ratt_opt.certificates.plan_sets import PlanSets

__all__ = ["LARGEST_TEAM", "group_cover_proof"]

LARGEST_TEAM = 60
"""Robots: a group is a mask of 64 bits."""

WORK = 1_500_000_000
"""Most cases of all trees, times robots and arcs: about a minute."""

LISTED, PAYING = 50_000, 300
"""Most groups that are listed, and that are added to the program at a time."""

FLOW_LINKS = 700_000
"""Most numbers in flows; the verifier reads files of two million."""

AT_ONCE = 500
"""Cases between two looks at the clock: up to a tenth of a second."""

EASY = 0.1
"""Share of the budget of links that prices may lack for the groups to be listed without more triples, which are added
as long as they make up for half a link at a time."""

MOVES, WARM, COLD = 1_500, 4.0, 0.1
"""Moves around each robot to find groups that pay the first prices; temperatures [links that leave a group]."""


def group_cover_proof(sets: PlanSets, max_nodes: int) -> dict[str, Any]:
    """Return the record of a proof of the sets' threshold.

    Raises
    ------
    NotClosedError : there are too many groups or cases, or the groups cover the team.
    """
    plan = Plan.of(sets.problem.objective, sets.elements, sets.problem.threat)
    if plan is None or sets.problem.n_robots > LARGEST_TEAM:
        raise NotClosedError
    try:
        return _CoverProof(sets, plan, max_nodes).run()
    except OutOfBudget:
        raise NotClosedError from None


class _CoverProof:
    def __init__(self, sets: PlanSets, plan: Plan, max_nodes: int) -> None:
        from ratt_opt.attackers.by_covers.weak_sets import WeakSets
        from ratt_opt.certificates.group_covers.case_bounds import Network

        self.sets, self.plan, self.max_nodes, self.work = sets, plan, max_nodes, 0
        self.threat = threat = sets.problem.threat
        self.links = plan.links
        self.network = Network.of(threat, self.links)
        self.weak: WeakSets = WeakSets(plan, sets.threshold, tick)
        self.program = CoverProgram(threat, self.weak)

    def run(self) -> dict[str, Any]:
        """Prices, the tree of groups, and sets until no partition is left."""
        self._anneal()
        prices = self._priced()
        easy, before = EASY * 2 * HALF_LINK * self.threat.alpha_c, np.inf
        while easy < prices.slack < before - HALF_LINK and self.program.add_triples():
            before, prices = prices.slack, self._priced()
        from ratt_opt.certificates.group_covers.group_tree import FLOW

        n_sets = len(self.weak.robots)
        found = self._grown(prices, max(prices.slack // 2, -1), LISTED)
        n_nodes, n_groups = found.count[:2].tolist()
        tree = found.tree[:n_nodes].tolist()
        flows = self._used_flows(tree, found.flows, n_sets)
        record = {"kind": "group_covers", **price_record(prices), "flows": flows}
        refute_covers(self.threat, self.weak, record, found.group[:n_groups].tolist())
        added = len(self.weak.robots) - n_sets
        tree = [node - (FLOW - node) // n_sets * added if node <= FLOW else node for node in tree]
        return record | {"sets": set_records(self.weak, self.sets, self.max_nodes), "tree": tree}

    def _anneal(self) -> None:
        """Groups that pay, by annealing, until they are hard to find; then the tree finds them."""
        random, new = c_uint64(1), 1
        while new:
            prices, groups, scale = self.program.solve(seconds_left()), [], UNIT / HALF_LINK
            robots, blinded = np.floor(prices.robot * scale).astype(np.int64), int(np.ceil(prices.blinded * scale))
            question = Question(self.sets.threshold, self.plan.robots, robots, blinded, 0)
            for column in self.plan.annealed(question, MOVES, (WARM, COLD), random):
                tick()
                if column.cost < prices.group * scale:
                    groups.append(sum(1 << i for i in np.flatnonzero(column.robots).tolist()))
            new = self.program.add(groups)

    def _priced(self) -> CoverPrices:
        """Prices that no group pays."""
        while True:
            prices = self.program.solve(seconds_left())
            found = self._grown(prices, -1, PAYING)
            if not self.program.add(found.group[: found.count[1]].tolist()):
                return prices

    def _grown(self, prices: CoverPrices, slack: int, most: int) -> Found:
        """The tree of the groups that cost no more than the slack, up to so many of those that cost less than nothing.

        Raises
        ------
        NotClosedError : there is no room for the tree.
        """
        from ratt_opt.certificates.group_covers.case_bounds import Sets, Tariff
        from ratt_opt.certificates.group_covers.group_tree import FINISHED, PAUSED, Found, grow_tree

        n_robots, n_arcs = len(prices.robot), len(self.links.robot)
        weak = Sets(np.array(self.weak.robots, dtype=np.int64), np.array(self.weak.room, dtype=np.int64))
        order = np.argsort(-prices.robot, kind="stable")
        tariff = Tariff(
            prices.robot, prices.blinded, HALF_LINK, slack, order, prices.group, prices.triple, prices.penalty
        )
        found = Found.of(n_robots, self.max_nodes, most, (2 * FLOW_LINKS // max(n_arcs, 1), n_arcs))
        code = PAUSED
        while code == PAUSED:
            tick()
            self.work += AT_ONCE * n_robots * n_arcs
            if self.work > WORK:
                raise NotClosedError
            tell(COVERING, int(found.count[0]))
            code = grow_tree(self.network, weak, tariff, found, AT_ONCE)
        if code != FINISHED and not (slack < 0 and found.count[1]):
            raise NotClosedError
        return found

    def _used_flows(self, tree: list[int], flows: Any, n_sets: int) -> list[list[int]]:
        """The flows that close leaves, which are numbered anew in place."""
        from ratt_opt.certificates.group_covers.group_tree import FLOW

        place: dict[int, int] = {}
        for at, node in enumerate(tree):
            if node <= FLOW:
                flow, chosen = divmod(FLOW - node, n_sets)
                tree[at] = FLOW - (place.setdefault(flow, len(place)) * n_sets + chosen)
        ends = sorted(self.threat.graph.links)
        arcs = {arc: a for a, arc in enumerate(sorted([*ends, *((j, i) for i, j in ends)]))}
        own = [arcs[link] for link in ends]
        return [flows[flow][own].tolist() for flow in place]
