from functools import partial
from itertools import combinations

import networkx as nx
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import ratt_opt as ro
from ratt_opt.attack.edge_cuts import cut_search
from ratt_opt.attack.edge_cuts.smallest import bound_soon
from ratt_opt.budget import Budget
from ratt_opt.graph.communication import CommunicationGraph
from ratt_opt.graph.threat import Threat
from tests.attack.stages.test_few_attacks import sparse_network
from tests.extremes import at_extremes, places, undocumented
from tests.strategies import SEEDED, random_graph, random_problem


def by_definition(graph, alpha_c, protected=()):
    """Every set of at most alpha_c links."""
    links = [e for e in graph.edges if tuple(sorted(e)) not in set(protected)]
    best = graph.number_of_nodes()
    for count in range(alpha_c + 1):
        for cut in combinations(links, count):
            rest = graph.copy()
            rest.remove_edges_from(cut)
            best = min(best, max(map(len, nx.connected_components(rest))))
    return best


def check(found, graph, alpha_c, protected=()):
    assert len(found.cut) <= alpha_c
    assert not found.cut & set(protected)
    rest = graph.copy()
    rest.remove_edges_from(found.cut)
    assert rest.number_of_edges() == graph.number_of_edges() - len(found.cut)
    assert max(map(len, nx.connected_components(rest))) == found.upper
    assert found.n_max == (found.upper if found.lower == found.upper else None)
    assert (found.stop is ro.Stop.CLOSED) == found.is_exact
    assert found.lower <= found.claimed_lower <= found.upper
    assert found.reason


@pytest.mark.parametrize("seed", range(60))
def test_any_graph_against_all_edge_subsets(seed):
    rng = np.random.default_rng(seed)
    graph = random_graph(rng, int(rng.integers(1, 7)))
    if graph.number_of_edges() > 11:
        graph.remove_edges_from(sorted(graph.edges)[11:])
    links = [tuple(sorted(e)) for e in graph.edges]
    protected = [link for link in links if rng.random() < 0.15]
    alpha_c = int(rng.integers(0, len(links) + 1))
    expected = by_definition(graph, alpha_c, protected)
    for method in ("auto", "enumeration", "milp"):
        found = ro.smallest_largest_group(graph, alpha_c, method=method, protected_links=protected)
        check(found, graph, alpha_c, protected)
        assert found.upper == expected
        assert found.claimed_lower == expected
    found = ro.smallest_largest_group(graph, alpha_c, method="counting", protected_links=protected)
    check(found, graph, alpha_c, protected)
    assert found.lower <= expected <= found.upper


@pytest.mark.parametrize("n_robots", range(1, 9))
def test_all_ways_agree_on_complete_graphs(n_robots):
    graph = nx.complete_graph(n_robots)
    for alpha_c in range(0, graph.number_of_edges() + 1, 1 if n_robots < 7 else 4):
        methods = ["caa", "partitions", "enumeration", "milp"] if n_robots < 7 else ["caa", "partitions", "enumeration"]
        sizes = set()
        for method in methods:
            found = ro.smallest_largest_group(graph, alpha_c, method=method)
            check(found, graph, alpha_c)
            sizes.add(found.upper)
            assert method == "milp" or found.is_exact
        assert sizes == {ro.caa(n_robots, alpha_c).n_max}


@pytest.mark.parametrize("seed", range(4))
def test_beyond_all_subsets_the_integer_program_agrees(seed):
    rng = np.random.default_rng(seed)
    graph = nx.gnp_random_graph(18, 0.2, seed=seed)
    alpha_c = int(rng.integers(0, 9))
    found = ro.smallest_largest_group(graph, alpha_c)
    check(found, graph, alpha_c)
    assert found.is_exact
    claimed = ro.smallest_largest_group(graph, alpha_c, method="milp")
    assert found.upper == claimed.upper == claimed.claimed_lower


@pytest.mark.parametrize("max_nodes", [0, 1, 10, 100, 1000])
def test_a_node_budget_returns_a_bracket(max_nodes):
    graph = nx.gnp_random_graph(22, 0.2, seed=3)
    exact = ro.smallest_largest_group(graph, 12).n_max
    found = ro.smallest_largest_group(graph, 12, max_nodes=max_nodes)
    check(found, graph, 12)
    assert found.lower <= exact <= found.upper


