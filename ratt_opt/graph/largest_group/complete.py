"""The smallest possible largest group of complete graphs, by their group sizes alone: two ways."""

from __future__ import annotations

from itertools import accumulate, pairwise
from math import comb
from typing import TYPE_CHECKING

from ratt_opt.graph.caa import caa
from ratt_opt.graph.largest_group.result import LargestGroup, split_result

if TYPE_CHECKING:
    from collections.abc import Sequence

    from ratt_opt.graph.communication import Link
    from ratt_opt.graph.threat import Threat

__all__ = ["by_caa", "by_integer_partitions"]


def by_caa(threat: Threat) -> LargestGroup:
    """Algorithm 2: groups of ``n_max`` robots, as many as fit, and one of the rest."""
    n_robots = threat.graph.n_robots
    size = caa(n_robots, threat.alpha_c).n_max
    sizes = [min(size, n_robots - first) for first in range(0, n_robots, size)]
    reason = f"groups of at most {size - 1} robots keep too many links cut: links kept are convex in the group sizes"
    return split_result(threat, _cut_into(threat, sizes), size, "caa", reason)


def by_integer_partitions(threat: Threat) -> LargestGroup:
    """Most links kept by any integer partition with parts up to p, by dynamic programming over all of them."""
    n_robots = threat.graph.n_robots
    to_keep = len(threat.graph.links) - threat.alpha_c
    for largest in range(1, n_robots + 1):
        kept, part = [0] * (n_robots + 1), [0] * (n_robots + 1)
        for robots in range(1, n_robots + 1):
            options = ((comb(p, 2) + kept[robots - p], p) for p in range(1, min(largest, robots) + 1))
            kept[robots], part[robots] = max(options)
        if kept[n_robots] >= to_keep:
            break
    sizes, left = [], n_robots
    while left:
        sizes.append(part[left])
        left -= part[left]
    reason = f"no integer partition of {n_robots} with parts up to {largest - 1} keeps {to_keep} links"
    return split_result(threat, _cut_into(threat, sizes), largest, "partitions", reason)


def _cut_into(threat: Threat, sizes: Sequence[int]) -> frozenset[Link]:
    """The links between groups of these sizes, lowest robots first."""
    return threat.graph.links_between(range(*ends) for ends in pairwise(accumulate(sizes, initial=0)))
