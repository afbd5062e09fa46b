"""Cheapest cuts against networkx, and cuts that stay within the link budget however little time there is."""

import networkx as nx
import numpy as np
import pytest

from ratt_opt.budget import Budget
from ratt_opt.graph.communication import CommunicationGraph
from ratt_opt.graph.largest_group.counting import counting_bound, largest_left
from ratt_opt.graph.largest_group.heuristic_cut import cheapest_cut, heuristic_cut
from ratt_opt.graph.threat import Threat


@pytest.mark.parametrize("seed", range(60))
def test_cheapest_cuts_are_the_cheapest(seed):
    rng = np.random.default_rng(seed)
    n = int(rng.integers(2, 14))
    graph = nx.compose(nx.path_graph(n), nx.gnp_random_graph(n, float(rng.random()), seed=seed))
    weights = np.zeros((n, n))
    for i, j in graph.edges:
        weights[i, j] = weights[j, i] = graph[i][j]["weight"] = float(rng.integers(1, 4))
    side = cheapest_cut(weights)
    assert 0 < side.sum() < n
    assert weights[np.ix_(side, ~side)].sum() == nx.stoer_wagner(graph)[0]


@pytest.mark.parametrize("seconds", [0, None])
@pytest.mark.parametrize("seed", range(20))
def test_cuts_are_allowed_and_shrink_the_largest_group(seed, seconds):
    rng = np.random.default_rng(seed)
    n = int(rng.integers(2, 40))
    graph = CommunicationGraph.from_networkx(nx.gnp_random_graph(n, float(rng.random()), seed=seed), n)
    links = sorted(graph.links)
    held = frozenset(link for link in links if rng.random() < 0.1)
    threat = Threat(graph, 0, int(rng.integers(0, len(links) + 1)), protected_links=held)
    cut = heuristic_cut(threat, Budget(seconds))
    assert len(cut) <= threat.alpha_c
    assert cut <= graph.links - held
    assert counting_bound(threat) <= largest_left(graph, cut) <= largest_left(graph, ())
