"""Prices that claim more links than they must, lowered where a group pays them.

A proof takes one search, yet every search finds a few groups that annealing missed. Prices with a reserve are lowered
for such a group while the search goes on: no group's reduced cost falls, so what is closed stays closed.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from ratt_opt.attackers.by_prices.prices import GroupPrices, KnownGroup, PriceVector
    from ratt_opt.budget import Budget

__all__ = ["FallingPrices"]


@dataclass(slots=True, kw_only=True)
class FallingPrices:
    """``prices`` of the groups in ``program`` that claim at least ``links``; ``learned`` : groups that were new."""

    program: GroupPrices
    threshold: float
    prices: PriceVector
    links: float
    learned: int = 0

    def fall(self, group: KnownGroup, budget: Budget) -> bool:
        """Learn a group that pays, and lower the prices so that it does not; false where too few links are left."""
        fresh = self.program.add([group])
        self.learned += fresh
        lower = self.program.lowered(self.threshold, self.prices, budget.seconds_left) if fresh else None
        if lower is None or lower.links < self.links:
            return False
        self.prices = lower
        return True
