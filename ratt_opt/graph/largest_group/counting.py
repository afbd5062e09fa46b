"""A bracket on the smallest possible largest group of any graph: links counted, and a heuristic cut."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ratt_opt.graph.caa import links_within
from ratt_opt.graph.communication import CommunicationGraph
from ratt_opt.graph.largest_group.result import LargestGroup, split_result

if TYPE_CHECKING:
    import networkx as nx

    from ratt_opt.graph.communication import Link
    from ratt_opt.graph.threat import Threat

__all__ = ["COUNTED", "by_counting", "counting_bound", "heuristic_cut"]

COUNTED = "the links left, and the protected ones, do not fit into smaller groups"
"""The reason for :func:`counting_bound`."""


def by_counting(threat: Threat) -> LargestGroup:
    """The bracket between :func:`counting_bound` and what :func:`heuristic_cut` leaves."""
    return split_result(threat, heuristic_cut(threat), counting_bound(threat), "counting", COUNTED)


def counting_bound(threat: Threat) -> int:
    """Lower bound on ``n_max``: groups of at most p robots have at most ``links_within(N, p)`` links.

    Robots joined by protected links stay together, which gives another.
    """
    n_robots, rest = threat.graph.n_robots, len(threat.graph.links) - threat.alpha_c
    counted = next(p for p in range(1, n_robots + 1) if rest <= links_within(n_robots, p))
    held = CommunicationGraph(n_robots, threat.protected_links)
    return max(counted, *(len(group) for group in held.groups()))


def heuristic_cut(threat: Threat) -> frozenset[Link]:
    """Split the largest group by its cheapest cut, or cut its cheapest robot off, while the budget lasts."""
    import networkx as nx

    locked = len(threat.graph.links) + 1
    rest: nx.Graph = nx.Graph()
    rest.add_nodes_from(range(threat.graph.n_robots))
    for i, j in sorted(threat.graph.links):
        rest.add_edge(i, j, weight=locked if (i, j) in threat.protected_links else 1)
    cut: set[Link] = set()
    while True:
        largest = min(nx.connected_components(rest), key=lambda group: (-len(group), min(group)))
        part = rest.subgraph(sorted(largest))
        if len(largest) == 1:
            return frozenset(cut)
        cost, (side, _) = nx.stoer_wagner(part)
        if len(cut) + cost > threat.alpha_c:
            return frozenset(cut)
        inside = set(side)
        lost = [(min(i, j), max(i, j)) for i, j in part.edges if (i in inside) != (j in inside)]
        cut.update(lost)
        rest.remove_edges_from(lost)
