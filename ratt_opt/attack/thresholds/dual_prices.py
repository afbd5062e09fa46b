"""Decision of a threshold for an attack on any network: dual prices, pricing, and exact covers.

1. A linear program over known groups suggests dual prices of robots and of blinded ones (``columns.py``).
2. If they claim more links than the budget, they refute the threshold once no group has a negative reduced cost
   (``pricing.py``). They are taken in proportion, so that they claim little more. Groups that have one are added to the
   program.
3. Prices that claim ``gap`` links less leave groups of reduced cost at most ``gap``: they are listed, and exact covers
   by them searched (``exact_cover.py``). Either one is an attack, or the threshold is refuted.

Source: for the last step, Baldacci, Christofides and Mingozzi, Mathematical Programming 115 (2008).
"""

from __future__ import annotations

from ctypes import c_uint64
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.attack.annealing import Partition
from ratt_opt.attack.thresholds.columns import UNIT, dual_program, reduced_cost_rows
from ratt_opt.attack.thresholds.exact_cover import ExactCover, packed
from ratt_opt.attack.thresholds.pricing import DualPrices, GroupSearch, Question
from ratt_opt.attack.thresholds.threshold_search import Answer, Decision, Threshold

if TYPE_CHECKING:
    from collections.abc import Iterable

    from ratt_opt._validation import BoolArray, FloatArray
    from ratt_opt.attack.params.groups import MasterParams
    from ratt_opt.attack.thresholds.pricing import PricedGroup, PricingProblem
    from ratt_opt.budget import Budget
    from ratt_opt.graph.threat import Threat
    from ratt_opt.highs import LinearProgram

__all__ = ["GroupPrices", "KnownGroup", "ThresholdDecision"]


HALF = 2 * UNIT
"""Dual prices are about half links: each link that is cut leaves two groups."""


@dataclass(frozen=True, slots=True, kw_only=True)
class KnownGroup:
    """``robots`` (N,) with ``need`` of them blinded; asked for at thresholds above ``value`` only."""

    robots: BoolArray
    need: int
    value: float


