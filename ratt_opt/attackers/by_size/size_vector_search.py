"""The exact attacker of large teams on a complete graph, two-dimensional targets.

Outcomes are told apart by their group sizes (``graph/survivor_sizes.py``). For each size of the
largest group, smallest first, the sets of that size are searched; a larger group contains
smaller ones, so by monotonicity what bounds the smaller size bounds the larger. Whenever a set below the
incumbent is found, the other groups of the outcome are packed; that makes a new incumbent or proves the set useless.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.attackers.task import AttackBracket
from ratt_opt.attackers.weakest_set.branch_and_bound import WeakestSetSearch
from ratt_opt.attackers.weakest_set.enumeration import Enumeration
from ratt_opt.attackers.weakest_set.exchanges import weak_sets_of_size
from ratt_opt.graph.outcomes import realise
from ratt_opt.graph.survivor_sizes import non_dominated_sizes
from ratt_opt.problem import Attack
from ratt_opt.stopping import Stop

if TYPE_CHECKING:
    from ratt_opt.attackers.task import AttackTask
    from ratt_opt.attackers.weakest_set.planar_team import PlanarTeam

__all__ = ["Packer", "Packing", "SizeVectorSearch", "unprotected_bound"]

LONGEST_PACKING = 500_000
"""Compiled nodes one packing question may take before it is left open: about a second. What is left open keeps the
bracket from closing, so it trades proofs for time."""


@dataclass(frozen=True, slots=True)
class Packing:
    """``groups`` below the threshold, or ``None``; ``decided`` says whether ``None`` is proved."""

    groups: tuple[frozenset[int], ...] | None
    decided: bool = True


@dataclass(slots=True)
class Packer:
    """Packs groups for one plan; ``must`` are robots that every outcome contains (they cannot be blinded)."""

    team: PlanarTeam
    must: frozenset[int]

    def pack(self, available: frozenset[int], sizes: tuple[int, ...], threshold: float) -> Packing:
        """Find disjoint groups of these sizes among ``available``, each worth less than ``threshold``.

        Weakest robots first; exact unless the search grows beyond ``LONGEST_PACKING`` nodes.
        """
        weak = frozenset(i for i in available if self.team.value([i]) < threshold)
        missing = self.must & available
        # No group below the threshold holds a robot that alone reaches it.
        if not missing <= weak or not len(missing) <= sum(sizes) <= len(weak):
            return Packing(None)
        quick = self._weakest(weak, sizes, threshold)
        # Robots on their own are all weak enough here, so only larger groups are searched for.
        if quick is not None or not sizes or sizes[0] == 1:
            return Packing(quick)
        return self._search(weak, sizes, threshold)

    def _weakest(
        self, available: frozenset[int], sizes: tuple[int, ...], threshold: float
    ) -> tuple[frozenset[int], ...] | None:
        """The weakest robots in order, the largest group first."""
        order = sorted(available, key=lambda i: (i not in self.must, self.team.single[i], i))[: sum(sizes)]
        order.sort(key=lambda i: (self.team.single[i], i))
        groups = []
        for size in sizes:
            group, order = frozenset(order[:size]), order[size:]
            if self.team.value(group) >= threshold:
                return None
            groups.append(group)
        return tuple(groups)

    def _search(self, available: frozenset[int], sizes: tuple[int, ...], threshold: float) -> Packing:
        robots = np.array(sorted(available, key=lambda i: (-self.team.single[i], i)), dtype=np.int64)
        sets = Enumeration(self.team, robots, frozenset(), sizes[0])
        decided = True
        while True:
            found = sets.next_below(threshold, LONGEST_PACKING)
            if found is None:
                return Packing(None, decided and sets.finished)
            if len(sizes) == 1:
                if self.must & available <= found:
                    return Packing((found,))
                continue
            rest = self.pack(available - found, sizes[1:], threshold)
            if rest.groups is not None:
                return Packing((found, *rest.groups))
            decided = decided and rest.decided


class SizeVectorSearch:
    """Closes the task's bracket; relies on a non-decreasing objective."""

    def __init__(self, task: AttackTask, team: PlanarTeam) -> None:
        self.task, self.team, self.bracket = task, team, task.bracket
        self.threat = task.problem.threat
        self.vectors = non_dominated_sizes(task.problem.n_robots, self.threat.n_blinded, self.threat.alpha_c)
        self.packer = Packer(team, self.threat.protected_robots)
        self.left_open = np.inf
        """Least value of a set whose packing question was given up; the proof cannot rise above it."""
        self.weakest = np.inf
        """Least value of any set found below the goal of its time."""

    def run(self) -> Stop:
        """Search every size of the largest group; the bracket is valid whenever this stops."""
        bracket = self.bracket
        if self.vectors == [()]:
            self._accept((frozenset(),))
            bracket.lower = bracket.upper
            return Stop.CLOSED
        sizes = sorted({vector[0] for vector in self.vectors})
        self._start(sizes)
        floor = bracket.lower
        for size in sizes:
            self._search(size, floor)
            # Larger groups contain sets of this size, all decided: none is worth less than this.
            floor = min(self.weakest, bracket.goal)
            if floor >= bracket.goal:
                break
        bracket.raise_lower(min(bracket.goal, self.left_open))
        return Stop.CLOSED if self.left_open >= bracket.goal else Stop.NODES

    def _start(self, sizes: list[int]) -> None:
        """Incumbents before the search: sets that no exchange makes weaker."""
        for size in sizes:
            self.task.budget.check()
            for robots in weak_sets_of_size(self.team, size):
                self._offer(robots)
                if self.bracket.goal <= self.team.value(robots):
                    break

    def _search(self, size: int, floor: float) -> None:
        """Offer every set of this size below the goal as a largest group."""
        search = WeakestSetSearch(self.team, size, self.bracket.goal, floor)
        for found in search.run(self.task.budget):
            if found is not None:
                self._offer(found)
                search.threshold = self.bracket.goal
            self.bracket.raise_lower(min(search.lower, self.bracket.goal, self.left_open, self.weakest))

    def _offer(self, largest: frozenset[int]) -> None:
        """Make attacks of a largest group, or learn that it has none below the goal."""
        value = self.team.value(largest)
        self.weakest = min(self.weakest, value)
        others = frozenset(range(len(self.team.single))) - largest
        for vector in self.vectors:
            while vector[0] == len(largest) and value < self.bracket.goal:
                packing = self.packer.pack(others, vector[1:], self.bracket.goal)
                if packing.groups is None:
                    if not packing.decided:
                        self.left_open = min(self.left_open, value)
                    break
                if not self._accept((largest, *packing.groups)):
                    break

    def _accept(self, groups: tuple[frozenset[int], ...]) -> bool:
        outcome = tuple(sorted(groups, key=lambda group: min(group, default=0)))
        return self.task.offer(Attack(*realise(self.threat, outcome)))


def unprotected_bound(task: AttackTask, team: PlanarTeam) -> None:
    """Raise the lower bound to the worst case without protected links, which is no larger; keep its attack if allowed.

    Relies on a non-decreasing objective. What is proved when the budget runs out is kept.
    """

    problem, bracket = task.problem, task.bracket
    relaxed = replace(problem, protected_links=frozenset())
    start = AttackBracket(Attack(), relaxed.team_value(task.values.plan, Attack()), bracket.lower)
    start.offer(bracket.attack, bracket.upper)
    try:
        SizeVectorSearch(replace(task, problem=relaxed, bracket=start), team).run()
    finally:
        bracket.raise_lower(min(start.lower, start.upper))
        if not start.attack.links & problem.protected_links:
            task.offer(start.attack)
