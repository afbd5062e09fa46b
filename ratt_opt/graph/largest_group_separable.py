"""The smallest possible largest group of sparse graphs with more robots than all subsets can be tabulated for.

The team is partitioned into separable groups (``separable_groups.py``) of at most p robots, for p = 1, 2, ... in
turn, until that is possible within the link budget. Whatever is answered was enumerated here: no solver's claim.
"""

from __future__ import annotations

from time import monotonic
from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.graph.largest_group import LargestGroup, counting_bound, heuristic_cut, largest_left
from ratt_opt.graph.separable_groups import IMPOSSIBLE, PartitionSearch, separable_groups

if TYPE_CHECKING:
    from ratt_opt.graph.communication import Link
    from ratt_opt.graph.separable_groups import SeparableGroups
    from ratt_opt.graph.threat import Threat

__all__ = ["by_separable_groups"]

MOST_GROUPS = 300_000

UNINTERRUPTED = 1_000_000
"""Nodes between two looks at the clock (about a second)."""


def by_separable_groups(threat: Threat, time_limit: float | None, max_nodes: int | None) -> LargestGroup | None:
    """Smallest largest group, or the bracket that the budgets allow; ``None`` where the groups are too many to list."""
    groups = separable_groups(threat, MOST_GROUPS)
    if groups is None:
        return None
    deadline = np.inf if time_limit is None else monotonic() + time_limit
    left = np.inf if max_nodes is None else max_nodes
    sizes = np.bitwise_count(groups.masks)
    lower, reason = counting_bound(threat), "the links left, and the protected ones, do not fit into smaller groups"
    cut = heuristic_cut(threat)
    while lower < largest_left(threat.graph, cut):
        search = PartitionSearch(groups, np.where(sizes <= lower, 0, IMPOSSIBLE))
        chosen = None
        while chosen is None and not search.finished and search.nodes < left and monotonic() < deadline:
            chosen = search.next(int(min(search.nodes + UNINTERRUPTED, left)))
        left -= search.nodes
        if chosen is not None:
            cut = _between(threat, groups, chosen)
            break
        if not search.finished:
            break
        reason = f"no partition into connected groups of at most {lower} robots is within the link budget"
        lower += 1
    assert len(cut) <= threat.alpha_c, "a cut is within its budget"
    assert not cut & threat.protected_links, "a cut spares protected links"
    upper = largest_left(threat.graph, cut)
    return LargestGroup(lower=lower, upper=upper, cut=cut, method="enumeration", reason=reason, claimed_lower=lower)


def _between(threat: Threat, groups: SeparableGroups, chosen: list[int]) -> frozenset[Link]:
    home = {int(i): k for k, group in enumerate(chosen) for i in groups.members(group)}
    return frozenset((i, j) for i, j in threat.graph.links if home[i] != home[j])
