"""Is there an attack worth less than a threshold? By prices, enumeration and covers.

1. Prices (``prices.py``) that claim more links than the budget refute the threshold once a search over the robots
   that see or are inside (``paying_groups.py``, ``columns.py``) has found no group that pays them; groups that do are
   added to the program.
2. Prices that claim ``gap`` links less leave the groups of reduced cost at most ``gap``: they are listed, and the
   partitions into them tried (``listing.py``). Either one is an attack, or the threshold is refuted.

Source: for the second step, Baldacci, Christofides and Mingozzi, Mathematical Programming 115 (2008).
"""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.attack.annealing import Partition
from ratt_opt.attackers.by_prices.answer import Answer, Threshold
from ratt_opt.attackers.by_prices.convex_forms import ConvexForms
from ratt_opt.attackers.by_prices.falling_prices import FallingPrices
from ratt_opt.attackers.by_prices.groups.cheap_groups import BLINDED, cheap_group
from ratt_opt.attackers.by_prices.groups.columns import Prices, Question
from ratt_opt.attackers.by_prices.listing import list_groups, partitions_into
from ratt_opt.attackers.by_prices.paying_groups import PayingSearch
from ratt_opt.attackers.by_prices.prices import GroupPrices, KnownGroup, PriceVector

if TYPE_CHECKING:
    from collections.abc import Callable

    from ratt_opt.attack.links import Links
    from ratt_opt.attackers.by_prices.groups.weak_sizes import WeakSizes
    from ratt_opt.attackers.by_prices.listing import ListedGroups
    from ratt_opt.attackers.by_prices.team import PricedTeam
    from ratt_opt.budget import Budget
    from ratt_opt.graph.threat import Threat

    _Choice = Callable[[float, float, float], PriceVector | None]

__all__ = ["ThresholdDecision"]

SHARES, FEW_SHARES = np.array([1.0, 0.75, 0.5, 0.25, 0.0]), np.array([1.0, 0.0])
"""Mixtures of the two bounds of the enumeration. Measured at 24 robots: five flows visit a half to a seventh of the
nodes of two; beside forms two are enough."""

MARGIN = 1e-3
"""Links that scaled prices claim beyond the budget; well above rounding, well below one link."""

TOLERANCE = 1e-6
"""Reduced costs below minus this count as negative: above what the linear program leaves of its rows, and a team's sum
stays well below MARGIN."""

RESERVE = 0.3
"""Share of the links that could be claimed beyond the budget that prices claim, too, to be lowered for groups that pay.
Measured at hubs of 30 robots (10, 31) and 97 % of the attack: two searches instead of five, of 60,000 nodes."""

LOWERED, FALL = 0.003, 0.1
"""By which all robots' prices fall once no group has a reduced cost below minus this: then none is negative; and links
by which prices that claim too few may fall for groups before."""

FIRST_ATTEMPT, LONGER = 10_000, 3
"""Nodes of the first search over seeing robots at each of a few prices, and their growth while none of them ends."""

DEARER, LISTING, LISTED_FROM = 200, 10, 50_000
"""Nodes of the search over seeing robots that one of the search over robots inside counts for (20 microseconds against
up to 3,000, at 30 robots), when it looks for groups that pay, and when it lists those that nearly do; and nodes before
it is asked at all: on disk-12 of 50 robots six searches of some dozens of nodes took 21 of 120 s."""

MOVES, WARM, COLD = 1_500, 2.0, 0.05
"""Moves around each robot to find groups that pay the prices, and the temperatures [links] they cool between. Measured
at 50 robots of a small world: with 4,000 moves three quarters of the time goes into them."""

MOST_ROUNDS, ROUNDS_SHARE = 50, 0.05
"""Of annealing at the prices that claim most, and of the seconds left for it. At 100 robots of hubs three seconds make
a threshold at 94 % of the attack one of 800 nodes, where 25,000 do not do at the prices for few groups."""

ROOM, NEW_GROUPS = 100_000, 100
"""Groups listed for covers; groups added to the program at a time."""

QUICK, THOROUGH = 200, 3_000
"""Values looked at to decide what a group needs: at every node (some 20 microseconds), and before it is listed."""


