"""Partitions of a team into groups that an attack may leave: who is blinded in each, and whether the needs fit.

A group needs so many blinded robots that some subset of the others is worth less than a threshold
(:class:`GroupSurvivors`). Needs may be given from below: they are computed only for groups that a partition asks for; a
group needs at least what any group inside it needs.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.attackers.weakest_set.branch_and_bound import WeakestSetSearch
from ratt_opt.attackers.weakest_set.enumeration import AffineBound, Enumeration
from ratt_opt.attackers.weakest_set.exchanges import exchanged
from ratt_opt.graph.separable_groups import IMPOSSIBLE, PartitionSearch

if TYPE_CHECKING:
    from ratt_opt._validation import IntArray
    from ratt_opt.attackers.task import AttackTask
    from ratt_opt.attackers.weakest_set.minorant import Minorant
    from ratt_opt.attackers.weakest_set.planar_team import PlanarTeam
    from ratt_opt.budget import Budget
    from ratt_opt.graph.separable_groups import SeparableGroups

__all__ = ["GroupSurvivors", "SettledPartitions"]

PLAIN_NODES = 30_000
"""Compiled nodes before a question is handed to the branch and bound, which bounds it afresh: easy questions are
answered without a bound of their own, hard ones soon get one."""


@dataclass(slots=True)
class GroupSurvivors:
    """Decides, for groups of one team, whether some subset of a given size is worth less than a threshold.

    ``must`` : robots that cannot be blinded; ``minorants`` : by size, over all robots
    """

    team: PlanarTeam
    must: frozenset[int]
    minorants: dict[int, Minorant] = field(default_factory=dict)

    def by_exchanges(self, group: frozenset[int], size: int) -> frozenset[int] | None:
        """A weak subset: no claim; ``None`` where the size leaves no room for protected robots."""
        fixed = self.must & group
        if not len(fixed) <= size <= len(group):
            return None
        order = sorted(group - fixed, key=lambda i: (self.team.single[i], i))
        return exchanged(self.team, fixed.union(order[: size - len(fixed)]), among=group, fixed=fixed)

    def below(self, group: frozenset[int], size: int, threshold: float, budget: Budget) -> frozenset[int] | None:
        """A subset of ``size`` robots of ``group`` worth less than ``threshold``; ``None`` proves there is none.

        Spends nodes of ``budget``.
        """
        budget.spend()
        quick = self.by_exchanges(group, size)
        if quick is None or self.team.value(quick) < threshold:
            return quick
        fixed = self.must & group
        if size in {len(fixed), len(group)}:
            return None  # only one subset, looked at already
        free = np.array(sorted(group - fixed, key=lambda i: (-self.team.single[i], i)), dtype=np.int64)
        left, minorant = size - len(fixed), self.minorants.get(size)
        if minorant is None:
            sets = Enumeration(self.team, free, fixed, left)
        else:  # the team's minorant of this size holds for the subsets of every group
            constant = minorant.constant + float(minorant.scores[sorted(fixed)].sum())
            affine = AffineBound(constant, minorant.scores[free])
            sets = Enumeration.surest_first(self.team, free, fixed, left, affine)
        while not sets.finished and sets.nodes < PLAIN_NODES:
            found = sets.next_within(threshold, PLAIN_NODES - sets.nodes, budget)
            if found is not None:
                return found
        if sets.finished:
            return None
        outside = frozenset(range(len(self.team.single))) - group
        search = WeakestSetSearch(self.team, size, threshold, inside=fixed, outside=outside)
        return next((found for found in search.run(budget) if found is not None), None)


NODES_BETWEEN_LOOKS = 20_000
"""Groups tried between two looks at the budget: some hundredths of a second."""


class SettledPartitions:
    """Partitions into some groups, for one threshold.

    ``need`` : (G,) robots to blind in each group, at least; becomes larger where groups are settled
    """

    def __init__(self, survivors: GroupSurvivors, groups: SeparableGroups, need: IntArray, threshold: float) -> None:
        self._survivors, self._groups, self.need, self._threshold = survivors, groups, need, threshold
        self._n_blinded = groups.threat.n_blinded
        self.need[self.need > self._n_blinded] = IMPOSSIBLE
        self._search = PartitionSearch(groups, need)
        self._chosen: list[int] | None = None
        self._exact: dict[int, frozenset[int]] = {}

    def reach(self, task: AttackTask) -> bool:
        """Find an attack below the threshold, or prove that no partition into these groups is one.

        Where the budget ends before, it can be gone on with.
        """
        while self._chosen is not None or not self._search.finished:
            if self._chosen is None:
                self._chosen = self._search.next_within(NODES_BETWEEN_LOOKS, task.budget)
            if self._chosen is not None and self._within(self._chosen, task.budget):
                self._accept(task, [(self._groups.members(group), self._exact[group]) for group in self._chosen])
                return True
            self._chosen = None
        return False

    def _within(self, chosen: list[int], budget: Budget) -> bool:
        """Settle the groups of a partition until their needs exceed the budget, or none is left: it is an attack."""
        for group in chosen:
            if group not in self._exact:
                self._settle(group, budget)
            if self.need[chosen].sum() > self._n_blinded:
                return False
        return True

    def _settle(self, group: int, budget: Budget) -> None:
        """Compute what a group needs, and raise the needs of all groups around it."""
        masks = self._groups.masks
        robots = frozenset(self._groups.members(group).tolist())
        around = (masks & masks[group]) == masks[group]
        for blinded in range(int(self.need[group]), self._n_blinded + 1):
            seeing = self._survivors.below(robots, len(robots) - blinded, self._threshold, budget)
            if seeing is not None:
                self._exact[group] = seeing
                return
            more = blinded + 1 if blinded < self._n_blinded else IMPOSSIBLE
            self.need[around] = np.maximum(self.need[around], more)

    def _accept(self, task: AttackTask, parts: list[tuple[IntArray, frozenset[int]]]) -> None:
        """Offer the attack, with the robots that may still be blinded spent on the best groups."""
        team = self._survivors.team
        homes = [frozenset(robots.tolist()) for robots, _ in parts]
        seeing = [kept for _, kept in parts]
        everyone = frozenset(range(len(team.single)))
        for _ in range(self._n_blinded - len(everyone) + sum(map(len, seeing))):
            best = max(range(len(seeing)), key=lambda k: team.value(seeing[k]))
            fewer = self._survivors.by_exchanges(homes[best], len(seeing[best]) - 1)
            if fewer is None:
                break
            seeing[best] = fewer
        task.offer_split(homes, everyone.difference(*seeing))
