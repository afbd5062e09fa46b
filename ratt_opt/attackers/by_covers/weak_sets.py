"""Sets of robots of which only so many may see in a group worth less than the threshold.

A group with more robots of such a set has so many blinded at least. First come the strongest robots of the team, any
number of them; a group that needs more than these say gets a set of its own, made as large as it can be.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Callable

    from ratt_opt.attack.pricing import Plan

__all__ = ["WeakSets"]


class WeakSets:
    """``robots`` : masks of the sets; ``room`` : robots of each that may see.

    Parameters
    ----------
    check : raises where the time is up
    """

    def __init__(self, plan: Plan, threshold: float, check: Callable[[], None]) -> None:
        self._plan, self._threshold, self._check = plan, threshold, check
        self._strongest = [int(i) for i in np.argsort(-plan.single, kind="stable")]
        n_robots = len(self._strongest)
        self.robots, self.room = [(1 << n_robots) - 1], [plan.most_below(threshold)]
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
            if not group >> i & 1 and not self._has_weak(group | 1 << i, room + 1):
                group |= 1 << i
        self.robots.append(group)
        self.room.append(room)
        return True

    def _has_weak(self, robots: int, size: int) -> bool:
        """Whether so many of the robots may be worth less; true also where that is not decided."""
        inside = np.array([robots >> i & 1 for i in range(len(self._strongest))], dtype=np.bool_)
        return self._plan.some_may_be_below(inside, size, self._threshold)