def test_what_ends_the_last_search_of_cuts_is_said(monkeypatch):
    """Prices leave more groups than may be listed: no size less is decided, and nothing else was limited."""
    monkeypatch.setattr(cut_search, "SearchParams", partial(cut_search.SearchParams, most_listed=1))
    graph = nx.gnp_random_graph(25, 0.2, seed=0)
    found = ro.smallest_largest_group(graph, 9)
    check(found, graph, 9)
    assert found.stop is ro.Stop.NODES
    assert "more than 1 groups" in found.reason


def test_a_method_that_does_not_apply_names_one_that_would():
    with pytest.raises(ro.InputError, match="milp"):
        ro.smallest_largest_group(nx.path_graph(5), 1, method="caa")
    with pytest.raises(ro.InputError, match="milp"):
        ro.smallest_largest_group(nx.path_graph(5), 1, method="partitions")
    with pytest.raises(ro.InputError, match="milp"):
        ro.smallest_largest_group(nx.complete_graph(24), 150, method="enumeration")
    with pytest.raises(ro.InputError, match="must be one of"):
        ro.smallest_largest_group(nx.path_graph(5), 1, method="magic")
    with pytest.raises(ro.InputError, match="alpha_c"):
        ro.smallest_largest_group(nx.path_graph(5), 5)
    for limits, name in (({"time_limit": float("nan")}, "time_limit"), ({"max_nodes": -1}, "max_nodes")):
        for method in ("auto", "milp", "enumeration"):
            with pytest.raises(ro.InputError, match=name):
                ro.smallest_largest_group(nx.path_graph(20), 1, method=method, **limits)
    loop = nx.path_graph(3)
    loop.add_edge(1, 1)
    for bad in (loop, nx.DiGraph([(0, 1)]), nx.MultiGraph([(0, 1)]), nx.Graph([(1, 2)]), "graph"):
        with pytest.raises(ro.InputError, match="graph"):
            ro.smallest_largest_group(bad, 0)


def test_n_max_is_none_where_nothing_says_what_it_is():
    found = ro.smallest_largest_group(nx.gnp_random_graph(25, 0.3, seed=1), 9, method="counting")
    assert found.lower < found.upper
    assert (found.n_max, found.is_exact) == (None, False)
    exact = ro.smallest_largest_group(nx.path_graph(30), 2)
    assert (exact.n_max, exact.is_exact) == (10, True)
    assert len(repr(ro.smallest_largest_group(nx.complete_graph(30), 200))) < 200


@pytest.mark.parametrize("method", ["auto", "milp"])
def test_an_outer_budget_counts_too(method):
    graph = nx.gnp_random_graph(25, 0.2, seed=3)
    outer = Budget()
    outer.interrupt()
    found = ro.smallest_largest_group(graph, 9, method=method, budget=outer)
    check(found, graph, 9)
    assert not found.is_exact


@pytest.mark.parametrize("seed", range(20))
def test_ratt_uses_the_exact_size_on_any_graph(seed):
    problem = random_problem(np.random.default_rng(seed), 5, kind="trace", complete=False)
    graph = nx.Graph(sorted(problem.communication.links))
    graph.add_nodes_from(range(5))
    expected = 5 - by_definition(graph, problem.alpha_c, problem.protected_links)
    planned = ro.ratt(problem)
    assert planned.alpha_cs == expected
    assert len(planned.bait) == min(5, problem.alpha_s + expected)


@pytest.mark.parametrize("method", ["auto", "milp", "spreading", "counting"])
def test_time_may_end_at_any_look_at_the_clock(method, monkeypatch):
    """Also between the look that lets a search go on and its next one: once that ended in an exception of its own."""
    size, density, alpha_c = (16, 0.25, 8) if method == "milp" else (22, 0.2, 12)
    graph = nx.gnp_random_graph(size, density, seed=3)
    exact = ro.smallest_largest_group(graph, alpha_c).n_max
    for looks in [*range(25), *range(25, 400, 47)]:
        clock = iter(range(10**9))
        monkeypatch.setattr("ratt_opt.budget.monotonic", lambda clock=clock: float(next(clock)))
        found = ro.smallest_largest_group(graph, alpha_c, method=method, time_limit=looks)
        check(found, graph, alpha_c)
        assert found.lower <= exact <= found.upper


