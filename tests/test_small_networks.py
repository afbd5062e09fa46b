"""Worst attacks and best plans on every small connected graph, against their definition; a sample of it quickly.

The definition lists every set of links an attack may cut and every set of robots it may blind, once for a graph: from
the cheapest cut that leaves each family of groups follow the worst cases at all budgets.
"""

from functools import cache
from itertools import combinations, product

import networkx as nx
import numpy as np
import pytest

import ratt_opt as ro
from tests.attack.engine import searched
from tests.strategies import OBJECTIVES, information_data, range_bearing

LARGEST = 6
CLOSE = {"rel": 1e-9, "abs": 1e-9}


@cache
def connected_graphs():
    """All connected graphs of at most six robots, up to isomorphism."""
    return [g for g in nx.graph_atlas_g() if 1 <= len(g) <= LARGEST and nx.is_connected(g)]


@cache
def cheapest_cuts(n_robots, links):
    """Families of groups (as sets of masks) -> fewest cut links that leave them: every set of links is tried."""
    fewest = {}
    for kept in product((False, True), repeat=len(links)):
        group = list(range(n_robots))
        for (i, j), keeps in zip(links, kept, strict=True):
            if keeps and group[i] != group[j]:
                old, new = group[i], group[j]
                group = [new if home == old else home for home in group]
        family = frozenset(sum(1 << i for i in range(n_robots) if group[i] == home) for home in set(group))
        cut = len(links) - sum(kept)
        fewest[family] = min(fewest.get(family, cut), cut)
    return fewest


def worst_cases(graph, values):
    """(N + 1, L + 1) smallest team value when so many robots are blinded and so many links cut at most.

    ``values`` (2**N,) : of every set of robots, by mask
    """
    n_robots = len(graph)
    links = tuple(sorted((min(link), max(link)) for link in graph.edges))
    worst = np.full((n_robots + 1, len(links) + 1), np.inf)
    blinded = np.arange(2**n_robots)
    size = np.bitwise_count(blinded)
    for family, cut in cheapest_cuts(n_robots, links).items():
        left = np.max([values[mask & ~blinded] for mask in family], axis=0)
        for s in range(n_robots + 1):
            worst[s, cut] = min(worst[s, cut], left[size <= s].min())
    return np.minimum.accumulate(worst, axis=1)


def team(rng, name, n_robots, controls):
    """An objective of the robots' elements, ``controls`` each, and the elements' owners."""
    owners = np.repeat(np.arange(n_robots), controls)
    data = range_bearing(rng, n_robots, 3, controls) if rng.random() < 0.7 else information_data(rng, len(owners), 3, 2)
    return OBJECTIVES[name](*data), owners


def check_attacks(graph, seed, budgets, priced):
    """One graph and one plan: the chosen search at so many budgets (``None``: at all), and prices at the first few."""
    rng = np.random.default_rng(seed)
    n_robots = len(graph)
    objective, owners = team(rng, list(OBJECTIVES)[seed % 3], n_robots, 1)
    truth = worst_cases(graph, objective.table())
    for k, (s, c) in enumerate(rng.permutation(list(np.ndindex(truth.shape)))[:budgets].tolist()):
        problem = ro.Problem(objective, owners, graph, s, c)
        found = ro.worst_case_attack(problem, owners)
        assert found.stop in {ro.Stop.CLOSED, ro.Stop.EXHAUSTED}
        assert problem.team_value(owners, found.attack) == pytest.approx(found.upper, **CLOSE)
        by_prices = [searched("annealed attacks and dual prices", problem, owners)[0]] if k < priced else []
        for bracket in (found, *by_prices):
            assert bracket.lower == pytest.approx(truth[s, c], **CLOSE)
            assert bracket.upper == pytest.approx(truth[s, c], **CLOSE)


def check_plans(graph, seed, budgets):
    """The best of all plans of two controls a robot, at so many budgets."""
    rng = np.random.default_rng(seed)
    n_robots = len(graph)
    objective, owners = team(rng, list(OBJECTIVES)[seed % 3], n_robots, 2)
    robots = [[i for i in range(n_robots) if mask >> i & 1] for mask in range(2**n_robots)]
    best = -np.inf
    for plan in product(*(np.flatnonzero(owners == i).tolist() for i in range(n_robots))):
        values = np.array([objective([plan[i] for i in group]) for group in robots])
        best = np.maximum(best, worst_cases(graph, values))
    for s, c in rng.permutation(list(np.ndindex(best.shape)))[:budgets].tolist():
        problem = ro.Problem(objective, owners, graph, s, c)
        found = ro.solve_maxmin(problem, gap=1e-7)
        assert found.lower - 1e-9 <= best[s, c] * (1 + 1e-9)
        assert found.upper + 1e-9 >= best[s, c] * (1 - 1e-9)
        assert found.upper - found.lower <= 2e-7 * found.upper + 1e-9
        reached = ro.worst_case_attack(problem, found.elements).upper
        assert reached == pytest.approx(best[s, c], rel=1e-6, abs=1e-9)


def random_network(rng, n_robots, most_links):
    """A random connected graph with few enough links for every cut to be listed."""
    tree = nx.random_labeled_tree(n_robots, seed=int(rng.integers(2**31)))
    others = sorted(set(combinations(range(n_robots), 2)) - {(min(e), max(e)) for e in tree.edges})
    more = int(rng.integers(0, min(len(others), most_links - tree.number_of_edges()) + 1))
    tree.add_edges_from(others[k] for k in rng.permutation(len(others))[:more])
    return tree


@pytest.mark.parametrize("seed", range(6))
def test_attacks_on_some_graphs(seed):
    graphs = connected_graphs()
    check_attacks(graphs[int(np.random.default_rng(seed).integers(len(graphs)))], seed, budgets=10, priced=2)


@pytest.mark.parametrize("seed", range(3))
def test_plans_on_some_graphs(seed):
    small = [g for g in connected_graphs() if len(g) <= 5]
    check_plans(small[int(np.random.default_rng(seed).integers(len(small)))], seed, budgets=2)


@pytest.mark.slow
@pytest.mark.parametrize("number", range(len(connected_graphs())))
def test_attacks_on_every_graph_at_every_budget(number):
    for seed in range(3):
        check_attacks(connected_graphs()[number], seed, budgets=None, priced=4)


@pytest.mark.slow
@pytest.mark.parametrize("number", range(len(connected_graphs())))
def test_plans_on_every_graph(number):
    check_plans(connected_graphs()[number], number, budgets=4)


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(300))
def test_attacks_on_random_graphs(seed):
    rng = np.random.default_rng(seed)
    check_attacks(random_network(rng, int(rng.integers(7, 9)), 13), seed, budgets=20, priced=4)
