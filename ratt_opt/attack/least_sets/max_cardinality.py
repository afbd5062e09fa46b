"""Largest number of sensing robots of a group below a threshold; answers are kept for later questions."""

from __future__ import annotations

from math import inf
from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.attack.least_sets.least_set_search import LeastSetSearch
from ratt_opt.graph.communication import mask_of, robots_of

if TYPE_CHECKING:
    from ratt_opt.attack.team import Team
    from ratt_opt.budget import Budget

__all__ = ["MaxCardinalityBelow"]

NONE = -64
"""Number for a group whose protected robots alone reach the threshold: more must be blinded than there are."""


class MaxCardinalityBelow:
    """Answers for one threshold; groups, and sets of robots, are bit masks. Protected robots of a group always sense.

    ``limits`` : sets, and the most of their robots that sense below the threshold in a group that contains all
    protected robots of the set
    """

    def __init__(self, team: Team, threshold: float, protected: int) -> None:
        self._team, self._threshold, self._protected = team, threshold, protected
        self._robots = team.robots
        self._strongest = [int(i) for i in np.argsort(-team.single, kind="stable") if not protected >> int(i) & 1]
        self.limits: list[tuple[int, int]] = []
        self._below: list[int] = []
        """Sets that are worth less than the threshold."""
        self._refuted: dict[int, int] = {}
        """Groups, and a number of their robots that more than it are not below."""
        self._asked: tuple[int, int, LeastSetSearch] | None = None
        """The question in hand: a group, a number of its robots, and the search for these."""

    def known(self, group: int) -> int:
        """The most robots of a group, as far as the limits say."""
        most = group.bit_count()
        for limited, size in self.limits:
            if not limited & self._protected & ~group:
                most = min(most, NONE if size == NONE else size + (group & ~limited).bit_count())
        return most

    def of(self, group: int, budget: Budget) -> int:
        """The most robots of a group; raises ``OutOfBudget``."""
        seeing = (group & self._protected).bit_count()
        most = min(self.known(group), self._refuted.get(group, self._robots))
        while most >= max(seeing, 1) and not self._is_below(group, most, budget):
            most -= 1
            self._refuted[group] = most
        return most if most >= seeing else NONE

    def limit(self, group: int, most: int, budget: Budget) -> None:
        """Add a limit for a group of which ``most`` is the most, with all robots that can be added at no more."""
        if most == NONE:
            self.limits.append((group & self._protected, most))
            return
        self.limits.append((group, most))
        for i in self._strongest:
            if not group >> i & 1 and not self._is_below(
                group | 1 << i, most + 1, budget, self._team.params.limits.enlarging
            ):
                group |= 1 << i
                self.limits[-1] = group, most

    def limit_strongest(self, budget: Budget) -> None:
        """Add limits for the strongest robots, any number of them, as far as they say more than those before."""
        for size in range(len(self._strongest), 0, -1):
            group = mask_of(self._strongest[:size])
            known, most = self.known(group), self.of(group, budget)
            if most < known:
                self.limits.append((group, most))

    def set_below(self, group: int, size: int) -> frozenset[int]:
        """``size`` robots of a group, its protected ones included, that were found to be below the threshold."""
        found = next(below & group for below in self._below if self._shows(below, group, size)) if size else 0
        return frozenset(robots_of(found))

    def _shows(self, below: int, group: int, size: int) -> bool:
        return (group & below).bit_count() >= size and not group & self._protected & ~below

    def _is_below(self, group: int, size: int, budget: Budget, nodes: float = inf) -> bool:
        """Test whether ``size`` robots of a group, its protected ones included, are below the threshold.

        After that many ``nodes`` they count as below.
        """
        if any(self._shows(below, group, size) for below in self._below):
            return True
        if self.known(group) < size:
            return False
        if self._asked is None or self._asked[:2] != (group, size):
            inside, outside = (
                frozenset(robots_of(one)) for one in (group & self._protected, ~group & ((1 << self._robots) - 1))
            )
            search = LeastSetSearch(
                self._team,
                size,
                self._threshold,
                inside=inside,
                outside=outside,
                in_depth=self._team.params.limits.in_depth,
            )
            self._asked = group, size, search
        began = budget.nodes
        for found in self._asked[2].run(budget):
            if found is not None:
                self._below.append(mask_of(found))
            if found is not None or budget.nodes - began > nodes:
                self._asked = None
                return True
        self._asked = None
        return False
