"""How many robots a set worth less than a threshold has at most: the capacity of the enumeration's knapsack.

Minorants of the weakest set of a size (``weakest_set/minorant.py``) say so for planar targets and teams of any size;
depth-first search goes on from there, and alone where targets have another dimension.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.attackers.by_prices.groups.blinding import ABSENT, weak_subset
from ratt_opt.attackers.weakest_set.minorant import affine_minorant
from ratt_opt.attackers.weakest_set.weakest_axis import weakest_axis

if TYPE_CHECKING:
    from ratt_opt.attackers.by_prices.team import PricedTeam
    from ratt_opt.attackers.weakest_set.planar_team import PlanarTeam
    from ratt_opt.budget import Budget

__all__ = ["WeakSizes"]

SIZE_VALUES = 100_000
"""Values looked at to prove that no weak set has a certain size: some hundredths of a second."""


class WeakSizes:
    """Largest sizes of weak sets of one team; ``planar`` : the same team for targets in the plane, if they are."""

    def __init__(self, team: PricedTeam, planar: PlanarTeam | None) -> None:
        self._team, self._planar = team, planar
        self._floors: dict[int, float] = {}

    def largest(self, threshold: float, budget: Budget) -> int:
        """A size that no set of robots worth less than the threshold exceeds."""
        n_robots = len(self._team.single)
        everyone, nobody = np.ones(n_robots, dtype=np.bool_), np.zeros(n_robots, dtype=np.bool_)
        for size in range(self._by_minorants(threshold, budget), 0, -1):
            budget.check()
            spared, found = n_robots - size, nobody.copy()
            if weak_subset(self._team, nobody, everyone, spared, threshold, SIZE_VALUES, found) != ABSENT:
                return size
        return 0

    def _by_minorants(self, threshold: float, budget: Budget) -> int:
        """By bisection: every size whose weakest set is worth the threshold proves that larger ones are too."""
        low, high = 0, len(self._team.single)
        while self._planar is not None and low < high:
            budget.check()
            middle = (low + high + 1) // 2
            if self._floor(self._planar, middle) >= threshold:
                high = middle - 1
            else:
                low = middle
        return high

    def _floor(self, planar: PlanarTeam, size: int) -> float:
        """No set of so many robots is worth less."""
        if size not in self._floors:
            family = planar.family(np.arange(len(self._team.single)), size)
            by_axis = planar.objective.states("planar_levels")
            bound = weakest_axis(family).bound if by_axis else affine_minorant(family, 2, -np.inf).bound(size)
            self._floors[size] = float(bound)
        return self._floors[size]
