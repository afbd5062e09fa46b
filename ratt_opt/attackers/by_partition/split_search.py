"""The exact attacker of larger teams on sparse graphs: how is the team split, and who is blinded in each group?

``graph/separable_groups.py`` lists every group an attack may leave. For a threshold, a group needs so many blinded
robots that some subset of the others is worth less (``GroupSurvivors``); the threshold is reachable exactly when the
team can be partitioned into groups within the link budget whose needs add up to at most the robots that may be blinded.
Needs are bounded from below first and computed only for groups that a partition asks for; a group needs at least what
any group inside it needs. Thresholds are bisected, which narrows the bracket from both sides.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.attackers.weakest_set.branch_and_bound import WeakestSetSearch
from ratt_opt.attackers.weakest_set.enumeration import AffineBound, Enumeration
from ratt_opt.attackers.weakest_set.exchanges import exchanged
from ratt_opt.attackers.weakest_set.minorant import affine_minorant
from ratt_opt.attackers.weakest_set.weakest_axis import weakest_axis
from ratt_opt.graph.separable_groups import IMPOSSIBLE, PartitionSearch
from ratt_opt.stopping import Stop

if TYPE_CHECKING:
    from ratt_opt._validation import FloatArray, IntArray
    from ratt_opt.attackers.task import AttackTask
    from ratt_opt.attackers.weakest_set.minorant import Minorant
    from ratt_opt.attackers.weakest_set.planar_team import PlanarTeam
    from ratt_opt.budget import Budget
    from ratt_opt.graph.separable_groups import SeparableGroups

__all__ = ["GroupSurvivors", "SplitSearch"]

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


BISECTED = 2e-3
"""Relative width below which the incumbent is tested instead of the middle: where it is optimal, one refutation
at its value closes the bracket for which bisection would take two dozen."""
NODES_BETWEEN_LOOKS = 20_000
"""Groups tried between two looks at the budget: some hundredths of a second."""
CHUNK = 4096
"""Groups whose values are computed at once: their matrices stay in cache."""


class SplitSearch:
    """Closes the task's bracket; relies on a non-decreasing objective."""

    def __init__(self, task: AttackTask, team: PlanarTeam, groups: SeparableGroups) -> None:
        self.task, self.team, self.groups = task, team, groups
        self.n_robots, self.n_blinded = task.problem.n_robots, task.problem.threat.n_blinded
        self.survivors = GroupSurvivors(team, task.problem.protected_robots)
        self._sizes = np.bitwise_count(groups.masks).astype(np.int64)
        self._floors = np.zeros((0, 0))
        """(G, n_blinded + 1) no subset of the group with so many robots blinded is worth less."""

    def run(self) -> Stop:
        """Bisect the threshold; the bracket is valid whenever this stops, and from there it can go on."""
        self.task.budget.spend()
        if not len(self._floors):
            self._floors = self._first_floors()
        bracket = self.task.bracket
        while not bracket.is_closed:
            width = bracket.upper - bracket.lower
            threshold = bracket.goal if width <= BISECTED * abs(bracket.upper) else bracket.lower + width / 2
            if not self._reach(threshold):
                bracket.raise_lower(threshold)
        return Stop.CLOSED

    def _first_floors(self) -> FloatArray:
        """Values of whole groups, and minorants over the team for those with blinded robots."""
        floors = np.full((len(self._sizes), self.n_blinded + 1), -np.inf)
        floors[:, 0] = self._whole()
        for size in range(self.n_robots - 1, 0, -1):
            blinded = self._sizes - size
            rows = np.flatnonzero((blinded >= 1) & (blinded <= self.n_blinded))
            if len(rows):
                self.task.budget.check()
                floors[rows, blinded[rows]] = self._size_floor(rows, size)
        # Blinding fewer robots leaves no less.
        return np.asarray(np.maximum.accumulate(floors[:, ::-1], axis=1)[:, ::-1])

    def _whole(self) -> FloatArray:
        team, robots = self.team, self.groups.robots
        information = team.information[robots].reshape(len(robots), -1)
        values = np.empty(len(self._sizes))
        for first in range(0, len(values), CHUNK):
            member = self.groups.masks[first : first + CHUNK, None] >> np.arange(len(robots)) & 1
            sums = team.prior + (member @ information).reshape(-1, *team.prior.shape)
            values[first : first + CHUNK] = team.values(sums)
        return values

    def _size_floor(self, rows: IntArray, size: int) -> FloatArray:
        """No ``size`` robots of the groups ``rows`` are worth less."""
        family = self.team.family(np.arange(self.n_robots), size)
        if self.team.objective.states("planar_levels"):
            return np.full(len(rows), weakest_axis(family).bound)
        minorant = affine_minorant(family, 2, -np.inf, self.survivors.minorants.get(size + 1))
        self.survivors.minorants[size] = minorant
        scores = minorant.scores[self.groups.robots]
        total, taken = np.full(len(rows), minorant.constant), np.zeros(len(rows), dtype=np.int64)
        for place in np.argsort(scores, kind="stable").tolist():
            takes = (self.groups.masks[rows] >> place & 1).astype(np.bool_) & (taken < size)
            total[takes] += scores[place]
            taken += takes
        return total

    def _reach(self, threshold: float) -> bool:
        """Find an attack below ``threshold``, or prove that there is none."""
        need = (self._floors >= threshold).sum(axis=1)
        need[need > self.n_blinded] = IMPOSSIBLE
        search = PartitionSearch(self.groups, need)
        exact: dict[int, frozenset[int]] = {}
        while not search.finished:
            chosen = search.next_within(NODES_BETWEEN_LOOKS, self.task.budget)
            if chosen is not None and self._within(chosen, threshold, need, exact):
                self._accept([(self.groups.members(group), exact[group]) for group in chosen])
                return True
        return False

    def _within(self, chosen: list[int], threshold: float, need: IntArray, exact: dict[int, frozenset[int]]) -> bool:
        """Settle the groups of a partition until their needs exceed the budget, or none is left: it is an attack."""
        for group in chosen:
            if group not in exact:
                self._settle(group, threshold, need, exact)
            if need[chosen].sum() > self.n_blinded:
                return False
        return True

    def _settle(self, group: int, threshold: float, need: IntArray, exact: dict[int, frozenset[int]]) -> None:
        """Compute what a group needs, and raise the needs of all groups around it."""
        robots = frozenset(self.groups.members(group).tolist())
        around = (self.groups.masks & self.groups.masks[group]) == self.groups.masks[group]
        for blinded in range(int(need[group]), self.n_blinded + 1):
            seeing = self.survivors.below(robots, len(robots) - blinded, threshold, self.task.budget)
            if seeing is not None:
                exact[group] = seeing
                return
            self._floors[around, : blinded + 1] = np.maximum(self._floors[around, : blinded + 1], threshold)
            need[around] = np.maximum(need[around], blinded + 1 if blinded < self.n_blinded else IMPOSSIBLE)

    def _accept(self, parts: list[tuple[IntArray, frozenset[int]]]) -> None:
        """Offer the attack, with the robots that may still be blinded spent on the best groups."""
        homes = [frozenset(robots.tolist()) for robots, _ in parts]
        seeing = [kept for _, kept in parts]
        for _ in range(self.n_blinded - self.n_robots + sum(map(len, seeing))):
            best = max(range(len(seeing)), key=lambda k: self.team.value(seeing[k]))
            fewer = self.survivors.by_exchanges(homes[best], len(seeing[best]) - 1)
            if fewer is None:
                break
            seeing[best] = fewer
        self.task.offer_split(homes, frozenset(range(self.n_robots)).difference(*seeing))
