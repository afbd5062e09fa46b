"""Tree inequalities never claim a larger group than some attack leaves, and annealed cuts keep within the budget."""

from itertools import combinations

import networkx as nx
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import ratt_opt as ro
from ratt_opt.budget import Budget
from ratt_opt.graph.communication import CommunicationGraph
from ratt_opt.graph.largest_group.annealed_cut import annealed_cut
from ratt_opt.graph.largest_group.counting import counting_bound, largest_left
from ratt_opt.graph.largest_group.spreading import SCALE, TreeProgram, forced_size, forced_weight
from ratt_opt.graph.threat import Threat
from ratt_opt.scenario.networks import NETWORK_FAMILIES
from tests.strategies import random_graph


def random_threat(seed, most_robots=6, most_links=9):
    """Any graph, budgets and protected parts."""
    rng = np.random.default_rng(seed)
    graph = random_graph(rng, int(rng.integers(1, most_robots + 1)))
    graph.remove_edges_from(sorted(graph.edges)[most_links:])
    n_robots = graph.number_of_nodes()
    links = [link for link in sorted(graph.edges) if rng.random() < 0.2]
    return Threat(
        CommunicationGraph.from_networkx(graph, n_robots),
        int(rng.integers(0, n_robots + 1)),
        int(rng.integers(0, graph.number_of_edges() + 1)),
        frozenset(i for i in range(n_robots) if rng.random() < 0.2),
        frozenset((int(i), int(j)) for i, j in links),
    )


def smallest_by_definition(threat, weights=None):
    """The heaviest group of seeing robots that an attack leaves, least over all attacks within the budgets."""
    weights = np.ones(threat.graph.n_robots, dtype=np.int64) if weights is None else weights
    robots = [i for i in range(threat.graph.n_robots) if i not in threat.protected_robots]
    links = sorted(threat.graph.links - threat.protected_links)
    cuts = [c for k in range(min(threat.alpha_c, len(links)) + 1) for c in combinations(links, k)]
    blinds = [frozenset(b) for b in combinations(robots, threat.n_blinded)]
    return min(
        max(int(weights[sorted(group - blind)].sum()) for group in threat.graph.groups(cut))
        for cut in cuts
        for blind in blinds
    )


@settings(deadline=None)
@given(st.integers(0, 10**9))
def test_no_attack_leaves_less_than_the_trees_say(seed):
    threat = random_threat(seed)
    assert forced_size(threat, Budget(), threat.graph.n_robots) <= smallest_by_definition(threat)


@settings(deadline=None)
@given(st.integers(0, 10**9))
def test_no_attack_leaves_less_weight(seed):
    threat = random_threat(seed)
    weights = np.random.default_rng(seed).integers(0, 2**20, threat.graph.n_robots)
    assert forced_weight(threat, weights, Budget(), weights.sum()) <= smallest_by_definition(threat, weights)


@settings(deadline=None)
@given(st.integers(0, 10**9))
def test_any_multipliers_prove_something_true(seed):
    """What is proved does not hang on the linear program's word."""
    threat = random_threat(seed)
    program, rng = TreeProgram(threat, np.ones(threat.graph.n_robots, dtype=np.int64)), np.random.default_rng(seed)
    for _ in range(3):
        program.refine(Budget())
    program.multipliers = rng.exponential(size=len(program.trees)) * (rng.random(len(program.trees)) < 0.5) / SCALE
    program.multipliers *= rng.choice([1.0, 1e3, SCALE])
    assert program.proved <= smallest_by_definition(threat)


def test_trees_settle_a_path_and_a_star():
    for graph, alpha_c, size in ((nx.path_graph(30), 2, 10), (nx.star_graph(20), 5, 16), (nx.cycle_graph(24), 4, 6)):
        found = ro.smallest_largest_group(graph, alpha_c, method="spreading")
        assert (found.lower, found.upper) == (size, size)


@pytest.mark.parametrize("family", NETWORK_FAMILIES)
def test_it_is_never_worse_than_counting(family):
    graph = ro.network_scenario(family, 24, 5, alpha_s=0, alpha_c=0, seed=1).problem("trace").communication
    for share in (0.0, 0.1, 0.3, 1.0):
        threat = Threat(graph, 0, int(share * len(graph.links)), frozenset(), frozenset(sorted(graph.links)[:3]))
        cut = annealed_cut(threat, frozenset(), counting_bound(threat), Budget())
        assert len(cut) <= threat.alpha_c
        assert not cut & threat.protected_links
        assert counting_bound(threat) <= max(forced_size(threat, Budget(), 24), counting_bound(threat))
        assert forced_size(threat, Budget(), 24) <= largest_left(graph, cut)


def test_a_hundred_robots_get_a_narrow_bracket():
    graph = ro.network_scenario("disk-6", 100, 5, alpha_s=0, alpha_c=0, seed=0).problem("trace").communication
    found = ro.smallest_largest_group(graph, len(graph.links) * 3 // 20, method="spreading")
    assert found.upper <= 1.2 * found.lower


def test_a_spent_budget_leaves_what_counting_knows():
    graph = nx.random_regular_graph(4, 40, seed=0)
    found = ro.smallest_largest_group(graph, 20, method="spreading", time_limit=0)
    assert found.lower == ro.smallest_largest_group(graph, 20, method="counting").lower
