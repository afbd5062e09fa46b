"""Partitions of a team into groups that an attack may leave: who is blinded in each, and whether the needs fit.

A group needs so many blinded robots that some subset of the others is worth less than a threshold
(:class:`GroupSurvivors`). Needs may be given from below: they are raised only for groups that a partition asks for, and
no further than it takes to rule that partition out; a group needs at least what any group inside it needs.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.attack.least_sets.exchanges import exchanged
from ratt_opt.attack.least_sets.search import LeastSetSearch
from ratt_opt.attack.least_sets.sets_of_size import BoundedSets
from ratt_opt.attackers.by_partition.group_floors import SHARPER_AFTER, UnderestimatorsOfSizes, least_in_groups
from ratt_opt.graph.separable_groups import IMPOSSIBLE, PartitionSearch

if TYPE_CHECKING:
    from ratt_opt._validation import IntArray
    from ratt_opt.attack.least_sets.packed_team import PackedTeam
    from ratt_opt.attackers.task import AttackTask
    from ratt_opt.budget import Budget
    from ratt_opt.graph.separable_groups import SeparableGroups

__all__ = ["GroupSurvivors", "SettledPartitions"]

PLAIN_NODES, AXIS_NODES = 5_000, 500
"""Compiled nodes before a question is handed to the branch and bound, which bounds it afresh: easy questions are
answered without a bound of their own, hard ones soon get one; and where that bound is by the weakest axis, a closed
form but for one angle. With 30,000 hubs of 50 robots, (18, 9), max-eigenvalue, left 0.17 % after 10 s; it closes in
0.5."""


@dataclass(slots=True)
class GroupSurvivors:
    """Decides, for groups of one team, whether some subset of a given size is worth less than a threshold.

    ``must`` : robots that cannot be blinded
    """

    team: PackedTeam
    must: frozenset[int]
    underestimators: UnderestimatorsOfSizes = field(init=False)

    def __post_init__(self) -> None:
        self.underestimators = UnderestimatorsOfSizes(self.team)

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
        left, underestimator = size - len(fixed), self.underestimators.of(size)
        scores = None
        if underestimator is not None:  # the team's underestimator of this size holds for the subsets of every group
            constant = underestimator.constant + float(underestimator.scores[sorted(fixed)].sum())
            scores = constant, underestimator.scores[free]
        sets = BoundedSets(self.team.native(), free, fixed, left, threshold, scores, in_order=True)
        most = AXIS_NODES if self.team.is_by_axis else PLAIN_NODES
        while sets.nodes < most:
            found = sets.next(threshold, most, budget)
            if found is False:
                return None
            if found is not None:
                return found
        outside = frozenset(range(len(self.team.single))) - group
        search = LeastSetSearch(self.team, size, threshold, inside=fixed, outside=outside)
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
        self._sizes = np.bitwise_count(groups.masks).astype(np.int64)
        self._spent: dict[int, int] = {}
        """Nodes of searches by size of the sets."""
        self._sharpened: set[int] = set()
        """Sizes whose underestimator was sharpened."""
        self._chosen: list[int] | None = None
        self._weak: dict[int, frozenset[int]] = {}
        """A weak set of a group, the largest one known."""

    def reach(self, task: AttackTask) -> bool:
        """Find an attack below the threshold, or prove that no partition into these groups is one.

        Where the budget ends before, it can be gone on with.
        """
        while self._chosen is not None or not self._search.finished:
            if self._chosen is None:
                self._chosen = self._search.next_within(NODES_BETWEEN_LOOKS, task.budget)
            if self._chosen is not None and self._within(self._chosen, task.budget):
                self._accept(task, [(self._groups.members(group), self._weak[group]) for group in self._chosen])
                return True
            self._chosen = None
        return False

    def _within(self, chosen: list[int], budget: Budget) -> bool:
        """Whether blinding can make every group of a partition weak.

        Small groups are settled first; of the last one it is asked only what the others leave to blind.
        """
        smallest_first = sorted(chosen, key=lambda group: int(self._sizes[group]))
        for group in smallest_first:
            if not self._can_be_weak(group, self._n_blinded - int(self.need[chosen].sum() - self.need[group]), budget):
                return False
            if group != smallest_first[-1]:
                self._settle(group, budget)
        return True

    def _can_be_weak(self, group: int, most: int, budget: Budget) -> bool:
        """Whether blinding so many of its robots makes a group weak; if not, nor does it any group around it."""
        robots = frozenset(self._groups.members(group).tolist())
        free = len(robots - self._survivors.must)
        blinded = min(most, free)
        if self.need[group] > blinded:
            return False
        known = self._weak.get(group)
        if known is not None and len(robots) - len(known) <= blinded:
            return True
        size = len(robots) - blinded
        if self._is_sharpened(size, budget) and self.need[group] > blinded:
            return False
        before = budget.nodes
        seeing = self._survivors.below(robots, size, self._threshold, budget)
        self._spent[size] = self._spent.get(size, 0) + budget.nodes - before
        if seeing is not None:
            self._weak[group] = seeing
            return True
        masks = self._groups.masks
        around = (masks & masks[group]) == masks[group]
        more = blinded + 1 if blinded < min(free, self._n_blinded) else IMPOSSIBLE
        self.need[around] = np.maximum(self.need[around], more)
        return False

    def _is_sharpened(self, size: int, budget: Budget) -> bool:
        """If searches have taken long, raise the needs of all groups by a sharper underestimator of sets of a size."""
        if size in self._sharpened or self._spent.get(size, 0) < SHARPER_AFTER:
            return False
        underestimator = self._survivors.underestimators.sharper(size, self._threshold, budget)
        self._sharpened.add(size)
        if underestimator is None:
            return False
        blinded = self._sizes - size
        rows = np.flatnonzero((blinded >= 0) & (blinded <= self._n_blinded))
        rows = rows[least_in_groups(underestimator, self._groups, rows, size) >= self._threshold]
        more = np.where(blinded[rows] < self._n_blinded, blinded[rows] + 1, IMPOSSIBLE)
        self.need[rows] = np.maximum(self.need[rows], more)
        return True

    def _settle(self, group: int, budget: Budget) -> None:
        """Find how few robots have to be blinded in a group that can be weak."""
        size = int(self._sizes[group])
        while self.need[group] < size - len(self._weak[group]):
            self._can_be_weak(group, int(self.need[group]), budget)

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
