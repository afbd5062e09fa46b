"""The least weight of links to cut, against all partitions of small networks, and what the search is made of."""

import json
from fractions import Fraction
from functools import cache, partial
from pathlib import Path

import networkx as nx
import numpy as np
import pytest

import ratt_opt as ro
from ratt_opt.attack.edge_cuts.elimination import EliminationParams
from ratt_opt.attack.edge_cuts.kept_links import groups_above, some_groups_above
from ratt_opt.attack.edge_cuts.listed import TripleParams, partition_that_keeps
from ratt_opt.attack.edge_cuts.network import CutNetwork, exact_integers
from ratt_opt.budget import Budget
from ratt_opt.graph.communication import CommunicationGraph
from tests.strategies import random_graph


def by_all_partitions(graph, weights, sizes, size, protected=()):
    """The least weight cut by any partition into groups within the size that keeps protected links."""
    n = graph.number_of_nodes()
    links = [tuple(sorted(link)) for link in graph.edges]
    heavy = [sum(sizes[i] for i in range(n) if s >> i & 1) > size for s in range(1 << n)]
    spoilt = [any((s >> i & 1) != (s >> j & 1) for i, j in protected) for s in range(1 << n)]
    inside = [sum(weights[i, j] for i, j in links if s >> i & 1 and s >> j & 1) for s in range(1 << n)]

    @cache
    def most_kept(left):
        if not left:
            return 0
        low = left & -left
        rest, best = left ^ low, None
        others = rest
        while True:
            group = others | low
            if not heavy[group] and not spoilt[group]:
                more = most_kept(left ^ group)
                if more is not None and (best is None or inside[group] + more > best):
                    best = inside[group] + more
            if not others:
                return best
            others = (others - 1) & rest

    kept = most_kept((1 << n) - 1)
    return None if kept is None else inside[-1] - kept


def random_case(seed, *, largest=8):
    """A network with weights, sizes and protected links, some of them plain."""
    rng = np.random.default_rng(seed)
    n = int(rng.integers(1, largest + 1))
    graph = random_graph(rng, n)
    links = sorted(tuple(sorted(link)) for link in graph.edges)
    weights = {link: int(rng.integers(0, 9)) if seed % 2 else 1 for link in links}
    sizes = [int(rng.integers(1, 6)) if seed % 3 == 0 else 1 for _ in range(n)]
    protected = [link for link in links if rng.random() < 0.12] if seed % 4 == 0 else []
    return graph, weights, sizes, protected, int(rng.integers(max(sizes), sum(sizes) + 1))


def check(found, case):
    """What is claimed from above is so; prices pay for every connected group that fits."""
    graph, weights, sizes, protected, size = case
    n = graph.number_of_nodes()
    assert not found.cut & set(protected)
    rest = graph.copy()
    rest.remove_edges_from(found.cut)
    assert {frozenset(group) for group in nx.connected_components(rest)} == set(found.groups)
    assert all(sum(sizes[i] for i in group) <= size for group in found.groups)
    assert sum(weights[link] for link in found.cut) == found.upper
    if found.prices is not None and not protected:
        for mask in range(1, 1 << n):
            group = [i for i in range(n) if mask >> i & 1]
            if sum(sizes[i] for i in group) <= size:
                kept = sum(weights[tuple(sorted(link))] for link in graph.subgraph(group).edges)
                assert kept <= sum(found.prices[i] for i in group)
        assert found.by_prices <= sum(weights.values()) - sum(found.prices) + 1


def compare(seed, largest):
    compare_case(random_case(seed, largest=largest))


def compare_every_budget(seed, largest):
    """Every size; and every number of links where each counts once."""
    graph, weights, sizes, protected, _ = random_case(seed, largest=largest)
    every = range(max(sizes), sum(sizes) + 1)
    truth = {size: compare_case((graph, weights, sizes, protected, size)) for size in every}
    if set(weights.values()) <= {1} and set(sizes) == {1}:
        for k in range(graph.number_of_edges() + 1):
            found = ro.smallest_largest_group(graph, k, protected_links=protected)
            fits = [size for size in every if truth[size] is not None and truth[size] <= k]
            assert found.lower == found.upper == min(fits), (seed, k)


def compare_case(case):
    graph, weights, sizes, protected, size = case
    truth = by_all_partitions(graph, weights, sizes, size, protected)
    given = {"weights": weights, "sizes": sizes, "protected_links": protected}
    if truth is None:
        with pytest.raises(ro.InputError, match="size must be at least"):
            ro.fewest_cuts(graph, size, **given)
        return None
    found = ro.fewest_cuts(graph, size, **given)
    assert (found.lower, found.upper, found.stop) == (truth, truth, ro.Stop.CLOSED)
    check(found, case)
    return truth


