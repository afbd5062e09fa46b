"""Sets of robots of which only so many may see in a group worth less than the threshold.

A group with more robots of such a set has so many blinded at least. First come the strongest robots of the team, any
number of them; a group that needs more than these say gets a set of its own, made as large as it can be.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.attackers.by_prices.groups.blinding import may_be_weak

if TYPE_CHECKING:
    from collections.abc import Callable

    from ratt_opt.attackers.by_prices.team import PricedTeam

__all__ = ["WeakSets"]

VALUES, QUICK = 300_000, 20_000
"""Values looked at to prove that no robots of a set are worth less (up to a second or two), and of a larger set."""


class WeakSets:
    """``robots`` : masks of the sets; ``room`` : robots of each that may see.

    Parameters
    ----------
    largest : a size that no set of robots worth less than the threshold exceeds
    check : raises where the time is up
    """

    def __init__(self, team: PricedTeam, threshold: float, largest: int, check: Callable[[], None]) -> None:
        self._team, self._threshold, self._check = team, threshold, check
        self._strongest = [int(i) for i in np.argsort(-team.single, kind="stable")]
        n_robots = len(self._strongest)
        self.robots, self.room = [(1 << n_robots) - 1], [largest]
        for size in range(n_robots - 1, 0, -1):
            self._check()
            mask, room = sum(1 << i for i in self._strongest[:size]), min(self.room[-1], size)
            while room > 0 and not self._has_weak(mask, room):
                room -= 1
            if room < min(self.room[-1], size):
                self.robots.append(mask)
                self.room.append(room)

    def need(self, group: int) -> int:
        """Blinded robots that a group has at least."""
        pairs = zip(self.robots, self.room, strict=True)
        return max(max((group & robots).bit_count() - room, 0) for robots, room in pairs)

    def fewest(self, n_blinded: int) -> int:
        """Groups that an attack leaves at least."""
        pairs = zip(self.robots, self.room, strict=True)
        return max([1, *(-((n_blinded - robots.bit_count()) // room) for robots, room in pairs if room)])

    def raise_need(self, group: int) -> bool:
        """Add a set that says what a group needs, where those known say less."""
        known, size = self.need(group), group.bit_count()
        room = size - known
        while room > 0 and not self._has_weak(group, room):
            self._check()
            room -= 1
        if room == size - known:
            return False
        for i in self._strongest:
            self._check()
            if not group >> i & 1 and not self._has_weak(group | 1 << i, room + 1, QUICK):
                group |= 1 << i
        self.robots.append(group)
        self.room.append(room)
        return True

    def _has_weak(self, robots: int, size: int, values: int = VALUES) -> bool:
        """Whether so many of the robots may be worth less; true also where that is not decided."""
        inside = np.array([robots >> i & 1 for i in range(len(self._strongest))], dtype=np.bool_)
        return may_be_weak(self._team, inside, robots.bit_count() - size, self._threshold, values, self._check)
