"""What hanging together costs a group, against all connected sets of robots."""

from __future__ import annotations

from itertools import combinations

import networkx as nx
import numpy as np
import pytest

from ratt_opt.attack.links import Links
from ratt_opt.attackers.by_prices.groups.connections import connected_bound
from ratt_opt.attackers.by_prices.groups.flow import always, augment, open_flow
from ratt_opt.attackers.by_prices.groups.size_forms import BLINDED, ELSE, OPEN, OUTSIDE, SEEING
from ratt_opt.graph.communication import CommunicationGraph
from ratt_opt.graph.threat import Threat

N_ROBOTS = 8


def cheapest(graph, cost, part, *, connected):
    """The least of costs and half the links cut, over sets with all robots inside and none outside."""
    sure = {i for i in graph if part[i] in {SEEING, BLINDED}}
    free = [i for i in graph if part[i] in {OPEN, ELSE}]
    least = np.inf
    for size in range(len(free) + 1):
        for chosen in combinations(free, size):
            group = sure | set(chosen)
            if not connected or (group and nx.is_connected(graph.subgraph(group))):
                crossing = sum(len(group & set(link)) == 1 for link in graph.edges)
                least = min(least, sum(cost[i] for i in group) + crossing / 2)
    return least


def node_of(seed):
    """A random graph, costs, parts of the robots, and their flow."""
    rng = np.random.default_rng(seed)
    graph = nx.gnp_random_graph(N_ROBOTS, rng.uniform(0.2, 0.5), seed=seed)
    part = rng.choice([OPEN, ELSE, OUTSIDE], N_ROBOTS, p=[0.5, 0.3, 0.2]).astype(np.int8)
    part[rng.permutation(N_ROBOTS)[: rng.integers(2, 4)]] = rng.choice([SEEING, BLINDED])
    cost = rng.uniform(-0.5, 1.5, N_ROBOTS)
    threat = Threat(CommunicationGraph(N_ROBOTS, frozenset((min(e), max(e)) for e in graph.edges)), 0, 0)
    links = Links.of(threat)
    into, out, along = np.zeros((1, N_ROBOTS)), np.zeros((1, N_ROBOTS)), np.zeros(len(links.robot))
    bound = open_flow(links, cost, (into[0], out[0], along))
    for i in range(N_ROBOTS):
        if part[i] in {SEEING, BLINDED}:
            always(into, i)
        elif part[i] == OUTSIDE:
            always(out, i)
    return graph, cost, part, links, (into[0], out[0], along), bound


def levels():
    return tuple(np.empty(N_ROBOTS, dtype=np.int64) for _ in range(3))


@pytest.mark.parametrize("first", range(0, 2_000, 200))
def test_no_connected_group_costs_less_than_the_bound(first):
    """Both ways of a flow, and of its remainder when another robot is fixed; often it is more than the minimum cut."""
    raised, tight = 0, 0
    for seed in range(first, first + 200):
        graph, cost, part, links, flow, bound = node_of(seed)
        work = levels()
        cut = augment(links, flow, bound, 1e3, work)
        assert cut == pytest.approx(cheapest(graph, cost, part, connected=False), abs=1e-7)
        side = work[0] >= 0
        spare = np.empty(N_ROBOTS), np.empty(N_ROBOTS), np.empty(len(links.robot))
        pieces = np.empty(N_ROBOTS, dtype=np.int64), np.empty(N_ROBOTS, dtype=np.int64)
        least = cheapest(graph, cost, part, connected=True)
        limit = cut + [1e3, 0.4][seed % 2]
        got = connected_bound(links, part, flow, cut, limit, side, (work, spare, *pieces))
        assert cut <= got <= max(least, 1e9 if np.isinf(least) else least) + 1e-7
        raised, tight = raised + (got > cut + 1e-3), tight + (abs(got - least) < 1e-6)
        if least < np.inf:  # what is left of the flow bounds the nodes below
            robot = next((i for i in graph if part[i] in {OPEN, ELSE}), None)
            if robot is not None:
                part[robot] = OUTSIDE
                always(flow[1][None], robot)
                below = augment(links, flow, got, 1e3, work)
                assert below <= cheapest(graph, cost, part, connected=True) + 1e-7
    assert raised > 20
    assert tight > 20
