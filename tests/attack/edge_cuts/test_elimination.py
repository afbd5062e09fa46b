"""Elimination of one robot after the other, against every cut and against all partitions."""

from functools import cache

import networkx as nx
import numpy as np
import pytest

import ratt_opt as ro
from ratt_opt import smallest_largest_group
from ratt_opt.attack.edge_cuts.elimination import Elimination, EliminationParams, TooManyStates
from ratt_opt.attack.edge_cuts.network import CutNetwork
from ratt_opt.budget import Budget, OutOfBudget
from ratt_opt.graph.communication import CommunicationGraph
from tests.attack.edge_cuts.test_fewest import by_all_partitions, random_case


def eliminated(seed: int, largest: int) -> None:
    """The least weight of any network, or that it is more than allowed."""
    graph, weights, sizes, protected, size = random_case(seed, largest=largest)
    truth = by_all_partitions(graph, weights, sizes, size, protected)
    if truth is None:
        return
    whole = CommunicationGraph.from_networkx(graph, len(graph))
    network = CutNetwork.of(whole, weights, sizes, [tuple(sorted(link)) for link in protected])
    elimination = Elimination(network, EliminationParams(nodes=10**6))
    label = elimination.least_cut(size, truth, Budget())
    assert label is not None
    assert network.cut_of(label) == truth
    assert np.bincount(label, network.size).max() <= size
    assert elimination.least_cut(size, truth - 1, Budget()) is None
    assert network.cut_of(elimination.least_cut(size, network.total, Budget())) == truth


@pytest.mark.parametrize("first", range(0, 60, 20))
def test_the_least_weight_is_that_of_all_partitions(first: int):
    for seed in range(first, first + 20):
        eliminated(seed, 8)


@pytest.mark.slow
@pytest.mark.parametrize("first", range(5000, 6000, 100))
def test_the_least_weight_is_that_of_all_partitions_of_a_thousand_networks(first: int):
    for seed in range(first, first + 100):
        eliminated(seed, 9)


@pytest.mark.parametrize("n", [100, pytest.param(1000, marks=pytest.mark.slow)])
def test_few_cuts_of_large_sparse_networks_are_exact(n: int):
    """Clusters along a tree; networks of that kind were left open by a factor of two and more."""
    rng = np.random.default_rng(n)
    graph = nx.random_labeled_tree(n, seed=n)
    for i in range(0, n - 5, 5):
        graph.add_edge(*rng.choice(np.arange(i, i + 5), 2, replace=False).tolist())
    graph.remove_edges_from(list(nx.selfloop_edges(graph)))
    sizes = [smallest_largest_group(graph, k) for k in (1, 3, 5)]
    assert all(size.is_exact for size in sizes)
    assert sizes[0].upper > sizes[1].upper > sizes[2].upper
    one_by_one = nx.bridges(graph)
    halves = []
    for bridge in one_by_one:
        left = graph.copy()
        left.remove_edge(*bridge)
        halves.append(max(map(len, nx.connected_components(left))))
    assert sizes[0].upper == min(halves)


def test_limits_of_elimination_are_named_and_leave_the_rest_to_prices():
    graph = nx.grid_2d_graph(5, 5)
    graph = nx.convert_node_labels_to_integers(graph)
    network = CutNetwork.of(CommunicationGraph.from_networkx(graph, 25))
    for params, text in (
        (EliminationParams(width=2), "tree width"),
        (EliminationParams(states=20), "partial cuts"),
        (EliminationParams(nodes=1), "steps"),
    ):
        with pytest.raises(TooManyStates, match=text):
            Elimination(network, params).least_cut(5, 20, Budget())
    with pytest.raises(OutOfBudget):
        Elimination(network).least_cut(5, 20, Budget(max_nodes=30))


def test_trees_of_hundreds_are_decided_for_any_number_of_cuts():
    rng = np.random.default_rng(0)
    for n in (20, 120):
        tree = nx.random_labeled_tree(n, seed=int(rng.integers(2**31)))
        sizes = [smallest_largest_group(tree, k) for k in (0, 1, 2, 5, 15, n - 1)]
        assert all(size.is_exact for size in sizes)
        assert [size.upper for size in sizes] == sorted((size.upper for size in sizes), reverse=True)
        assert (sizes[0].upper, sizes[-1].upper) == (n, 1)


def test_a_budget_of_nodes_leaves_a_true_bracket():
    ring = nx.cycle_graph(40)
    ring.add_edges_from([(0, 20), (10, 30)])
    whole = smallest_largest_group(ring, 4)
    assert whole.is_exact
    for nodes in (1, 10, 100):
        part = smallest_largest_group(ring, 4, max_nodes=nodes)
        assert part.lower <= whole.upper <= part.upper


def least_by_first_groups(graph: nx.Graph, most: int) -> int:
    """Fewest links for groups of at most ``most``: each connected group of the first robot left, then the others."""
    order = list(nx.bfs_tree(graph, min(graph, key=graph.degree)))
    place = {robot: k for k, robot in enumerate(order)}
    near = [sum(1 << place[j] for j in graph[i]) for i in order]

    def groups(group: int, border: int, left: int):
        yield group
        while border and group.bit_count() < most:
            bit = border & -border
            border ^= bit
            left ^= bit
            yield from groups(group | bit, (border | near[bit.bit_length() - 1]) & left & ~group, left)

    @cache
    def least(left: int) -> int:
        if not left:
            return 0
        first = left & -left
        best = graph.number_of_edges()
        for group in groups(first, near[first.bit_length() - 1] & left, left ^ first):
            rest = left & ~group
            cut = sum((near[k] & rest).bit_count() for k in range(len(order)) if group >> k & 1)
            if cut < best:
                best = min(best, cut + least(rest))
        return best

    return least((1 << len(order)) - 1)


@pytest.mark.parametrize("seed", range(6))
def test_sparse_networks_agree_with_a_program_over_what_is_left(seed: int):
    rng = np.random.default_rng(seed)
    graph = nx.random_labeled_tree(18, seed=seed)
    graph.add_edges_from((i, j) for i, j in rng.integers(0, 18, (5, 2)).tolist() if i != j)
    for most in (3, 5):
        truth = least_by_first_groups(graph, most)
        found = ro.fewest_cuts(graph, most)
        assert found.lower == found.upper == truth
        network = CutNetwork.of(CommunicationGraph.from_networkx(graph, 18))
        label = Elimination(network, EliminationParams(nodes=10**6)).least_cut(most, truth, Budget())
        assert network.cut_of(label) == truth
