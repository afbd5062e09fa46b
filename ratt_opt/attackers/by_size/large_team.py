"""The exact attacker of large teams on a complete graph, two-dimensional targets.

Outcomes are told apart by their group sizes (``graph/survivor_sizes.py``). For each size of the
largest group, smallest first, the sets of that size are searched; a larger group contains
smaller ones, so by monotonicity what bounds the smaller size bounds the larger.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.attackers.by_size.packing import Packer
from ratt_opt.attackers.weakest_set.size_search import SizeSearch
from ratt_opt.attackers.weakest_set.weak_sets import weak_sets
from ratt_opt.graph.outcomes import realise
from ratt_opt.graph.survivor_sizes import non_dominated_sizes
from ratt_opt.problem import Attack
from ratt_opt.stopping import Stop

if TYPE_CHECKING:
    from ratt_opt.attackers.bracket import Bracket, Budget
    from ratt_opt.attackers.plan_values import PlanValues
    from ratt_opt.attackers.weakest_set.compact import CompactTeam
    from ratt_opt.problem import Problem

__all__ = ["TOLERANCE", "LargeTeamSearch"]

TOLERANCE = 1e-10
"""Relative width that counts as closed: sets that improve the attack by less are not looked for."""


class LargeTeamSearch:
    """Closes ``bracket`` for one plan; relies on a non-decreasing objective."""

    def __init__(
        self, problem: Problem, team: CompactTeam, values: PlanValues, bracket: Bracket, budget: Budget
    ) -> None:
        self.problem, self.team, self.values = problem, team, values
        self.bracket, self.budget = bracket, budget
        threat = problem.threat
        self.vectors = non_dominated_sizes(problem.n_robots, threat.n_blinded, threat.alpha_c)
        self.packer = Packer(team, problem.protected_robots)
        self.left_open = np.inf
        """Least value of a set whose packing question was given up; the proof cannot rise above it."""
        self.weakest = np.inf
        """Least value of any set found below the threshold of its time."""

    def run(self) -> Stop:
        """Search every size of the largest group; the bracket is valid whenever this stops."""
        if self.vectors == [()]:
            self._accept((frozenset(),))
            self.bracket.lower = self.bracket.upper
            return Stop.CLOSED
        sizes = sorted({vector[0] for vector in self.vectors})
        self._start(sizes)
        floor = self.bracket.lower
        for size in sizes:
            search = SizeSearch(self.team, size, self._offer, floor)
            search.run(self._threshold, self.budget, self._raise_lower)
            # Larger groups contain sets of this size, all decided: none is worth less than this.
            floor = min(self.weakest, self._threshold)
            if floor >= self._threshold:
                break
        self.bracket.raise_lower(min(self._threshold, self.left_open))
        return Stop.CLOSED if self.left_open >= self._threshold else Stop.NODES

    @property
    def _threshold(self) -> float:
        return self.bracket.upper - TOLERANCE * abs(self.bracket.upper)

    def _raise_lower(self, undecided: float) -> None:
        self.bracket.raise_lower(min(undecided, self._threshold, self.left_open, self.weakest))

    def _start(self, sizes: list[int]) -> None:
        """Incumbents before the search: sets that no exchange makes weaker."""
        for size in sizes:
            for robots in weak_sets(self.team, size):
                if self._offer(robots) <= self.team.value(robots):
                    break

    def _offer(self, largest: frozenset[int]) -> float:
        """Make attacks of a largest group, or learn that it has none below the threshold."""
        value = self.team.value(largest)
        self.weakest = min(self.weakest, value)
        others = frozenset(range(self.problem.n_robots)) - largest
        for vector in self.vectors:
            while vector[0] == len(largest) and value < self._threshold:
                packing = self.packer.pack(others, vector[1:], self._threshold)
                if packing.groups is None:
                    if not packing.decided:
                        self.left_open = min(self.left_open, value)
                    break
                if not self._accept((largest, *packing.groups)):
                    break
        return self._threshold

    def _accept(self, groups: tuple[frozenset[int], ...]) -> bool:
        outcome = tuple(sorted(groups, key=lambda group: min(group, default=0)))
        attack = Attack(*realise(self.problem.threat, outcome))
        before = self.bracket.upper
        self.bracket.offer(attack, self.problem.team_value(self.values.plan, attack))
        return self.bracket.upper < before
