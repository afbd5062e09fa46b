"""The exact attacker of large teams on a complete graph, two-dimensional targets.

Outcomes are told apart by their group sizes (``graph/survivor_sizes.py``). For each size of the
largest group, smallest first, the sets of that size are searched; a larger group contains
smaller ones, so by monotonicity what bounds the smaller size bounds the larger. Whenever a set below the
incumbent is found, the other groups of the outcome are packed; that makes a new incumbent or proves the set useless.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.attackers.by_size.packing import Packer
from ratt_opt.attackers.weakest_set.branch_and_bound import WeakestSetSearch
from ratt_opt.attackers.weakest_set.exchanges import weak_sets_of_size
from ratt_opt.graph.outcomes import realise
from ratt_opt.graph.survivor_sizes import non_dominated_sizes
from ratt_opt.problem import Attack
from ratt_opt.stopping import Stop

if TYPE_CHECKING:
    from ratt_opt.attackers.task import AttackTask
    from ratt_opt.attackers.weakest_set.planar_team import PlanarTeam

__all__ = ["SizeVectorSearch"]


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
