"""Which robots can still pool measurements after an attack: non-dominated outcomes.

An outcome is the family of groups of non-blinded robots that an attack leaves. One
outcome dominates another when it refines it (every group of the first lies in a group
of the second): a non-decreasing objective is then no larger on the first.
"""

from __future__ import annotations

from itertools import combinations
from typing import TYPE_CHECKING

import networkx as nx

if TYPE_CHECKING:
    from collections.abc import Iterator

    from ratt_opt.graph.communication import Link
    from ratt_opt.graph.threat import Threat

__all__ = ["Outcome", "non_dominated_outcomes", "realise"]

Outcome = tuple[frozenset[int], ...]
"""Disjoint, non-empty groups by lowest robot; ``(frozenset(),)`` when every robot is blinded."""


def non_dominated_outcomes(threat: Threat) -> Iterator[Outcome]:
    """Yield every outcome within the budgets that no other one refines.

    Source: enumeration of set partitions into connected groups.
    """
    found = {
        _outcome(partition, frozenset(blinded))
        for partition in _connected_partitions(threat)
        for blinded in combinations(
            sorted(set(range(threat.graph.n_robots)) - threat.protected_robots), threat.n_blinded
        )
    }
    for outcome in sorted(found, key=lambda o: [sorted(g) for g in o]):
        if not any(other != outcome and _refines(other, outcome) for other in found):
            yield outcome


def realise(threat: Threat, outcome: Outcome) -> tuple[frozenset[int], frozenset[Link]]:
    """Return blinded robots and cut links, within the budgets, that leave exactly ``outcome``."""
    survivors = frozenset().union(*outcome)
    blinded = frozenset(range(threat.graph.n_robots)) - survivors
    for partition in _connected_partitions(threat):
        if _outcome(partition, blinded) == outcome:
            home = {i: k for k, group in enumerate(partition) for i in group}
            return blinded, frozenset((i, j) for i, j in threat.graph.links if home[i] != home[j])
    raise AssertionError("an outcome of this threat has an attack")


def _outcome(partition: list[frozenset[int]], blinded: frozenset[int]) -> Outcome:
    groups = sorted((rest for group in partition if (rest := group - blinded)), key=min)
    return tuple(groups) or (frozenset(),)


def _refines(fine: Outcome, coarse: Outcome) -> bool:
    return all(any(group <= other for other in coarse) for group in fine)


def _connected_partitions(threat: Threat) -> Iterator[list[frozenset[int]]]:
    graph: nx.Graph = nx.Graph(sorted(threat.graph.links))
    graph.add_nodes_from(range(threat.graph.n_robots))
    for partition in _partitions(list(range(threat.graph.n_robots))):
        home = {i: k for k, group in enumerate(partition) for i in group}
        cut = {(i, j) for i, j in threat.graph.links if home[i] != home[j]}
        if len(cut) > threat.alpha_c or cut & threat.protected_links:
            continue
        if all(nx.is_connected(graph.subgraph(group)) for group in partition):
            yield partition


def _partitions(robots: list[int]) -> Iterator[list[frozenset[int]]]:
    if not robots:
        yield []
        return
    first, rest = robots[0], robots[1:]
    for partition in _partitions(rest):
        yield [frozenset([first]), *partition]
        for k, group in enumerate(partition):
            yield [*partition[:k], group | {first}, *partition[k + 1 :]]