@pytest.mark.parametrize("place", places(ro.SizeParams()))
def test_brackets_hold_whatever_one_parameter_is(place):
    assert not undocumented(ro.SizeParams())
    for seed in range(8):
        rng = np.random.default_rng(seed)
        graph = random_graph(rng, int(rng.integers(5, 8)))
        alpha_c = int(rng.integers(0, graph.number_of_edges() + 1))
        exact = ro.smallest_largest_group(graph, alpha_c, method="enumeration").n_max
        threat = Threat(CommunicationGraph.from_networkx(graph, len(graph)), 0, alpha_c)
        for _, params in at_extremes(ro.SizeParams(one_by_one=0, soon_subsets=0), place):
            found = ro.smallest_largest_group(graph, alpha_c, params=params)
            check(found, graph, alpha_c)
            assert found.lower <= exact <= found.upper
            assert bound_soon(threat, Budget(), params).lower <= exact


@SEEDED
@given(st.integers(15, 18), st.integers(0, 10**6), st.sampled_from([0.15, 0.3, 0.6]))
def test_what_ratt_takes_is_a_bound_at_any_moment(n_robots, seed, density):
    rng = np.random.default_rng(seed)
    graph = nx.gnp_random_graph(n_robots, density, seed=seed)
    links = sorted(graph.edges)
    protected = frozenset(link for link in links if rng.random() < 0.1)
    threat = Threat(
        CommunicationGraph.from_networkx(graph, n_robots),
        0,
        int(rng.integers(0, len(links) // 2 + 1)),
        protected_links=protected,
    )
    cut = ro.smallest_largest_group(graph, threat.alpha_c, method="spreading", protected_links=protected)
    for seconds in (0.0, None):
        assert bound_soon(threat, Budget(seconds)).lower <= cut.upper
    exact = ro.smallest_largest_group(graph, threat.alpha_c, protected_links=protected)
    assert exact.is_exact
    assert bound_soon(threat, Budget()).lower <= exact.lower


@pytest.mark.parametrize(("n_robots", "cut"), [(14, 0.3), (36, 0.3), (36, 0.5), (60, 0.15), (100, 0.3)])
def test_ratt_asks_no_integer_program_and_depends_on_nothing_before(n_robots, cut, monkeypatch):
    """On hubs of 36 robots the exact size took minutes; longer searches of the same size before must not matter."""

    def asked(*_):
        raise AssertionError

    monkeypatch.setattr("ratt_opt.attack.edge_cuts.smallest.by_integer_program", asked)
    problem = ro.network_scenario("hubs", n_robots, 3, alpha_s=0.2, alpha_c=cut, seed=1).problem()
    first = ro.ratt(problem)
    found = ro.smallest_largest_group(problem.communication, problem.alpha_c, method="spreading", time_limit=1.0)
    assert ro.ratt(problem).alpha_cs == first.alpha_cs >= n_robots - found.upper


def test_few_cuts_of_large_sparse_networks_are_tried_one_by_one():
    rng = np.random.default_rng(371)
    graph = sparse_network(rng, 60, 3)
    threat = Threat(ro.Problem(ro.Modular(np.ones(60)), np.arange(60), graph, 0, 2).communication, 0, 2)
    truth = min(
        max(len(group) for group in threat.graph.groups(cut)) for cut in combinations(sorted(threat.graph.links), 2)
    )
    found = ro.smallest_largest_group(graph, 2)
    assert (found.lower, found.upper, found.method) == (truth, truth, "enumeration")
    soon = ro.smallest_largest_group(graph, 2, max_nodes=5)
    assert soon.lower <= truth <= soon.upper
    assert ro.smallest_largest_group(graph, 2, time_limit=0).upper >= truth
