"""Is there an attack worth less than a threshold? By prices, enumeration and covers.

1. Prices (``program.py``) that claim more links than the budget refute the threshold once a search over the robots
   that sense or are inside (``column_search.py``) has found no group that pays them; groups that do are added to the
   program.
2. Prices that claim ``gap`` links less leave the groups of reduced cost at most ``gap``: they are listed, and the
   partitions into them tried (``exact_cover.py``). Either one is an attack, or the threshold is refuted.

Source: for the second step, Baldacci, Christofides and Mingozzi, Mathematical Programming 115 (2008).
"""

from __future__ import annotations

from ctypes import c_uint64
from dataclasses import replace
from functools import partial
from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.attack.annealing import Partition
from ratt_opt.attack.dual_prices.column_search import ColumnSearch, question_of
from ratt_opt.attack.dual_prices.program import GroupPrices, KnownGroup
from ratt_opt.attack.exact_cover import ExactCover, packed
from ratt_opt.attack.pricing import UNIT, DualPrices
from ratt_opt.attack.threshold_search import Answer, Threshold

if TYPE_CHECKING:
    from collections.abc import Callable

    from ratt_opt.attack.pricing import Column, Plan, Question
    from ratt_opt.budget import Budget

    _Choice = Callable[[float, float, float], DualPrices | None]

__all__ = ["ThresholdDecision"]


MARGIN = 5e-3
"""Links that scaled prices claim beyond the budget; well above rounding, well below one link."""

TOLERANCE = 1e-6
"""Reduced costs below minus this count as negative: above what the linear program leaves of its rows, and a team's sum
stays well below MARGIN."""

RESERVE = 0.3
"""Share of the links that could be claimed beyond the budget that prices claim, too, to be lowered for groups that pay.
Measured at hubs of 30 robots (10, 31) and 97 % of the attack: two searches instead of five, of 60,000 nodes."""

LOWERED = 0.003
"""By which all robots' prices fall once no group has a reduced cost below minus this: then none is negative."""

FIRST_ATTEMPT, LONGER = 10_000, 3
"""Nodes of the first search at each of a few prices, and their growth while none of them ends."""

ROUNDED = 2
"""Units of duals by which rounding may leave the cost of a group below zero."""

MOVES, WARM = 1_500, (4.0, 0.1)
"""Moves around each robot to find groups that pay the prices; the temperatures they cool between, in links that leave a
group."""

MOST_ROUNDS, ROUNDS_SHARE = 50, 0.05
"""Of annealing at the prices that claim most, and of the seconds left for it. At 100 robots of hubs three seconds make
a threshold at 94 % of the attack one of 800 nodes, which take more than 25,000 at the prices for few groups."""

ROOM, NEW_GROUPS, LISTING = 100_000, 100, 2
"""Groups listed for covers; groups added to the program at a time; nodes that one of a listing counts for."""