class ThresholdDecision:
    """Decides thresholds for one plan; what is learned about groups serves the next threshold."""

    def __init__(self, team: PricedTeam, links: Links, threat: Threat, sizes: WeakSizes) -> None:
        self.team, self.links, self.threat = team, links, threat
        self._sizes = sizes
        self.prices = GroupPrices(threat)
        self._paying = PayingSearch(team, links, ConvexForms(threat))
        self._n_robots = len(team.single)
        self._rng, self._shuffled = np.random.default_rng(0), False
        self._attempt = FIRST_ATTEMPT
        self._choices: list[_Choice] = [self.prices.slackest, partial(self.prices.dearest, reserve=RESERVE)]
        for i in range(self._n_robots):
            alone = np.arange(self._n_robots) == i
            self.prices.add([KnownGroup(robots=alone, need=0, value=float(team.single[i]))])
            if not links.seeing[i]:
                self.prices.add([KnownGroup(robots=alone, need=1, value=0.0)])

    def learn(self, partition: Partition) -> None:
        """Add the groups of an attack to the program."""
        from ratt_opt.attackers.by_prices.groups.compiled import gather_seeing

        sums = np.empty_like(self.team.prior)
        for label in np.unique(partition.group):
            robots = partition.group == label
            value = float(gather_seeing(self.team, robots, partition.blind, sums))
            self.prices.add([KnownGroup(robots=robots, need=int((robots & partition.blind).sum()), value=value)])

    def decide(self, threshold: float, budget: Budget, nodes: int) -> Answer:
        """Decide one threshold; ``OPEN`` after so many nodes of one enumeration.

        Raises
        ------
        OutOfBudget : the time is up.
        """
        size, spent = self._sizes.largest(threshold, budget), budget.nodes
        self._attempt = max(self._attempt // LONGER, FIRST_ATTEMPT)
        while budget.nodes - spent < nodes:
            found = self._settled(threshold, budget)
            if found.links > self.threat.alpha_c + MARGIN:
                answer = self._refute(threshold, size, budget)
                if answer is not None:
                    return answer
                continue
            answer = self._answered(found, (threshold, size, -LOWERED), budget)
            if answer is None:
                self._attempt *= LONGER
            elif answer.verdict is Threshold.REFUTED:
                assert answer.prices is not None
                return self._cover(answer.prices.lowered(LOWERED), threshold, size, budget, nodes)
            elif answer.verdict is Threshold.OPEN:
                break
        return Answer(verdict=Threshold.OPEN)

    def refuting_prices(self, threshold: float, budget: Budget, nodes: int) -> PriceVector | None:
        """Prices that refute the threshold without covers; ``None`` where there are none, or not after so many nodes.

        Raises
        ------
        OutOfBudget : the time is up.
        """
        size, spent = self._sizes.largest(threshold, budget), budget.nodes
        self._attempt = max(self._attempt // LONGER, FIRST_ATTEMPT)
        while budget.nodes - spent < nodes and self._settled(threshold, budget).links > self.threat.alpha_c + MARGIN:
            answer = self._refute(threshold, size, budget)
            if answer is not None:
                return answer.prices if answer.verdict is Threshold.REFUTED else None
        return None

    def _refute(self, threshold: float, size: int, budget: Budget) -> Answer | None:
        """Ask whether no group pays prices that claim more than the budget; ``None`` where more is to be done.

        The prices furthest below what known groups cost prune best, or those with dear blinded robots. Where they do
        not end, others may: all in turn, and ever longer, first those that ended last.
        """
        links, asked = self.threat.alpha_c + MARGIN, (threshold, size, -TOLERANCE)
        for choose in self._choices.copy():
            while (chosen := choose(threshold, links, budget.seconds_left)) is not None:
                budget.check()
                answer = self._answered(chosen, asked, budget)
                if answer is None:
                    break
                if answer.verdict is not Threshold.REACHED:
                    self._choices.remove(choose)
                    self._choices.insert(0, choose)
                    return answer
        found = self._settled(threshold, budget)
        if found.links <= links:
            return None
        answer = self._answered(found.scaled(links + RESERVE * (found.links - links)), asked, budget)
        self._attempt *= LONGER
        return None if answer is None or answer.verdict is Threshold.REACHED else answer

    def _answered(self, prices: PriceVector, asked: tuple[float, int, float], budget: Budget) -> Answer | None:
        """Whether no group pays (REFUTED), some new one does (REACHED) or an old one (OPEN); ``None`` : unknown."""
        threshold = asked[0]
        if self.prices.add(self._cheap(prices, threshold, budget)):
            return Answer(verdict=Threshold.REACHED)
        (at, question), nodes, least = self._asked(prices, asked), self._attempt, self.threat.alpha_c + MARGIN
        least = least if prices.links > least - TOLERANCE else prices.links - FALL
        falling = FallingPrices(program=self.prices, threshold=threshold, prices=prices, links=least)
        found = self._paying.find(at, question, budget, falling, nodes=nodes, room=NEW_GROUPS)
        if found.groups:
            is_new = self.prices.add(found.groups) or falling.learned
            return Answer(verdict=Threshold.REACHED if is_new else Threshold.OPEN)
        if found.is_complete:
            return Answer(verdict=Threshold.REFUTED, prices=falling.prices)
        if self._attempt < LISTED_FROM:
            return None
        listed = self._listed(prices, asked, budget, (self._attempt // DEARER, NEW_GROUPS))
        if len(listed.cost):
            return Answer(verdict=Threshold.REACHED) if self._teach(listed, threshold) else None
        return Answer(verdict=Threshold.REFUTED, prices=prices) if listed.is_complete else None

    def _asked(self, prices: PriceVector, asked: tuple[float, int, float]) -> tuple[Prices, Question]:
        """The compiled searches' arguments for ``asked`` = (threshold, largest weak size, limit)."""
        threshold, size, limit = asked
        known, ones = self._paying.forms.known, np.ones(self._n_robots)
        shares = FEW_SHARES if len(known.constant) else SHARES
        at = Prices(prices.robot, prices.blinded, ones, float(size), prices.blinded, shares, known)
        order = np.argsort(-prices.robot, kind="stable")
        if self._shuffled:  # the groups listed last all began with the same robots
            order = self._rng.permutation(self._n_robots)
        return at, Question(threshold, self.threat.n_blinded, limit, order, QUICK, THOROUGH)

    def _settled(self, threshold: float, budget: Budget) -> PriceVector:
        """Prices that no group found by annealing pays, or not enough to claim more links than the budget.

        The first rounds ask the prices that claim most: slack is measured against all groups, and not against few.
        """
        rounds, links, part = MOST_ROUNDS, self.threat.alpha_c + MARGIN, budget.part(ROUNDS_SHARE)
        while True:
            budget.check()
            found = self.prices.solve(threshold, budget.seconds_left)
            if rounds and found.links > links and not part.is_over:
                rounds = rounds - 1 if self.prices.add(self._cheap(found, threshold, budget)) else 0
                continue
            asked = found.scaled(links) if found.links > links else found
            if not self.prices.add(self._cheap(asked, threshold, budget)):
                return found

    def _cheap(self, prices: PriceVector, threshold: float, budget: Budget) -> list[KnownGroup]:
        """Groups that pay these prices, by annealing around each robot."""
        best, most, groups = np.zeros(self._n_robots, dtype=np.int8), self.threat.n_blinded, []
        at, cooling = (prices.robot, prices.blinded), (MOVES, WARM, COLD)
        for first in range(self._n_robots):
            budget.check()
            cost = cheap_group(self.team, self.links, at, (threshold, most), first, cooling, self._rng, best)
            if cost < -TOLERANCE:
                robots, value = best > 0, float(np.nextafter(threshold, -np.inf))
                groups.append(KnownGroup(robots=robots, need=int((best == BLINDED).sum()), value=value))
        return groups

    def _teach(self, listed: ListedGroups, threshold: float) -> int:
        """Add listed groups to the program where their need is known: others may not exist, and keep prices low."""
        below, known = np.nextafter(threshold, -np.inf), listed.need[:, 0] == listed.need[:, 1]
        rows = zip(listed.robots[known], listed.need[known, 0].tolist(), strict=True)
        return self.prices.add([KnownGroup(robots=row.copy(), need=need, value=float(below)) for row, need in rows])

    def _listed(
        self, prices: PriceVector, asked: tuple[float, int, float], budget: Budget, most: tuple[int, int]
    ) -> ListedGroups:
        """Groups of ``asked`` = (threshold, largest weak size, limit), within ``most`` = (nodes, groups)."""
        listed = list_groups(self.team, self.links, self._asked(prices, asked), budget, most)
        self._shuffled = listed.is_full
        return listed

    def _cover(self, prices: PriceVector, threshold: float, size: int, budget: Budget, nodes: int) -> Answer:
        """Try all partitions into groups of small reduced cost."""
        gap = self.threat.alpha_c - prices.links + TOLERANCE
        self._shuffled = False
        listed = self._listed(prices, (threshold, size, gap), budget, (nodes // LISTING, ROOM))
        if not listed.is_complete:
            return Answer(verdict=Threshold.OPEN)
        for members in partitions_into(listed, self.threat, self.prices.half_cuts(listed.robots), gap, budget):
            if (listed.need[members, 0] < listed.need[members, 1]).any():
                return Answer(verdict=Threshold.OPEN)
            group = np.zeros(self._n_robots, dtype=np.int64)
            for label, k in enumerate(members):
                group[listed.robots[k]] = label
            blind = np.asarray(listed.blinded[members].any(axis=0))
            return Answer(verdict=Threshold.REACHED, partition=Partition(group=group, blind=blind, value=threshold))
        return Answer(verdict=Threshold.REFUTED)
