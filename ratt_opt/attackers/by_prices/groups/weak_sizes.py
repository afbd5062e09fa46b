"""How many robots a set worth less than a threshold has at most: the capacity of the enumeration's knapsack.

Minorants of the weakest set of a size (``weakest_set/minorant.py``) say so for planar targets. Where targets have
another dimension, concavity does: a set's information is the average of the prior's and ``size`` times that of each of
its robots, so it is worth at least the average of the least ``value(size copies of a robot)``. Depth-first search goes
on from there.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.attackers.by_prices.groups.blinding import may_be_weak
from ratt_opt.attackers.by_prices.groups.compiled import value_of
from ratt_opt.attackers.weakest_set.minorant import affine_minorant
from ratt_opt.attackers.weakest_set.weakest_axis import weakest_axis

if TYPE_CHECKING:
    from ratt_opt.attackers.by_prices.team import PricedTeam
    from ratt_opt.attackers.weakest_set.packed_team import PackedTeam
    from ratt_opt.budget import Budget

__all__ = ["WeakSizes"]

SIZE_WORK = 20_000_000
"""Products looked at to prove that no weak set has a certain size, so many for each target's information squared: some
hundredths of a second, 90,000 values of 25 targets in the plane."""

ROUNDING = 1e-12
"""Relative: averages are of some ten values."""


class WeakSizes:
    """Largest sizes of weak sets of one team; ``packed`` : the same, for sharper bounds where targets are planar."""

    def __init__(self, team: PricedTeam, packed: PackedTeam | None) -> None:
        self._team, self._planar = team, packed if packed is not None and packed.is_planar else None
        self._floors: dict[int, float] = {}

    def largest(self, threshold: float, budget: Budget) -> int:
        """A size that no set of robots worth less than the threshold exceeds."""
        n_robots, values = len(self._team.single), SIZE_WORK // (len(self._team.prior) * self._team.prior.shape[1] ** 2)
        everyone = np.ones(n_robots, dtype=np.bool_)
        for size in range(self._by_floors(threshold, budget), 0, -1):
            if may_be_weak(self._team, everyone, n_robots - size, threshold, values, budget.check):
                return size
        return 0

    def _by_floors(self, threshold: float, budget: Budget) -> int:
        """By bisection: every size whose weakest set is worth the threshold proves that larger ones are too."""
        low, high = 0, len(self._team.single)
        while low < high:
            budget.check()
            middle = (low + high + 1) // 2
            if self._floor(middle) >= threshold:
                high = middle - 1
            else:
                low = middle
        return high

    def _floor(self, size: int) -> float:
        """No set of so many robots is worth less."""
        if size not in self._floors:
            planar = self._planar
            self._floors[size] = self._average(size) if planar is None else self._minorant(planar, size)
        return self._floors[size]

    def _minorant(self, planar: PackedTeam, size: int) -> float:
        family = planar.family(np.arange(len(self._team.single)), size)
        return float(
            weakest_axis(family).bound if planar.is_by_axis else affine_minorant(family, 2, -np.inf).bound(size)
        )

    def _average(self, size: int) -> float:
        team = self._team
        copies = np.array([value_of(team, team.prior + size * information) for information in team.information])
        average = float(np.partition(copies, size - 1)[:size].mean())
        return average - ROUNDING * (abs(average) + abs(team.baseline))