class GroupPrices:
    """The linear program over known groups of one threat; groups may be added and the threshold changed at any time.

    Prices are of half links: if every group below the threshold has ``pi(g) <= cut(g) / 2 + mu need(g)``, an attack
    that leaves only such groups cuts at least ``sum of pi - mu alpha_s`` links.
    """

    def __init__(self, threat: Threat, params: MasterParams) -> None:
        self._threat, self._robots, self._params = threat, threat.graph.n_robots, params
        self._adjacent = np.zeros((self._robots, self._robots), dtype=np.int64)
        for i, j in threat.graph.links:
            self._adjacent[i, j] = self._adjacent[j, i] = 1
        self._groups: dict[tuple[bytes, int], KnownGroup] = {}
        self._program: LinearProgram | None = None
        self._threshold = -np.inf

    def add(self, groups: Iterable[KnownGroup]) -> int:
        """Add groups; returns how many are new."""
        fresh = []
        for group in groups:
            key = (group.robots.tobytes(), group.need)
            if key not in self._groups or self._groups[key].value > group.value:
                self._groups[key] = group
                fresh.append(group)
        if self._program is not None:
            self._enter(self._program, fresh)
        return len(fresh)

    def solve(self, threshold: float, seconds: float = np.inf) -> DualPrices:
        """Best prices at which no known group of this threshold has a negative reduced cost.

        After that many seconds, prices of nothing.
        """
        if self._program is None or threshold != self._threshold:
            most = 2.0 * len(self._threat.graph.links) + 2.0
            self._threshold, self._program = threshold, dual_program(self._robots, self._threat.n_blinded, most)
            self._enter(self._program, self._groups.values())
        claim, n = self._program.solve(seconds).x, self._robots
        if len(claim) != n + 1:
            return DualPrices(robot=np.zeros(n), blinded=0.0, links=0.0)
        robot, blinded = claim[:n], max(float(claim[n]), 0.0)
        if self._program.n_rows > self._params.most_rows:
            self._forget(robot, blinded)
        return DualPrices(robot=robot, blinded=blinded, links=float(robot.sum()) - blinded * self._threat.n_blinded)

    def half_cuts(self, groups: BoolArray) -> FloatArray:
        """(C,) half the links that separate the robots of each row of ``groups`` (C, N) from the others."""
        return np.asarray(0.5 * ((groups @ self._adjacent) * ~groups).sum(axis=1))

    def _enter(self, program: LinearProgram, groups: Iterable[KnownGroup]) -> None:
        below = [group for group in groups if group.value < self._threshold]
        if below:
            cuts = self.half_cuts(np.array([group.robots for group in below]))
            needs = [(np.flatnonzero(group.robots).tolist(), group.need) for group in below]
            program.add_rows(reduced_cost_rows(needs, cuts, self._robots))

    def _forget(self, robot: FloatArray, blinded: float) -> None:
        """Keep the groups whose reduced cost is among the least, and start afresh next time."""
        keys, groups = list(self._groups), list(self._groups.values())
        robots, need = np.array([group.robots for group in groups]), np.array([group.need for group in groups])
        costs = self.half_cuts(robots) + blinded * need - robots @ robot
        self._groups = {keys[k]: groups[k] for k in np.argsort(costs, kind="stable")[: self._params.most_rows // 2]}
        self._program = None


class ThresholdDecision(Decision):
    """Decision of thresholds for one plan; groups found for one threshold serve the next."""

    def __init__(self, plan: PricingProblem) -> None:
        self._plan, self._links, self.threat = plan, plan.links, plan.threat
        self._params = plan.team.params.dual_prices
        self.prices = GroupPrices(plan.threat, plan.team.params.master)
        self._begun: tuple[Question, GroupSearch] | None = None
        """The last question, and its search, if that did not end."""
        self._random = c_uint64(1)
        for i in range(plan.robots):
            alone = np.arange(plan.robots) == i
            self.prices.add([KnownGroup(robots=alone, need=0, value=float(plan.team.single[i]))])
            if not self._links.seeing[i]:
                self.prices.add([KnownGroup(robots=alone, need=1, value=0.0)])

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
        size, spent, links = self._plan.most_below(threshold), budget.nodes, self.threat.alpha_c + self._params.margin
        attempt = self._params.first_attempt
        while (left := nodes - (budget.nodes - spent)) > 0:
            found = self._settled(threshold, size, budget)
            is_enough = found.links > links
            prices = found.scaled(links) if is_enough else found
            question = question_of(
                prices, threshold, size, -self._params.tolerance if is_enough else -self._params.lowered
            )
            verdict = self._priced(question, min(attempt, left), budget)
            attempt *= self._params.longer
            if verdict is Threshold.REFUTED and not is_enough:
                return self._cover(prices.lowered(self._params.lowered), threshold, size, budget, nodes)
            if verdict is Threshold.REFUTED and self._is_too_much(question):
                return Answer(verdict=Threshold.REFUTED, prices=prices)
            if verdict in {Threshold.REFUTED, Threshold.OPEN}:
                break
        return Answer(verdict=Threshold.OPEN)

    def _priced(self, question: Question, nodes: int, budget: Budget) -> Threshold | None:
        """Price columns: REFUTED if no reduced cost is negative, REACHED if a new group's is, else OPEN.

        ``None`` : the search did not end after that many nodes; if the same is asked next, it goes on.
        """
        begun, self._begun = self._begun, None
        search = begun[1] if begun is not None and begun[0].is_same(question) else GroupSearch(self._plan, question)
        columns, is_complete = search.columns(nodes, self._params.new_groups, budget)
        below = float(np.nextafter(question.threshold, -np.inf))
        if columns:
            found = [KnownGroup(robots=one.robots, need=one.found, value=below) for one in columns]
            return Threshold.REACHED if self.prices.add(found) else Threshold.OPEN
        if is_complete:
            return Threshold.REFUTED
        self._begun = question, search
        return None

    def _is_too_much(self, question: Question) -> bool:
        """Test whether the dual bound exceeds the budget of links, in integers, if no reduced cost is negative."""
        claim = question.claim(self.threat.n_blinded) + min(question.limit, 0) * self._plan.robots
        return claim > 2 * self.threat.alpha_c * UNIT

    def _settled(self, threshold: float, size: int, budget: Budget) -> DualPrices:
        """Solve until annealing finds no column of negative reduced cost, or the prices claim too few links.

        The first rounds anneal at the prices that claim most: slack is measured against all groups, not few.
        """
        rounds, links, part = (
            self._params.rounds,
            self.threat.alpha_c + self._params.margin,
            budget.part(self._params.rounds_share),
        )
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
        """Find groups of negative reduced cost, by annealing around each robot."""
        question, groups, below = (
            question_of(prices, threshold, size, -self._params.tolerance),
            [],
            np.nextafter(threshold, -np.inf),
        )
        for column in self._plan.annealed(
            question, self._params.moves, (self._params.hot, self._params.cold), self._random
        ):
            budget.check()
            if column.cost < question.limit:
                groups.append(KnownGroup(robots=column.robots, need=column.need, value=float(below)))
        return groups

    def _cover(self, prices: DualPrices, threshold: float, size: int, budget: Budget, nodes: int) -> Answer:
        """Try all partitions into groups of small reduced cost."""
        question = question_of(prices, threshold, size, 0.0)
        gap = 2 * self.threat.alpha_c * UNIT - question.claim(self.threat.n_blinded)
        gap += self._params.rounded * self._plan.robots
        question = replace(question, limit=gap + 1)
        search = GroupSearch(self._plan, question)
        columns, is_complete = search.columns(nodes // self._params.listing, self._params.room, budget)
        if not is_complete:
            return Answer(verdict=Threshold.OPEN)
        members = self._covered(sorted(columns, key=lambda column: column.cost), gap, budget)
        if not members:
            return Answer(verdict=Threshold.REFUTED, prices=prices)
        if any(column.need < column.found for column in members):
            return Answer(verdict=Threshold.OPEN)
        group = np.zeros(self._plan.robots, dtype=np.int64)
        for label, column in enumerate(members):
            group[column.robots] = label
        blind = np.any([column.blinded for column in members], axis=0)
        return Answer(verdict=Threshold.REACHED, partition=Partition(group=group, blind=blind, value=threshold))

    def _covered(self, columns: list[PricedGroup], gap: int, budget: Budget) -> list[PricedGroup]:
        """Columns, sorted by reduced cost, that partition the team within the budgets; none if no columns do."""
        if not columns:
            return []
        robots = np.array([column.robots for column in columns])
        cuts = np.rint(2 * self.prices.half_cuts(robots)).astype(np.int64)
        costs = np.array([[max(column.cost, 0), column.need] for column in columns], dtype=np.int64)
        most = gap, self.threat.n_blinded, 2 * self.threat.alpha_c
        cover = ExactCover(self._plan.robots, packed(robots), np.column_stack([costs, cuts]), most)
        return [columns[k] for k in cover.found(budget)]


def question_of(prices: DualPrices, threshold: float, most: int, limit: float) -> Question:
    """The question for groups of reduced cost less than ``limit`` [links]; rounding makes every group cost no less."""
    duals = np.floor(prices.robot * HALF).astype(np.int64)
    return Question(threshold, most, duals, int(np.ceil(prices.blinded * HALF)), int(np.floor(limit * HALF)))
