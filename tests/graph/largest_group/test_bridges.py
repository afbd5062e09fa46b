"""Cuts of bridges and of few links beside them, against every cut."""

from __future__ import annotations

from itertools import combinations

import networkx as nx
import numpy as np
import pytest

from ratt_opt import smallest_largest_group
from ratt_opt.budget import Budget
from ratt_opt.graph.communication import CommunicationGraph
from ratt_opt.graph.largest_group.bridges import by_bridges, is_nearly_a_tree
from ratt_opt.graph.threat import Threat


def sparse_graph(rng: np.random.Generator) -> nx.Graph:
    """A tree or a forest of up to eleven robots, with up to four links more."""
    n = int(rng.integers(1, 12))
    tree = nx.random_labeled_tree(n, seed=int(rng.integers(2**31)))
    graph = nx.Graph()
    graph.add_nodes_from(range(n))
    graph.add_edges_from(edge for edge in tree.edges if rng.random() < 0.95)
    for i, j in rng.integers(0, n, (int(rng.integers(0, 5)), 2)).tolist():
        if i != j:
            graph.add_edge(i, j)
    return graph


def smallest_by_every_cut(graph: nx.Graph, alpha_c: int, protected: set[tuple[int, int]]) -> int:
    links = [link for link in graph.edges if tuple(sorted(link)) not in protected]
    sizes = []
    for cut in combinations(links, min(alpha_c, len(links))):
        left = graph.copy()
        left.remove_edges_from(cut)
        sizes.append(max(map(len, nx.connected_components(left))))
    return min(sizes)


@pytest.mark.parametrize("first", range(0, 300, 100))
def test_the_smallest_largest_group_is_that_of_every_cut(first: int):
    for seed in range(first, first + 100):
        rng = np.random.default_rng(seed)
        graph = sparse_graph(rng)
        links = sorted(tuple(sorted(link)) for link in graph.edges)
        protected = {link for link in links if rng.random() < 0.2}
        alpha_c = int(rng.integers(0, min(4, len(links)) + 1))
        threat = Threat(
            CommunicationGraph.from_networkx(graph, len(graph)), 0, alpha_c, protected_links=frozenset(protected)
        )
        assert is_nearly_a_tree(threat)
        found = by_bridges(threat, Budget())
        assert found.lower == found.upper == smallest_by_every_cut(graph, alpha_c, protected)
        assert len(found.cut) <= alpha_c
        assert not found.cut & protected


def test_trees_of_hundreds_are_decided_for_any_number_of_cuts():
    rng = np.random.default_rng(0)
    for n in (20, 120, 750):
        tree = nx.random_labeled_tree(n, seed=int(rng.integers(2**31)))
        sizes = [smallest_largest_group(tree, k) for k in (0, 1, 2, 5, 15, n - 1)]
        assert all(size.is_exact for size in sizes)
        assert [size.upper for size in sizes] == sorted((size.upper for size in sizes), reverse=True)
        assert (sizes[0].upper, sizes[-1].upper) == (n, 1)


def test_a_path_falls_into_equal_parts():
    for n in (30, 101):
        for k in (1, 2, 6):
            assert smallest_largest_group(nx.path_graph(n), k).upper == -(-n // (k + 1))


def test_a_budget_of_nodes_leaves_a_true_bracket():
    ring = nx.cycle_graph(40)
    ring.add_edges_from([(0, 20), (10, 30)])
    whole = smallest_largest_group(ring, 4)
    assert whole.is_exact
    for nodes in (1, 10, 100):
        part = smallest_largest_group(ring, 4, max_nodes=nodes)
        assert part.lower <= whole.upper <= part.upper
