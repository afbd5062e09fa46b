"""Decision of a threshold by all groups that an attack may leave, if these can be listed.

A limit is a set of robots, and the most of these that can sense below the threshold
(``least_sets/max_cardinality.py``): it says how many robots must be blinded in a column. At first there are limits for
the strongest robots, any number of them. A linear program over all columns gives duals (``columns.py``). Columns of its
solution in which more robots must be blinded than the limits say get limits of their own, which hold for all columns
that overlap them; and the program is solved again. At last columns of small reduced cost are few, and exact covers by
them are searched.

Source: for the last step, Baldacci, Christofides and Mingozzi, Mathematical Programming 115 (2008).
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.attack.annealing import Partition
from ratt_opt.attack.least_sets.max_cardinality import MaxCardinalityBelow
from ratt_opt.attack.thresholds.columns import UNIT, Column, Columns, IntegerDuals, best_duals
from ratt_opt.attack.thresholds.threshold_search import Answer, Threshold
from ratt_opt.budget import OutOfBudget, Stop
from ratt_opt.graph.communication import mask_of, robots_of

if TYPE_CHECKING:
    from collections.abc import Sequence

    from ratt_opt.attack.task import AttackTask
    from ratt_opt.attack.team import Team
    from ratt_opt.attack.thresholds.exact_cover import ExactCover
    from ratt_opt.budget import Budget
    from ratt_opt.graph.group_list import GroupList
    from ratt_opt.graph.threat import Threat

__all__ = ["ListedColumns", "ListedSearch"]


class ListedSearch:
    """Resumable search by listed columns; relies on a non-decreasing objective.

    ``groups`` : all that an attack may leave
    """

    def __init__(self, task: AttackTask, team: Team, groups: GroupList) -> None:
        self.task, self._team, self._groups = task, team, groups
        self._begun: dict[float, ListedColumns] = {}
        """Thresholds that are begun."""
        self._was_ended = False

    def run(self) -> Stop:
        """Decide thresholds; an attack that is no worse than the one in hand, or an open threshold, ends the search.

        Raises
        ------
        OutOfBudget : the budget is spent; the bracket is valid.
        """
        bracket = self.task.bracket
        while not bracket.is_closed:
            threshold = self._threshold()
            self._begun = {one: begun for one, begun in self._begun.items() if one in {threshold, bracket.goal}}
            if threshold not in self._begun:
                threat = self.task.problem.threat
                self._begun[threshold] = ListedColumns(threat, self._team, self._groups, threshold)
            try:
                answer = self._begun[threshold].decide(self.task.budget)
            except OutOfBudget:
                self._was_ended = True
                if self.task.budget.stop() is not None:
                    raise
                return Stop.HEURISTIC
            if answer.verdict is Threshold.REFUTED:
                bracket.raise_lower(threshold)
            elif answer.partition is None or not self.task.offer(answer.partition.attack(self.task.problem.threat)):
                return Stop.HEURISTIC
        return Stop.CLOSED

    def _threshold(self) -> float:
        bracket = self.task.bracket
        first = bracket.upper - self._team.params.listed.step * abs(bracket.upper)
        return first if self._was_ended and bracket.lower < first else bracket.goal


class ListedColumns:
    """The columns of one threshold, with the robots that are at least to blind in each."""

    def __init__(self, threat: Threat, team: Team, groups: GroupList, threshold: float) -> None:
        self._threat, self._team, self.threshold = threat, team, threshold
        masks, cuts = groups.so_far()
        self._columns = Columns(groups.robots, masks.copy(), cuts.copy(), np.zeros_like(cuts))
        self._cardinality = MaxCardinalityBelow(team, threshold, mask_of(threat.protected_robots))
        self.is_begun, self._restricted = False, 0
        """Flag that the strongest robots have their limits; number of limits that the columns have."""
        self._entered: list[Column] = []
        """Columns of the last program."""
        self._covers: tuple[Columns, ExactCover] | None = None
        """Columns within the gap, and the search of covers by them, if it is begun."""

    @property
    def limits(self) -> list[tuple[int, int]]:
        """Limits known so far (:class:`MaxCardinalityBelow`)."""
        return self._cardinality.limits

    def decide(self, budget: Budget) -> Answer:
        """Decide the threshold, or leave it open if too many columns are within the gap.

        Raises
        ------
        OutOfBudget : the budget is spent; it goes on where it ended.
        """
        n_blinded, most_cut = self._threat.n_blinded, 2 * self._threat.alpha_c
        while True:
            if self._covers is None:
                duals = self.duals(most_cut, budget)
                gap = most_cut * UNIT - duals.claim(n_blinded)
                if gap < 0:
                    return Answer(verdict=Threshold.REFUTED)
                within = self._columns.within(duals, gap, self._team.params.listed.most_within)
                if within is None:
                    return Answer(verdict=Threshold.OPEN)
                few, costs = within
                self._covers = few, few.covers(costs, (gap, n_blinded, most_cut))
            few, covers = self._covers
            chosen = few.some(covers.found(budget))
            self._covers = None
            if not chosen:
                return Answer(verdict=Threshold.REFUTED)
            if not self._has_limited(chosen, budget):
                return Answer(verdict=Threshold.REACHED, partition=self._partition(chosen))

    def duals(self, enough: int, budget: Budget) -> IntegerDuals:
        """Duals under which no column below the threshold has a negative reduced cost.

        They claim more than ``enough`` links, counted from both sides, or what they claim is the most: limits say how
        many robots are to blind in all columns of the linear program's solution.

        Raises
        ------
        OutOfBudget : the budget is spent; it goes on where it ended.
        """
        if not self.is_begun:
            self._limit_strongest(budget)
            self.is_begun = True
        while True:
            budget.spend()
            self._restrict()
            bound = best_duals(
                self._columns, self._threat.n_blinded, enough, budget, self._team.params.master, self._still_possible()
            )
            self._entered = bound.columns
            if bound.duals.claim(self._threat.n_blinded) > enough * UNIT or not self._has_limited(bound.used, budget):
                return bound.duals

    def _limit_strongest(self, budget: Budget) -> None:
        """Add the limits of the strongest robots; raises ``OutOfBudget``, also once their share of the time is over."""
        most = None if budget.max_nodes is None else budget.nodes_left(budget.max_nodes)
        part = budget.part(self._team.params.listed.strongest, max_nodes=most)
        try:
            self._cardinality.limit_strongest(part)
        finally:
            budget.nodes += part.nodes

    def _restrict(self) -> None:
        """Tell the columns the limits that they do not have."""
        for limit in self.limits[self._restricted :]:
            self._columns.restrict(*limit, self._threat)
        self._restricted = len(self.limits)

    def _still_possible(self) -> list[Column]:
        """Columns of the last program, with the robots that are now to blind in them."""
        needs = [one.group.bit_count() - self._cardinality.known(one.group) for one in self._entered]
        entered = zip(self._entered, needs, strict=True)
        return [Column(one.group, one.cut, need) for one, need in entered if need <= self._threat.n_blinded]

    def _has_limited(self, columns: Sequence[Column], budget: Budget) -> bool:
        """Ask how many robots are to blind in columns; whether limits were added because that is more than known."""
        before = len(self.limits)
        for column in columns:
            budget.check()
            most = self._cardinality.of(column.group, budget)
            if most < column.group.bit_count() - column.blinded and most < self._cardinality.known(column.group):
                self._cardinality.limit(column.group, most, budget)
        return len(self.limits) > before

    def _partition(self, cover: Sequence[Column]) -> Partition:
        """The attack that leaves these groups."""
        robots = self._columns.robots
        label, blind = np.zeros(robots, dtype=np.int64), np.zeros(robots, dtype=np.bool_)
        for k, column in enumerate(cover):
            inside = frozenset(robots_of(column.group))
            seeing = self._cardinality.set_below(column.group, len(inside) - column.blinded)
            label[list(inside)] = k
            blind[list(inside - seeing)] = True
        return Partition(group=label, blind=blind, value=self.threshold)
