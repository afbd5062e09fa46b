"""The smaller groups of an outcome: disjoint sets of given sizes, all below a threshold."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.attackers.weakest_set.enumeration import Enumeration

if TYPE_CHECKING:
    from ratt_opt.attackers.weakest_set.planar_team import PlanarTeam

__all__ = ["Packer", "Packing"]

LONGEST_PACKING = 500_000
"""Compiled nodes one packing question may take before it is left open."""


@dataclass(frozen=True, slots=True)
class Packing:
    """``groups`` below the threshold, or ``None``; ``decided`` says whether ``None`` is proved."""

    groups: tuple[frozenset[int], ...] | None
    decided: bool = True


@dataclass(slots=True)
class Packer:
    """Packs groups for one plan; ``must`` are robots that every outcome contains (they cannot be blinded)."""

    team: PlanarTeam
    must: frozenset[int]

    def pack(self, available: frozenset[int], sizes: tuple[int, ...], threshold: float) -> Packing:
        """Find disjoint groups of these sizes among ``available``, each worth less than ``threshold``.

        Weakest robots first; exact unless the search grows beyond ``LONGEST_PACKING`` nodes.
        """
        weak = frozenset(i for i in available if self.team.value([i]) < threshold)
        missing = self.must & available
        # No group below the threshold holds a robot that alone reaches it.
        if not missing <= weak or not len(missing) <= sum(sizes) <= len(weak):
            return Packing(None)
        quick = self._weakest(weak, sizes, threshold)
        # Robots on their own are all weak enough here, so only larger groups are searched for.
        if quick is not None or not sizes or sizes[0] == 1:
            return Packing(quick)
        return self._search(weak, sizes, threshold)

    def _weakest(
        self, available: frozenset[int], sizes: tuple[int, ...], threshold: float
    ) -> tuple[frozenset[int], ...] | None:
        """The weakest robots in order, the largest group first."""
        order = sorted(available, key=lambda i: (i not in self.must, self.team.single[i], i))[: sum(sizes)]
        order.sort(key=lambda i: (self.team.single[i], i))
        groups = []
        for size in sizes:
            group, order = frozenset(order[:size]), order[size:]
            if self.team.value(group) >= threshold:
                return None
            groups.append(group)
        return tuple(groups)

    def _search(self, available: frozenset[int], sizes: tuple[int, ...], threshold: float) -> Packing:
        robots = np.array(sorted(available, key=lambda i: (-self.team.single[i], i)), dtype=np.int64)
        sets = Enumeration(self.team, robots, frozenset(), sizes[0])
        decided = True
        while True:
            found = sets.next_below(threshold, LONGEST_PACKING)
            if found is None:
                return Packing(None, decided and sets.finished)
            if len(sizes) == 1:
                if self.must & available <= found:
                    return Packing((found,))
                continue
            rest = self.pack(available - found, sizes[1:], threshold)
            if rest.groups is not None:
                return Packing((found, *rest.groups))
            decided = decided and rest.decided