@pytest.mark.parametrize("first", range(0, 100, 25))
def test_all_partitions(first):
    for seed in range(first, first + 25):
        compare(seed, 8)


@pytest.mark.slow
@pytest.mark.parametrize("first", range(1000, 2000, 100))
def test_all_partitions_of_a_thousand_networks_for_every_budget(first):
    for seed in range(first, first + 100):
        compare_every_budget(seed, 10)


@pytest.mark.parametrize("seed", range(12))
def test_both_directions_for_every_budget(seed):
    """``n_max(k) <= r`` exactly if at most k links need to be cut for groups of r."""
    graph = random_graph(np.random.default_rng(seed), 7)
    fewest = [ro.fewest_cuts(graph, size) for size in range(1, 8)]
    assert all(one.is_exact for one in fewest)
    assert [one.upper for one in fewest] == sorted((one.upper for one in fewest), reverse=True)
    for k in range(graph.number_of_edges() + 1):
        size = ro.smallest_largest_group(graph, k)
        assert size.is_exact
        assert size.upper == next(r for r in range(1, 8) if fewest[r - 1].upper <= k)


@pytest.mark.parametrize("seed", range(15))
def test_pricing_finds_and_lists_the_groups_of_the_definition(seed):
    rng = np.random.default_rng(seed)
    graph, weights, sizes, _, size = random_case(seed)
    n = graph.number_of_nodes()
    network = CutNetwork.of(CommunicationGraph.from_networkx(graph, n), weights, sizes)
    prices = rng.integers(0, 3 * network.unit, n)
    threshold = -int(rng.integers(0, 4 * network.unit))
    truth = set()
    solid = nx.Graph(network.ends.tolist())
    solid.add_nodes_from(range(n))
    for mask in range(1, 1 << n):
        group = np.array([bool(mask >> i & 1) for i in range(n)])
        if group @ network.size > size or not nx.is_connected(solid.subgraph(np.flatnonzero(group))):
            continue
        if int(network.kept(group[None])[0]) * network.unit - int(group @ prices) > threshold:
            truth.add(group.tobytes())
    found = groups_above(network, prices, size, threshold, 10**4, Budget())
    assert found.is_complete
    assert sorted(group.tobytes() for group in found.groups) == sorted(truth)
    above = groups_above(network, prices, size, 0, 10**4, Budget()).groups
    some = some_groups_above(network, prices, size, Budget(), 10**6)
    assert bool(len(some.groups)) == bool(len(above))
    assert all((network.kept(some.groups) * network.unit - some.groups @ prices) > 0)
    assert not groups_above(network, prices, size, threshold, 1, Budget()).is_complete or len(truth) <= 1


@pytest.mark.parametrize("few", [0, 300])
@pytest.mark.parametrize("seed", range(15))
def test_listed_groups_with_triples_decide_what_is_kept(seed, few, monkeypatch):
    monkeypatch.setattr("ratt_opt.attack.edge_cuts.listed.PARAMS", TripleParams(few=few))
    graph, weights, sizes, _, size = random_case(seed)
    truth = by_all_partitions(graph, weights, sizes, size)
    network = CutNetwork.of(CommunicationGraph.from_networkx(graph, graph.number_of_nodes()), weights, sizes)
    degree = [sum(weights[tuple(sorted(link))] for link in graph.edges(i)) for i in graph]
    prices = np.array(degree, dtype=np.int64) * network.unit  # every group keeps at most half of it
    everything = groups_above(network, prices, size, -int(prices.sum()) - 1, 10**4, Budget()).groups
    kept = network.total - truth
    label = partition_that_keeps(network, everything, prices, kept, Budget()).label
    assert label is not None
    assert network.cut_of(label) == truth
    assert partition_that_keeps(network, everything, prices, kept + 1, Budget()).label is None


def test_a_gap_of_prices_is_closed_by_triples_and_covers(monkeypatch):
    """Three robots in a ring, groups of two: prices say that one and a half links are kept; one is."""
    never = partial(EliminationParams, width=0)
    monkeypatch.setattr("ratt_opt.attack.edge_cuts.elimination.EliminationParams", never)
    found = ro.fewest_cuts(nx.disjoint_union_all([nx.cycle_graph(3)] * 3), 2)
    assert (found.by_prices, found.lower, found.upper) == (5, 6, 6)
    assert "listed" in found.reason or "groups that prices leave" in found.reason


