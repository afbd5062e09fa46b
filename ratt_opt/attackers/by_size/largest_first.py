"""The families of a complete graph by their largest group: for each of its sizes, smallest first, sets of that size.

A larger group contains smaller ones, so by monotonicity what bounds the smaller size bounds the larger. Whenever a set
below the incumbent is found, the other groups of the outcome are packed; that makes a new incumbent or proves the set
useless.
"""

from __future__ import annotations

from operator import itemgetter
from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.attackers.by_size.packing import Packer
from ratt_opt.attackers.weakest_set.branch_and_bound import WeakestSetSearch
from ratt_opt.budget import Stop

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from ratt_opt.attackers.task import AttackTask
    from ratt_opt.attackers.weakest_set.packed_team import PackedTeam
    from ratt_opt.budget import Budget
    from ratt_opt.graph.survivor_sizes import Sizes

__all__ = ["LargestFirst"]

FIRST_EFFORT, MORE_EFFORT, LAST_EFFORT = 10**5, 10, 10**7
"""Partial sets looked at to pack the other groups around a largest one (a tenth of a second or less), how many times as
many the next time, and the last time where there is no limit of time or nodes."""


class LargestFirst:
    """Closes the bracket of a task, share after share of its budget; ``accept`` offers groups as an attack."""

    def __init__(self, task: AttackTask, team: PackedTeam, accept: Callable[[Sequence[frozenset[int]]], bool]) -> None:
        self.team, self.bracket, self.accept = team, task.bracket, accept
        self._must = task.problem.threat.protected_robots
        self._searches: dict[int, WeakestSetSearch] = {}
        """By the size of the largest group."""
        self._left_open: dict[frozenset[int], float] = {}
        """Values of the sets whose packing question was given up; the proof cannot rise above them."""
        self._weakest = np.inf
        """Least value of any set found below the goal of its time."""

    def run(self, vectors: Sequence[Sizes], budget: Budget) -> Stop:
        """Search the sets of every size of the largest group of some vectors of sizes, from where it ended before."""
        bracket, floor, packer = self.bracket, self.bracket.lower, Packer(self.team, self._must, budget)
        for size in sorted({vector[0] for vector in vectors}):
            search = self._searches.setdefault(size, WeakestSetSearch(self.team, size, bracket.goal, floor))
            search.threshold = bracket.goal
            for found in search.run(budget):
                if found is not None:
                    value = self.team.value(found)
                    self._weakest = min(self._weakest, value)
                    if not self._is_decided(found, value, vectors, packer):
                        self._left_open[found] = value
                    search.threshold = bracket.goal
                bracket.raise_lower(min(search.lower, bracket.goal, self._weakest))
            # Larger groups contain sets of this size, all decided: none is worth less than this.
            floor = min(self._weakest, bracket.goal)
            if floor >= bracket.goal:
                break
        self._raise_lower()
        return self._pack_again(vectors, packer)

    def _raise_lower(self) -> None:
        """Sets of all sizes are decided but those left open."""
        self.bracket.raise_lower(min([self.bracket.goal, *self._left_open.values()]))

    def _pack_again(self, vectors: Sequence[Sizes], packer: Packer) -> Stop:
        """Decide what was given up, the weakest first, with more and more effort; what is not decided stays open."""
        bracket, budget = self.bracket, packer.budget
        effort, has_limit = FIRST_EFFORT, budget.max_nodes is not None or np.isfinite(budget.seconds_left)
        while not bracket.is_closed and self._left_open and (has_limit or effort <= LAST_EFFORT):
            for largest, value in sorted(self._left_open.items(), key=itemgetter(1)):
                if self._is_decided(largest, value, vectors, packer, effort):
                    del self._left_open[largest]
                self._raise_lower()
            effort *= MORE_EFFORT
        return Stop.CLOSED if bracket.is_closed else Stop.HEURISTIC

    def _is_decided(
        self, largest: frozenset[int], value: float, vectors: Sequence[Sizes], packer: Packer, effort: int = 0
    ) -> bool:
        """Make attacks of a largest group; whether it is known then to have none below the goal."""
        others, is_decided = frozenset(range(len(self.team.single))) - largest, True
        for vector in vectors:
            while vector[0] == len(largest) and value < self.bracket.goal:
                packing = packer.pack(others, vector[1:], self.bracket.goal, effort)
                if packing.groups is None:
                    is_decided = is_decided and packing.decided
                    break
                if not self.accept((largest, *packing.groups)):
                    break
        return is_decided
