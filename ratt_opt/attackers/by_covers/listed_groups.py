"""All groups that an attack may leave, with what they need blinded as far as it is known, and what they cost at prices.

What a group needs is proved only for groups in the program's solutions: each gets a weak set of its own, as large as it
can be, which says as much of the groups around it. At exact needs the program hardly leaves a part of a link.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.attackers.by_covers.cover_prices import HALF_LINK, CoverPrices, CoverProgram

if TYPE_CHECKING:
    from collections.abc import Callable

    from ratt_opt._validation import IntArray
    from ratt_opt.attackers.by_covers.weak_sets import WeakSets
    from ratt_opt.graph.separable_groups import SeparableGroups

__all__ = ["ListedGroups"]

PAYING = 200
"""Groups added to the program at a time."""


class ListedGroups:
    """Of G groups that may be left: ``masks``, ``links`` lost and ``need``, blinded robots at least, (G,).

    ``rows`` : (G,) where they are in the list
    """

    def __init__(self, listed: SeparableGroups, weak: WeakSets, program: CoverProgram) -> None:
        self._threat, self._weak, self._program, self._asked = listed.threat, weak, program, 0
        self._seeing = sum(1 << i for i in self._threat.protected_robots)
        self.masks, self.links = listed.by_robots(), listed.links
        self.rows, self.need = np.arange(len(self.masks)), np.zeros(len(self.masks), dtype=np.int64)

    def _raise_needs(self) -> None:
        """By the sets that are new, here and in the program; groups that no attack leaves are dropped."""
        weak, most = self._weak, self._threat.n_blinded
        for robots, room in zip(weak.robots[self._asked :], weak.room[self._asked :], strict=True):
            self.need = np.maximum(self.need, np.bitwise_count(self.masks & robots).astype(np.int64) - room)
            kept = (self.need <= most) & (np.bitwise_count(self.masks & (robots & self._seeing)) <= room)
            self.masks, self.links, self.rows, self.need = (
                one[kept] for one in (self.masks, self.links, self.rows, self.need)
            )
        self._asked = len(weak.robots)
        self._program.renew()

    def priced(self, seconds_left: Callable[[], float], check: Callable[[], None]) -> CoverPrices:
        """Prices that no group pays, but for the program's tolerance."""
        if self._asked < len(self._weak.robots):
            self._raise_needs()
        while True:
            check()
            prices = self._program.solve(seconds_left())
            costs = self.costs(prices)
            paying = np.argsort(costs, kind="stable")[:PAYING]
            if not self._program.add(self.masks[paying[costs[paying] < 0]].tolist()):
                return prices

    def costs(self, prices: CoverPrices) -> IntArray:
        """(G,) what groups cost more than they pay."""
        costs = HALF_LINK * self.links + prices.blinded * self.need - prices.group
        for i, price in enumerate(prices.robot.tolist()):
            costs -= price * (self.masks >> i & 1)
        for triple, penalty in zip(prices.triple, prices.penalty, strict=True):
            costs += penalty * (np.bitwise_count(self.masks & triple) >= 2)
        return costs

    def raised(self) -> bool:
        """Whether groups of the program's solution need more than was known."""
        return sum(self._weak.raise_need(group) for group in self._program.support()) > 0
