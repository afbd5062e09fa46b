"""Which robots of one group can an attacker leave seeing below a threshold?"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.attackers.weakest_set.low_sets import AffineBound, LowSets
from ratt_opt.attackers.weakest_set.size_search import SizeSearch
from ratt_opt.attackers.weakest_set.swap_search import swap_search

if TYPE_CHECKING:
    from ratt_opt.attackers.bracket import Budget
    from ratt_opt.attackers.weakest_set.compact import CompactTeam
    from ratt_opt.attackers.weakest_set.minorant import Minorant

__all__ = ["WeakSubsets"]

PLAIN_NODES = 30_000
"""Compiled nodes before a question is handed to the branch and bound, which bounds it afresh."""


@dataclass(slots=True)
class WeakSubsets:
    """Decides, for groups of one team, whether some subset of a given size is worth less than a threshold.

    ``must`` : robots that cannot be blinded; ``minorants`` : by size, over all robots
    """

    team: CompactTeam
    must: frozenset[int]
    minorants: dict[int, Minorant] = field(default_factory=dict)

    def weak(self, group: frozenset[int], size: int) -> frozenset[int] | None:
        """A weak subset by local search: no claim; ``None`` where the size leaves no room for protected robots."""
        fixed = self.must & group
        if not len(fixed) <= size <= len(group):
            return None
        order = sorted(group - fixed, key=lambda i: (self.team.single[i], i))
        start = fixed | frozenset(order[: size - len(fixed)])
        return swap_search(self.team, start, among=group, fixed=fixed)

    def below(self, group: frozenset[int], size: int, threshold: float, budget: Budget) -> frozenset[int] | None:
        """A subset of ``size`` robots of ``group`` worth less than ``threshold``; ``None`` proves there is none.

        Spends nodes of ``budget``.
        """
        budget.spend()
        quick = self.weak(group, size)
        if quick is None or self.team.value(quick) < threshold:
            return quick
        fixed = self.must & group
        free = np.array(sorted(group - fixed, key=lambda i: (-self.team.single[i], i)), dtype=np.int64)
        if size in {len(fixed), len(group)}:
            return None  # only one subset, looked at already
        return self._search(fixed, free, size, threshold, budget)

    def _search(
        self, fixed: frozenset[int], free: np.ndarray, size: int, threshold: float, budget: Budget
    ) -> frozenset[int] | None:
        low = self._enumeration(fixed, free, size)
        while not low.finished and low.nodes < PLAIN_NODES:
            found = low.next_within(threshold, PLAIN_NODES - low.nodes, budget)
            if found is not None:
                return found
        return None if low.finished else self._branch(fixed, free, size, threshold, budget)

    def _enumeration(self, fixed: frozenset[int], free: np.ndarray, size: int) -> LowSets:
        """The team's minorant of this size holds for the subsets of every group; surest robots first."""
        left = size - len(fixed)
        minorant = self.minorants.get(size)
        if minorant is None:
            return LowSets(self.team, free, fixed, left)
        constant = minorant.constant + float(minorant.scores[sorted(fixed)].sum())
        return LowSets.surest_first(self.team, free, fixed, left, AffineBound(constant, minorant.scores[free]))

    def _branch(
        self, fixed: frozenset[int], free: np.ndarray, size: int, threshold: float, budget: Budget
    ) -> frozenset[int] | None:
        found: list[frozenset[int]] = []

        def first(subset: frozenset[int]) -> float:
            found.append(subset)
            return -np.inf

        outside = frozenset(range(len(self.team.single))) - fixed - frozenset(free.tolist())
        search = SizeSearch(self.team, size, first, -np.inf, inside=fixed, outside=outside)
        search.run(threshold, budget, lambda _: None)
        return found[0] if found else None
