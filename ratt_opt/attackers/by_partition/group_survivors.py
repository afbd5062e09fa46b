"""Which robots of one group can an attacker leave seeing below a threshold?"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.attackers.weakest_set.branch_and_bound import WeakestSetSearch
from ratt_opt.attackers.weakest_set.enumeration import AffineBound, Enumeration
from ratt_opt.attackers.weakest_set.exchanges import exchanged

if TYPE_CHECKING:
    from ratt_opt._validation import IntArray
    from ratt_opt.attackers.weakest_set.minorant import Minorant
    from ratt_opt.attackers.weakest_set.planar_team import PlanarTeam
    from ratt_opt.budget import Budget

__all__ = ["GroupSurvivors"]

PLAIN_NODES = 30_000
"""Compiled nodes before a question is handed to the branch and bound, which bounds it afresh."""


@dataclass(slots=True)
class GroupSurvivors:
    """Decides, for groups of one team, whether some subset of a given size is worth less than a threshold.

    ``must`` : robots that cannot be blinded; ``minorants`` : by size, over all robots
    """

    team: PlanarTeam
    must: frozenset[int]
    minorants: dict[int, Minorant] = field(default_factory=dict)

    def by_exchanges(self, group: frozenset[int], size: int) -> frozenset[int] | None:
        """A weak subset: no claim; ``None`` where the size leaves no room for protected robots."""
        fixed = self.must & group
        if not len(fixed) <= size <= len(group):
            return None
        order = sorted(group - fixed, key=lambda i: (self.team.single[i], i))
        return exchanged(self.team, fixed.union(order[: size - len(fixed)]), among=group, fixed=fixed)

    def below(self, group: frozenset[int], size: int, threshold: float, budget: Budget) -> frozenset[int] | None:
        """A subset of ``size`` robots of ``group`` worth less than ``threshold``; ``None`` proves there is none.

        Spends nodes of ``budget``.
        """
        budget.spend()
        quick = self.by_exchanges(group, size)
        if quick is None or self.team.value(quick) < threshold:
            return quick
        fixed = self.must & group
        if size in {len(fixed), len(group)}:
            return None  # only one subset, looked at already
        free = np.array(sorted(group - fixed, key=lambda i: (-self.team.single[i], i)), dtype=np.int64)
        sets = self._enumeration(fixed, free, size)
        while not sets.finished and sets.nodes < PLAIN_NODES:
            found = sets.next_within(threshold, PLAIN_NODES - sets.nodes, budget)
            if found is not None:
                return found
        if sets.finished:
            return None
        outside = frozenset(range(len(self.team.single))) - group
        search = WeakestSetSearch(self.team, size, threshold, inside=fixed, outside=outside)
        return next((found for found in search.run(budget) if found is not None), None)

    def _enumeration(self, fixed: frozenset[int], free: IntArray, size: int) -> Enumeration:
        """The team's minorant of this size holds for the subsets of every group; surest robots first."""
        left = size - len(fixed)
        minorant = self.minorants.get(size)
        if minorant is None:
            return Enumeration(self.team, free, fixed, left)
        constant = minorant.constant + float(minorant.scores[sorted(fixed)].sum())
        return Enumeration.surest_first(self.team, free, fixed, left, AffineBound(constant, minorant.scores[free]))
