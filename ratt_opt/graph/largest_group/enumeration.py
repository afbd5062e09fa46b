"""The smallest possible largest group by enumerating partitions into connected groups: no solver's claim.

Small teams are decided over all their subsets. Larger ones are partitioned into separable groups
(``separable_groups.py``) of at most p robots, for p = 1, 2, ... in turn, until that is possible within the link budget.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.graph.largest_group.counting import COUNTED, counting_bound, heuristic_cut
from ratt_opt.graph.largest_group.result import LargestGroup, largest_left, split_result
from ratt_opt.graph.threshold import ThresholdTest

if TYPE_CHECKING:
    from ratt_opt.budget import Budget
    from ratt_opt.graph.separable_groups import PartitionSearch
    from ratt_opt.graph.threat import Threat

__all__ = ["by_separable_groups", "by_subsets"]

MOST_GROUPS = 300_000
"""Groups listed before this way is given up: their masks take a second to list and a few megabytes."""

NODES_AT_ONCE = 1_000_000
"""Nodes between two looks at the clock (about a second)."""


def by_subsets(threat: Threat) -> LargestGroup:
    """Fewest links that split the graph into connected groups of at most p robots, over all set partitions."""
    n_robots = threat.graph.n_robots
    test = ThresholdTest(threat, np.bitwise_count(np.arange(2**n_robots)).astype(np.float64))
    largest, split = next((p, s) for p in range(1, n_robots + 1) if (s := test.split(float(p))) is not None)
    return split_result(
        threat, threat.graph.links_between(split.members()), largest, "enumeration", _none_smaller(largest)
    )


def by_separable_groups(threat: Threat, budget: Budget) -> LargestGroup | None:
    """Smallest largest group, or the bracket that the budget allows; ``None`` where the groups are too many to list."""
    from ratt_opt.graph.separable_groups import IMPOSSIBLE, PartitionSearch, separable_groups  # compiles

    groups = separable_groups(threat, MOST_GROUPS)
    if groups is None:
        return None
    sizes = np.bitwise_count(groups.masks)
    lower, reason, cut = counting_bound(threat), COUNTED, heuristic_cut(threat)
    while lower < largest_left(threat.graph, cut):
        search = PartitionSearch(groups, np.where(sizes <= lower, 0, IMPOSSIBLE))
        chosen = _first_partition(search, budget)
        if chosen is not None:
            cut = threat.graph.links_between(groups.members(group).tolist() for group in chosen)
        if chosen is not None or not search.finished:
            break
        lower += 1
        reason = _none_smaller(lower)
    return split_result(threat, cut, lower, "enumeration", reason)


def _first_partition(search: PartitionSearch, budget: Budget) -> list[int] | None:
    """The first partition, or ``None`` when the search is finished or the budget spent."""
    chosen = None
    while chosen is None and not search.finished and budget.stop() is None:
        before = search.nodes
        chosen = search.next(before + budget.nodes_left(NODES_AT_ONCE))
        budget.nodes += search.nodes - before
    return chosen


def _none_smaller(size: int) -> str:
    return f"no partition into connected groups of at most {size - 1} robots is within the link budget"