def test_numbers_are_as_they_are_written():
    assert exact_integers("weights", [0.1, 2, np.float64(0.25)]) == ([2, 40, 5], 20)
    path = nx.path_graph(3)
    found = ro.fewest_cuts(path, 2, weights={(0, 1): 0.1, (1, 2): 0.3})
    assert (found.lower, found.upper, found.cut) == (0.1, 0.1, {(0, 1)})
    assert isinstance(found.prices[0], Fraction)
    nx.set_edge_attributes(path, {(0, 1): 5, (1, 2): 2}, "capacity")
    nx.set_node_attributes(path, {0: 1.5, 1: 0.5, 2: 1.0}, "load")
    assert ro.fewest_cuts(path, 2, weights="capacity", sizes="load").cut == {(1, 2)}


def test_bad_input_is_named():
    path = nx.path_graph(3)
    ask = ro.fewest_cuts
    for bad, argument in (
        (lambda: ask(path, 1, weights={(0, 1): -1, (1, 2): 1}), "weights"),
        (lambda: ask(path, 1, weights={(0, 1): float("nan"), (1, 2): 1}), "weights"),
        (lambda: ask(path, 1, weights={(0, 1): 1}), "weights"),
        (lambda: ask(path, 1, weights={(0, 1): 1, (1, 2): 1, (0, 2): 1}), "weights"),
        (lambda: ask(path, 1, weights="capacity"), "weights"),
        (lambda: ask(path, 1, weights={(0, 1): "many", (1, 2): 1}), "weights"),
        (lambda: ask(path, 1, weights={(0, 1): 1e-30, (1, 2): 1}), "weights"),
        (lambda: ask(path, 2, sizes=[1, 2, 3]), "size must be at least 3"),
        (lambda: ask(path, 2, sizes=[1, 2]), "sizes"),
        (lambda: ask(path, 2, sizes={0: 1, 1: 1, 7: 1}), "sizes"),
        (lambda: ask(path, 2, sizes=[1, 0, 1]), "sizes"),
        (lambda: ask(path, 0), "size must be at least 1"),
        (lambda: ask(path, float("nan")), "size"),
        (lambda: ask(path, 1, protected_links=[(0, 1)]), "protected links"),
        (lambda: ask(path, 1, protected_links=[(0, 2)]), "protected link"),
        (lambda: ask(nx.Graph(), 1), "graph"),
        (lambda: ask(nx.MultiGraph([(0, 1), (0, 1)]), 1), "graph"),
        (lambda: ask(nx.DiGraph([(0, 1)]), 1), "graph"),
        (lambda: ask(path, 1, time_limit=-1), "time_limit"),
    ):
        with pytest.raises(ro.InputError, match=argument):
            bad()


def test_a_network_in_pieces_is_said_to_be():
    found = ro.fewest_cuts(nx.disjoint_union(nx.path_graph(3), nx.path_graph(2)), 2)
    assert (found.lower, found.upper) == (1, 1)
    assert found.notes == ("the network falls into 2 groups before any cut",)
    assert not ro.fewest_cuts(nx.path_graph(3), 3).notes


@pytest.mark.parametrize("limit", [{"max_nodes": 0}, {"max_nodes": 40}, {"time_limit": 0}])
def test_a_limit_leaves_a_bracket_and_says_so(limit):
    graph = nx.convert_node_labels_to_integers(nx.les_miserables_graph())
    found = ro.fewest_cuts(graph, 8, **limit)
    assert found.lower <= 110 <= found.upper
    assert found.stop in {ro.Stop.NODES, ro.Stop.TIME}


def test_an_interrupt_leaves_a_bracket():
    outer = Budget()
    outer.interrupt()
    found = ro.fewest_cuts(nx.cycle_graph(20), 5, budget=outer)
    assert found.lower <= 4 <= found.upper
    assert found.stop is ro.Stop.INTERRUPTED


DATA = Path(__file__).parents[3].parent / "shared" / "data" / "graph_partition" / "instances.jsonl"


@pytest.mark.skipif(not DATA.exists(), reason="published instances are not beside the repository")
def test_published_optima():
    """Some rows of each table; series-parallel graph 0, for which two optima are printed, is 15."""
    rows = [json.loads(line) for line in DATA.read_text(encoding="utf-8").splitlines()]
    contradictory = [row for row in rows if len(row["published"]) > 1]
    for row in [*rows[:60:6], *rows[90::5], *contradictory]:
        graph = nx.empty_graph(row["n"])
        graph.add_edges_from(row["links"])
        links = map(tuple, row["links"])
        weights = dict(zip(links, row["weights"], strict=True)) if "weights" in row else None
        found = ro.fewest_cuts(graph, row["size"], weights=weights, sizes=row.get("sizes"))
        assert found.is_exact
        assert found.upper in row["published"]
    assert [found.upper, found.by_prices] == [15, 15]
