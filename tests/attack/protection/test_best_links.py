"""The best links to protect and to add, against the definition: every choice of k links, every attack on the team."""

import time
from dataclasses import replace
from itertools import combinations

import networkx as nx
import numpy as np
import pytest

import ratt_opt as ro
from ratt_opt import links_to_add, links_to_protect
from tests.oracles import brute_force_worst_case
from tests.strategies import information_data, random_elements, random_problem


def with_links(problem, links):
    graph = nx.Graph([*problem.communication.links, *links])
    graph.add_nodes_from(range(problem.n_robots))
    return replace(problem, graph=graph)


def missing_links(problem):
    return sorted(set(combinations(range(problem.n_robots), 2)) - problem.communication.links)


def best_by_definition(problem, elements, choose, candidates, k):
    """The largest worst case over every choice of exactly k candidates (of all, where there are fewer)."""
    choices = combinations(candidates, min(k, len(candidates)))
    return max(brute_force_worst_case(choose(problem, links), elements) for links in choices)


def protecting(problem, links):
    return replace(problem, protected_links=problem.protected_links | set(links))


def check(problem, elements, k, candidates=None):
    """Both functions on one problem; their brackets close on the definition, and the links keep what they promise."""
    unprotected = sorted(problem.communication.links - problem.protected_links)
    for function, choose, default in (
        (links_to_protect, protecting, unprotected),
        (links_to_add, with_links, missing_links(problem)),
    ):
        given = None if candidates is None else [link for link in candidates if link in default]
        best = function(problem, elements, k, candidates=given)
        truth = best_by_definition(problem, elements, choose, default if given is None else given, k)
        assert best.stop is ro.Stop.CLOSED
        assert best.lower == pytest.approx(truth, rel=1e-9, abs=1e-9)
        rounding = 1e-9 + problem.evaluation_error  # by which published ends are moved apart, those of 0 too
        assert best.upper == pytest.approx(truth, rel=1e-9, abs=rounding)
        assert len(best.links) <= k
        assert set(best.links) <= set(default if given is None else given)
        assert brute_force_worst_case(choose(problem, best.links), elements) == pytest.approx(truth, rel=1e-9, abs=1e-9)
        before = brute_force_worst_case(problem, elements)
        assert best.before.upper == pytest.approx(before, rel=1e-9, abs=rounding)
        for gain in (best.gain_lower, best.gain_upper):
            assert gain == pytest.approx(truth - before, rel=1e-9, abs=4 * rounding + 2e-9 * abs(truth))


@pytest.mark.parametrize("seed", range(40))
def test_against_every_choice_of_links(seed):
    rng = np.random.default_rng(seed)
    problem = random_problem(rng, int(rng.integers(1, 6)))
    if len(problem.communication.links) > 7:  # the definition would take a while
        problem = replace(problem, alpha_c=min(problem.alpha_c, 3))
    elements = random_elements(rng, problem)
    pairs = list(combinations(range(problem.n_robots), 2))
    some = [pair for pair in pairs if rng.random() < 0.6] if rng.random() < 0.5 else None
    check(problem, elements, int(rng.integers(0, 4)), some)


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(40, 400))
def test_against_every_choice_of_links_of_more_teams(seed):
    rng = np.random.default_rng(seed)
    problem = random_problem(rng, int(rng.integers(3, 7)), complete=False)
    few = len(problem.communication.links) <= 8  # more take the definition minutes
    problem = replace(problem, alpha_c=min(problem.alpha_c, 4 if few else 2))
    check(problem, random_elements(rng, problem), int(rng.integers(1, 4 if few else 3)))


def two_teams():
    """Two triangles joined by one link, all robots worth 1 together and alone: the bridge is what matters."""
    weights = np.arange(2**6)[:, None] >> np.arange(6) & 1
    objective = ro.TableFunction(weights.sum(axis=1).astype(float))
    return ro.Problem(objective, np.arange(6), nx.barbell_graph(3, 0), 0, 1), np.arange(6)


def test_the_bridge_is_protected_or_doubled():
    problem, elements = two_teams()
    best = links_to_protect(problem, elements, 1)
    assert (best.links, best.lower, best.before.upper) == (((2, 3),), 6.0, 3.0)
    doubled = links_to_add(problem, elements, 1)
    assert doubled.lower == 6.0
    assert {home < 3 for home in doubled.links[0]} == {True, False}
    assert links_to_add(problem, elements, 1, candidates=[(0, 5)]).links == ((0, 5),)
    none = links_to_add(problem, elements, 0)
    assert (none.links, none.lower, none.upper) == ((), 3.0, 3.0)


def test_what_cannot_be_chosen_is_refused():
    problem, elements = two_teams()
    with pytest.raises(ro.InputError, match="links of the graph"):
        links_to_protect(problem, elements, 1, candidates=[(0, 5)])
    with pytest.raises(ro.InputError, match="without a link"):
        links_to_add(problem, elements, 1, candidates=[(0, 1)])
    with pytest.raises(ro.InputError, match="without a link"):
        links_to_add(problem, elements, 1, candidates=[(0, 6)])
    with pytest.raises(ro.InputError, match="repeated"):
        links_to_add(problem, elements, 1, candidates=[(0, 5), (5, 0)])
    with pytest.raises(ro.InputError, match="k must be an integer"):
        links_to_protect(problem, elements, -1)


@pytest.mark.parametrize("limit", [{"time_limit": 0}, {"max_nodes": 0}])
def test_limits_leave_a_bracket(limit):
    problem = ro.network_scenario("disk-6", 11, 4, alpha_s=2, alpha_c=6, seed=0).problem()
    elements = ro.ratt(problem).elements
    for function in (links_to_protect, links_to_add):
        exact, brief = function(problem, elements, 2), function(problem, elements, 2, **limit)
        assert exact.stop is ro.Stop.CLOSED
        assert brief.stop in {ro.Stop.TIME, ro.Stop.NODES}
        assert brief.lower <= exact.lower * (1 + 1e-9)
        assert brief.upper >= exact.upper * (1 - 1e-9)


@pytest.mark.parametrize("choose", [ro.links_to_add, ro.links_to_protect])
@pytest.mark.parametrize("shape", ["hubs", "parts"])
def test_limits_are_kept_by_a_thousand_robots(choose, shape):
    """Half a million pairs, and hundreds of groups: two seconds beyond the limit, of the processor."""
    hubs, parts = nx.barabasi_albert_graph(1000, 4, seed=0), nx.Graph([(i, i + 1) for i in range(0, 1000, 2)])
    graph = hubs if shape == "hubs" else parts
    prior, information = information_data(np.random.default_rng(0), 1000, 4, 2)
    problem = ro.Problem(ro.TraceObjective(prior, information), np.arange(1000), graph, 200, 300)
    began = time.process_time()
    found = choose(problem, np.arange(1000), 3, time_limit=0.1)
    assert time.process_time() - began <= 2.105
    assert 0 < found.lower <= found.upper