class ThresholdDecision:
    """Decides thresholds for one plan; what is learned about groups serves the next threshold."""

    def __init__(self, plan: Plan) -> None:
        self._plan, self._links, self.threat = plan, plan.links, plan.threat
        self.prices = GroupPrices(plan.threat)
        self._search = ColumnSearch(plan)
        self._random = c_uint64(1)
        self._attempt = FIRST_ATTEMPT
        self._choices: list[_Choice] = [self.prices.slackest, partial(self.prices.dearest, reserve=RESERVE)]
        for i in range(plan.robots):
            alone = np.arange(plan.robots) == i
            self.prices.add([KnownGroup(robots=alone, need=0, value=float(plan.team.single[i]))])
            if not self._links.seeing[i]:
                self.prices.add([KnownGroup(robots=alone, need=1, value=0.0)])

    @property
    def least(self) -> float:
        """Nothing is known beside thresholds."""
        return -np.inf

    def learn(self, partition: Partition) -> None:
        """Add the groups of an attack to the program."""
        for label in np.unique(partition.group):
            robots = partition.group == label
            value = self._plan.team.value(np.flatnonzero(robots & ~partition.blind))
            self.prices.add([KnownGroup(robots=robots, need=int((robots & partition.blind).sum()), value=value)])

    def decide(self, threshold: float, budget: Budget, nodes: int) -> Answer:
        """Decide one threshold; ``OPEN`` after that many nodes of one enumeration.

        Raises
        ------
        OutOfBudget : the time is up.
        """
        budget.check()
        size, spent = self._plan.most_below(threshold), budget.nodes
        self._attempt = max(self._attempt // LONGER, FIRST_ATTEMPT)
        while budget.nodes - spent < nodes:
            found = self._settled(threshold, size, budget)
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

    def _refute(self, threshold: float, size: int, budget: Budget) -> Answer | None:
        """Ask whether no group pays prices that claim more than the budget; ``None`` if more is to be done.

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
        found = self._settled(threshold, size, budget)
        if found.links <= links:
            return None
        answer = self._answered(found.scaled(links + RESERVE * (found.links - links)), asked, budget)
        self._attempt *= LONGER
        return None if answer is None or answer.verdict is Threshold.REACHED else answer

    def _answered(self, prices: DualPrices, asked: tuple[float, int, float], budget: Budget) -> Answer | None:
        """Whether no group pays (REFUTED), some new one does (REACHED) or an old one (OPEN); ``None`` : unknown."""
        threshold, size, limit = asked
        if self.prices.add(self._cheap(prices, threshold, size, budget)):
            return Answer(verdict=Threshold.REACHED)
        question = question_of(prices, threshold, size, limit)
        found = self._search.find(question, budget, nodes=self._attempt, room=NEW_GROUPS)
        if found.groups:
            return Answer(verdict=Threshold.REACHED if self.prices.add(found.groups) else Threshold.OPEN)
        if not found.is_complete or (prices.links > self.threat.alpha_c and not self._is_too_much(prices, question)):
            return None
        return Answer(verdict=Threshold.REFUTED, prices=prices)

    def _is_too_much(self, prices: DualPrices, question: Question) -> bool:
        """Whether prices that no group pays claim more links than the budget, as integers."""
        lowered = question_of(prices, question.threshold, question.most, 0.0)
        claim = lowered.claim(self.threat.n_blinded) + min(question.limit, 0) * self._plan.robots
        return claim > 2 * self.threat.alpha_c * UNIT

    def _settled(self, threshold: float, size: int, budget: Budget) -> DualPrices:
        """Prices that no group found by annealing pays, or not enough to claim more links than the budget.

        The first rounds ask the prices that claim most: slack is measured against all groups, and not against few.
        """
        rounds, links, part = MOST_ROUNDS, self.threat.alpha_c + MARGIN, budget.part(ROUNDS_SHARE)
        while True:
            budget.check()
            found = self.prices.solve(threshold, budget.seconds_left)
            if rounds and found.links > links and not part.is_over:
                rounds = rounds - 1 if self.prices.add(self._cheap(found, threshold, size, budget)) else 0
                continue
            asked = found.scaled(links) if found.links > links else found
            if not self.prices.add(self._cheap(asked, threshold, size, budget)):
                return found

    def _cheap(self, prices: DualPrices, threshold: float, size: int, budget: Budget) -> list[KnownGroup]:
        """Groups that pay these prices, by annealing around each robot."""
        question, groups, below = question_of(prices, threshold, size, -TOLERANCE), [], np.nextafter(threshold, -np.inf)
        for column in self._plan.annealed(question, MOVES, WARM, self._random):
            budget.check()
            if column.cost < question.limit:
                groups.append(KnownGroup(robots=column.robots, need=column.need, value=float(below)))
        return groups

    def _cover(self, prices: DualPrices, threshold: float, size: int, budget: Budget, nodes: int) -> Answer:
        """Try all partitions into groups of small reduced cost."""
        question = question_of(prices, threshold, size, 0.0)
        gap = 2 * self.threat.alpha_c * UNIT - question.claim(self.threat.n_blinded)
        gap += ROUNDED * self._plan.robots
        question = replace(question, limit=gap + 1)
        listed = self._search.listed(question, budget, nodes // LISTING, ROOM)
        if not listed.is_complete:
            return Answer(verdict=Threshold.OPEN)
        columns = sorted(listed.columns, key=lambda column: column.cost)
        members = self._covered(columns, gap, budget)
        if not members:
            return Answer(verdict=Threshold.REFUTED, prices=prices)
        if any(column.need < column.found for column in members):
            return Answer(verdict=Threshold.OPEN)
        group = np.zeros(self._plan.robots, dtype=np.int64)
        for label, column in enumerate(members):
            group[column.robots] = label
        blind = np.any([column.blinded for column in members], axis=0)
        return Answer(verdict=Threshold.REACHED, partition=Partition(group=group, blind=blind, value=threshold))

    def _covered(self, columns: list[Column], gap: int, budget: Budget) -> list[Column]:
        """Columns, sorted by reduced cost, that partition the team within the budgets; none if no columns do."""
        if not columns:
            return []
        robots = np.array([column.robots for column in columns])
        cuts = np.rint(2 * self.prices.half_cuts(robots)).astype(np.int64)
        costs = np.array([[max(column.cost, 0), column.need] for column in columns], dtype=np.int64)
        most = gap, self.threat.n_blinded, 2 * self.threat.alpha_c
        cover = ExactCover(self._plan.robots, packed(robots), np.column_stack([costs, cuts]), most)
        return [columns[k] for k in cover.found(budget)]
