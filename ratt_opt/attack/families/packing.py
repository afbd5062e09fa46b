"""The smaller groups of an outcome: disjoint sets of given sizes, all below a threshold."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from ratt_opt.attack.least_sets.search import LeastSetSearch

if TYPE_CHECKING:
    from ratt_opt.attack.least_sets.packed_team import PackedTeam
    from ratt_opt.budget import Budget
    from ratt_opt.graph.survivor_sizes import Sizes

__all__ = ["Packer", "Packing"]


@dataclass(frozen=True, slots=True)
class Packing:
    """``groups`` below the threshold, or ``None``; ``decided`` says whether ``None`` is proved."""

    groups: tuple[frozenset[int], ...] | None
    decided: bool = True


@dataclass(slots=True)
class Packer:
    """Packs groups for one plan; ``must`` are robots that every outcome contains (they cannot be blinded)."""

    team: PackedTeam
    must: frozenset[int]
    budget: Budget

    def pack(self, available: frozenset[int], sizes: Sizes, threshold: float, effort: int = 0) -> Packing:
        """Find disjoint groups of these sizes among ``available``, each worth less than ``threshold``.

        Weakest robots first; exact where the sets of the largest size are listed, or ``effort`` nodes suffice.
        """
        weak = frozenset(i for i in available if self.team.single[i] < threshold)
        missing = self.must & available
        # No group below the threshold holds a robot that alone reaches it.
        if not missing <= weak or not len(missing) <= sum(sizes) <= len(weak):
            return Packing(None)
        quick = self._weakest(weak, sizes, threshold)
        # Robots on their own are all weak enough here, so only larger groups are searched for.
        if quick is not None or not sizes or sizes[0] == 1:
            return Packing(quick)
        return self._search(weak, sizes, threshold, effort)

    def _weakest(self, available: frozenset[int], sizes: Sizes, threshold: float) -> tuple[frozenset[int], ...] | None:
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

    def _search(self, available: frozenset[int], sizes: Sizes, threshold: float, effort: int) -> Packing:
        """Each set of the largest size, and the other groups from what it leaves."""
        outside, decided = frozenset(range(len(self.team.single))) - available, True
        with self.budget.stage(max_nodes=effort) as part:
            others = replace(self, budget=part)
            for found in LeastSetSearch(self.team, sizes[0], threshold, outside=outside).run(part):
                if found is None:
                    continue
                packing = others.pack(available - found, sizes[1:], threshold, effort)
                if packing.groups is not None:
                    return Packing((found, *packing.groups))
                decided = decided and packing.decided
            return Packing(None, decided)
        return Packing(None, decided=False)
