"""Is there an attack worth less than a threshold? By all groups that one may leave, if these can be listed.

A column has at least as many blinded robots as is known of sets of robots, of each of which only that many may sense
below the threshold. At first that is known of the strongest robots, any number of them. A linear program over all
columns gives duals (``master.py``). Columns of its solution that need more robots blinded than was known get a set of
their own, as large as it can be, which says as much of all columns that overlap it; and the program is solved again.
At last columns of small reduced cost are few, and exact covers by them are searched.

Source: for the last step, Baldacci, Christofides and Mingozzi, Mathematical Programming 115 (2008).
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.attack.annealing import Partition
from ratt_opt.attack.columns import UNIT
from ratt_opt.attack.exact_cover import STEPS, ExactCover
from ratt_opt.attack.least_sets.search import LeastSetSearch
from ratt_opt.attack.master import best_duals
from ratt_opt.attack.threshold_search import Answer, Threshold
from ratt_opt.budget import Stop

if TYPE_CHECKING:
    from collections.abc import Sequence

    from ratt_opt._validation import IntArray
    from ratt_opt.attack.columns import Duals
    from ratt_opt.attack.least_sets.packed_team import PackedTeam
    from ratt_opt.attack.pricing import Plan
    from ratt_opt.attack.task import AttackTask
    from ratt_opt.budget import Budget
    from ratt_opt.graph.separable_groups import SeparableGroups

__all__ = ["FEW_LISTED", "ListedColumns", "ListedSearch"]

ADDED = 200
"""Columns that enter the program at a time."""

FEW_LISTED, STEP = 20_000, 0.02
"""If columns are more than these few, a threshold that far below the attack in hand is decided first."""


class ListedSearch:
    """Closes the task's bracket; relies on a non-decreasing objective. It goes on where it ended."""

    def __init__(self, task: AttackTask, plan: Plan, team: PackedTeam, listed: SeparableGroups) -> None:
        self.task, self._given = task, (plan, team, listed)
        self._begun: ListedColumns | None = None

    def run(self) -> Stop:
        """Decide thresholds; an attack that is no worse than the one in hand ends the search.

        Raises
        ------
        OutOfBudget : the budget is spent; the bracket is valid.
        """
        bracket = self.task.bracket
        while not bracket.is_closed:
            threshold = self._threshold()
            if self._begun is None or self._begun.threshold != threshold:
                self._begun = ListedColumns(*self._given, threshold)
            answer = self._begun.decide(self.task.budget)
            if answer.partition is None:
                bracket.raise_lower(threshold)
            elif not self.task.offer(answer.partition.attack(self.task.problem.threat)):
                return Stop.HEURISTIC
        return Stop.CLOSED

    def _threshold(self) -> float:
        bracket = self.task.bracket
        first = bracket.upper - STEP * abs(bracket.upper)
        are_many = len(self._given[-1].masks) > FEW_LISTED
        return first if are_many and bracket.lower < first else bracket.goal


