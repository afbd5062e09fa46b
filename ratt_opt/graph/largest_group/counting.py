"""The smallest possible largest group by counting links: of complete graphs, and a bracket for any graph."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import accumulate, pairwise
from math import comb
from typing import TYPE_CHECKING

from ratt_opt._values import counted
from ratt_opt.budget import Stop
from ratt_opt.graph.communication import CommunicationGraph
from ratt_opt.graph.largest_group.heuristic_cut import heuristic_cut
from ratt_opt.graph.survivor_sizes import caa, links_within

if TYPE_CHECKING:
    from collections.abc import Collection, Iterable, Sequence

    from ratt_opt.budget import Budget
    from ratt_opt.graph.communication import Link
    from ratt_opt.graph.threat import Threat

__all__ = [
    "COUNTED",
    "LargestGroup",
    "by_caa",
    "by_counting",
    "by_integer_partitions",
    "counting_bound",
    "largest_left",
    "split_result",
]


@dataclass(frozen=True, slots=True, kw_only=True)
class LargestGroup:
    """Claim: ``lower <= n_max``, and ``cut`` leaves a largest group of ``upper`` robots, so ``n_max <= upper``.

    ``alpha_c`` : most links that may be cut

    ``upper`` is recomputed on the graph. ``reason`` says why ``lower`` holds, and which limit was met, ``stop`` why the
    search ended. ``claimed_lower`` is what the integer program of ``method="milp"`` claims beyond ``lower``; nothing
    has checked it, and nothing else follows from it (equal to ``lower`` for all other methods).
    """

    lower: int
    upper: int
    alpha_c: int
    cut: frozenset[Link]
    method: str
    reason: str
    claimed_lower: int
    stop: Stop

    def __repr__(self) -> str:
        cut = f"{counted(len(self.cut), 'link')} cut"
        claim = f", {self.claimed_lower} claimed" if self.claimed_lower > self.lower else ""
        return f"LargestGroup([{self.lower}, {self.upper}]{claim}, {cut}, {self.method!r}: {self.reason})"

    @property
    def n_max(self) -> int | None:
        """The smallest possible size, if it is proved; ``None`` if only ``lower`` and ``upper`` are known."""
        return self.upper if self.is_exact else None

    @property
    def is_exact(self) -> bool:
        """Tell whether ``lower`` (checked) meets ``upper``."""
        return self.lower == self.upper


def largest_left(graph: CommunicationGraph, cut: Iterable[Link], ignoring: Collection[int] = ()) -> int:
    """Robots of the largest connected component once ``cut`` is gone, not counting those to ignore."""
    return max(len(group.difference(ignoring)) for group in graph.groups(cut))


def split_result(
    threat: Threat,
    cut: frozenset[Link],
    lower: int,
    method: str,
    reason: str,
    *,
    claimed_lower: int | None = None,
    stop: Stop | None = None,
) -> LargestGroup:
    """The result of a cut and a lower bound, after checking that the cut is allowed.

    ``stop`` : why the search ended while the ends were apart; by default a heuristic did
    """
    assert len(cut) <= threat.alpha_c, "a cut is within its budget"
    assert not cut & threat.protected_links, "a cut spares protected links"
    upper = largest_left(threat.graph, cut)
    claimed = lower if claimed_lower is None else max(lower, min(claimed_lower, upper))
    return LargestGroup(
        lower=lower,
        upper=upper,
        alpha_c=threat.alpha_c,
        cut=cut,
        method=method,
        reason=reason,
        claimed_lower=claimed,
        stop=Stop.CLOSED if lower == upper else stop or Stop.HEURISTIC,
    )


COUNTED = "the links left, the protected ones, or the robots in that many groups, do not fit into smaller groups"
"""The reason for :func:`counting_bound`."""


def by_counting(threat: Threat, budget: Budget) -> LargestGroup:
    """The bracket between :func:`counting_bound` and what :func:`heuristic_cut` leaves."""
    return split_result(threat, heuristic_cut(threat, budget), counting_bound(threat), "counting", COUNTED)


def counting_bound(threat: Threat) -> int:
    """Lower bound on ``n_max``: groups of at most p robots have at most ``links_within(N, p)`` links.

    Robots joined by protected links stay together, and a cut link makes at most one group more: these give others.
    """
    n_robots, rest = threat.graph.n_robots, len(threat.graph.links) - threat.alpha_c
    counted = next(p for p in range(1, n_robots + 1) if rest <= links_within(n_robots, p))
    held = CommunicationGraph(n_robots, threat.protected_links)
    most_groups = len(threat.graph.groups()) + threat.alpha_c
    return max(counted, -(-n_robots // most_groups), *(len(group) for group in held.groups()))


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