class ListedColumns:
    """Columns of one threshold: ``groups`` (C,) masks, ``cuts`` (C,) links that leave, ``blinded`` (C,) at least."""

    def __init__(self, plan: Plan, team: PackedTeam, listed: SeparableGroups, threshold: float) -> None:
        self._plan, self._team, self._threat, self.threshold = plan, team, listed.threat, threshold
        self.robots = plan.robots
        self.groups, self.cuts = listed.by_robots(), listed.links
        self.blinded = np.zeros(len(self.groups), dtype=np.int64)
        self._members = (self.groups[:, None] >> np.arange(self.robots) & 1).astype(np.int64)
        self._seeing = sum(1 << i for i in self._threat.protected_robots)
        self._strongest = [int(i) for i in np.argsort(-plan.single, kind="stable")]
        self._sets: list[tuple[int, int]] = []
        """Masks, and how many of their robots may sense."""
        self._below: list[int] = []
        """Masks of sets worth less than the threshold."""
        self._asked: tuple[int, int, LeastSetSearch] | None = None
        """The question in hand: of which set and size, and its search."""
        self._covers: tuple[IntArray, ExactCover] | None = None
        """Masks of columns within the gap, and the search of covers by them, if it is begun."""

    # -- what the master asks ------------------------------------------------------------------------------------

    def cheapest(self, duals: Duals) -> tuple[int, IntArray]:
        """The least reduced cost, and columns of negative one, the cheapest first."""
        costs = self._costs(duals)
        some = np.argsort(costs, kind="stable")[:ADDED]
        return int(costs.min(initial=0)), some[costs[some] < 0]

    def _costs(self, duals: Duals) -> IntArray:
        return np.asarray(UNIT * self.cuts + duals.blinding * self.blinded - self._members @ duals.robots)

    # -- the decision --------------------------------------------------------------------------------------------

    def decide(self, budget: Budget) -> Answer:
        """Decide the threshold; a node is a program solved, or one of a search of covers or of sets.

        Raises
        ------
        OutOfBudget : the budget is spent.
        """
        n_blinded, most_cut = self._threat.n_blinded, 2 * self._threat.alpha_c
        if not self._sets:
            self._ask_strongest(budget)
        while True:
            if self._covers is None:
                budget.spend()
                duals, support = best_duals(self, n_blinded, most_cut, budget)
                gap = most_cut * UNIT - duals.claim(n_blinded)
                if gap < 0:
                    return Answer(verdict=Threshold.REFUTED)
                if self._raised(self.groups[support].tolist(), budget):
                    continue
                self._covers = self._within(duals, gap)
            chosen = self._next_cover(*self._covers, budget)
            self._covers = None
            if not chosen:
                return Answer(verdict=Threshold.REFUTED)
            if not self._raised(chosen, budget):
                partition = self._partition(chosen, budget)
                if partition is not None:
                    return Answer(verdict=Threshold.REACHED, partition=partition)

    def _ask_strongest(self, budget: Budget) -> None:
        room = self._plan.most_below(self.threshold)
        self._learn((1 << self.robots) - 1, room)
        for size in range(self.robots - 1, 0, -1):
            budget.check()
            mask, before = sum(1 << i for i in self._strongest[:size]), min(room, size)
            room = self._room(mask, before, budget)
            if room < before:
                self._learn(mask, room)
        self._keep_possible()

    def _raised(self, masks: Sequence[int], budget: Budget) -> bool:
        """Ask how many robots the columns need blinded; whether any needs more than was known."""
        before = len(self._sets)
        for mask in masks:
            budget.check()
            size = mask.bit_count()
            known = max((mask & one).bit_count() - room for one, room in self._sets)
            room = self._room(mask, size - max(known, 0), budget)
            if room < size - max(known, 0):
                self._learn(self._enlarged(mask, room, budget), room)
        self._keep_possible()
        return len(self._sets) > before

    def _room(self, mask: int, most: int, budget: Budget) -> int:
        """How many robots of a set may sense, at most ``most``."""
        while most > 0 and not self._may_sense(mask, most, budget):
            most -= 1
        return most

    def _enlarged(self, mask: int, room: int, budget: Budget) -> int:
        for i in self._strongest:
            budget.check()
            if not mask >> i & 1 and not self._may_sense(mask | 1 << i, room + 1, budget):
                mask |= 1 << i
        return mask

    def _may_sense(self, mask: int, size: int, budget: Budget) -> bool:
        """Whether ``size`` robots of a set are worth less than the threshold together."""
        if any((mask & below).bit_count() >= size for below in self._below):
            return True
        if any((mask & one).bit_count() - room > mask.bit_count() - size for one, room in self._sets):
            return False
        if self._asked is None or self._asked[:2] != (mask, size):
            outside = frozenset(i for i in range(self.robots) if not mask >> i & 1)
            self._asked = mask, size, LeastSetSearch(self._team, size, self.threshold, outside=outside)
        search = self._asked[2].run(budget)
        found = next((one for one in search if one is not None), None)
        self._asked = None
        if found is not None:
            self._below.append(sum(1 << i for i in found))
        return found is not None

    def _learn(self, mask: int, room: int) -> None:
        self._sets.append((mask, room))
        self.blinded = np.maximum(self.blinded, np.bitwise_count(self.groups & mask).astype(np.int64) - room)
        self.blinded[np.bitwise_count(self.groups & (mask & self._seeing)) > room] = self._threat.n_blinded + 1

    def _keep_possible(self) -> None:
        kept = self.blinded <= self._threat.n_blinded
        self.groups, self.cuts, self.blinded, self._members = (
            one[kept] for one in (self.groups, self.cuts, self.blinded, self._members)
        )

    def _within(self, duals: Duals, gap: int) -> tuple[IntArray, ExactCover]:
        """The columns of reduced cost at most ``gap``, and the search of covers by them."""
        costs = self._costs(duals)
        few = np.argsort(costs, kind="stable")
        few = few[costs[few] <= gap]
        paid = np.column_stack([costs[few], self.blinded[few], self.cuts[few]])
        most = gap, self._threat.n_blinded, 2 * self._threat.alpha_c
        return self.groups[few], ExactCover(self.robots, self.groups[few, None].astype(np.uint64), paid, most)

    @staticmethod
    def _next_cover(groups: IntArray, search: ExactCover, budget: Budget) -> list[int]:
        """The groups of a cover; none if there is none."""
        places = None
        while places is None:
            places = search.next(budget, STEPS)
        return groups[places].tolist() if isinstance(places, list) else []

    def _partition(self, groups: list[int], budget: Budget) -> Partition | None:
        """The attack that leaves these groups; ``None`` if one of them needs more robots blinded than was known."""
        label, blind = np.zeros(self.robots, dtype=np.int64), np.zeros(self.robots, dtype=np.bool_)
        for k, mask in enumerate(groups):
            inside = frozenset(i for i in range(self.robots) if mask >> i & 1)
            size = len(inside) - int(self.blinded[np.flatnonzero(self.groups == mask)[0]])
            label[list(inside)] = k
            outside, fixed = frozenset(range(self.robots)) - inside, inside & self._threat.protected_robots
            search = LeastSetSearch(self._team, size, self.threshold, inside=fixed, outside=outside)
            seeing = next((one for one in search.run(budget) if one is not None), None)
            if seeing is None:
                if fixed:  # other groups have other protected robots
                    self.blinded[self.groups == mask] += 1
                else:
                    self._learn(mask, size - 1)
                self._keep_possible()
                return None
            blind[list(inside - seeing)] = True
        return Partition(group=label, blind=blind, value=self.threshold)
