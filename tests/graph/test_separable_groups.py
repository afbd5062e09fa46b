from __future__ import annotations

from dataclasses import replace
from itertools import combinations

import networkx as nx
import numpy as np
import pytest

from ratt_opt import InputError
from ratt_opt.budget import Budget
from ratt_opt.graph import group_list
from ratt_opt.graph.communication import CommunicationGraph
from ratt_opt.graph.connected_partitions import connected_partitions
from ratt_opt.graph.separable_groups import PartitionSearch, separable_groups
from ratt_opt.graph.threat import Threat
from tests.strategies import random_problem


def by_definition(threat):
    graph = nx.Graph(sorted(threat.graph.links))
    graph.add_nodes_from(range(threat.graph.n_robots))
    for size in range(1, threat.graph.n_robots + 1):
        for group in combinations(range(threat.graph.n_robots), size):
            out = {(min(e), max(e)) for e in nx.edge_boundary(graph, group)}
            allowed = len(out) <= threat.alpha_c and not out & threat.protected_links
            if allowed and nx.is_connected(graph.subgraph(group)):
                yield group


@pytest.mark.parametrize("seed", range(60))
def test_groups_are_those_of_the_definition(seed):
    threat = random_problem(np.random.default_rng(seed), 1 + seed % 8, kind="logdet", controls=1).threat
    groups = separable_groups(threat, 10_000)
    found = [tuple(groups.members(k).tolist()) for k in range(len(groups.masks))]
    for group, links in zip(found, groups.links.tolist(), strict=True):
        assert links == sum((i in group) != (j in group) for i, j in threat.graph.links)
    assert len(found) == len(set(found))
    assert set(found) == set(by_definition(threat))
    if len(found) > 1:
        assert separable_groups(threat, len(found) - 1) is None
    assert separable_groups(threat, len(found)) is not None


@pytest.mark.parametrize("seed", range(8))
def test_a_listing_that_the_budget_ends_goes_on_the_next_time(seed, monkeypatch):
    threat = random_problem(np.random.default_rng(seed), 5 + seed % 4, kind="logdet", controls=1).threat
    expected = set(by_definition(threat))
    monkeypatch.setattr(group_list, "STEPS", 1)
    group_list._kept.cache_clear()
    looks = iter([False, True] * 10**5)
    monkeypatch.setattr(Budget, "is_over", property(lambda _: next(looks)))
    calls = 1
    while (groups := separable_groups(threat, 10_000, Budget())) is None:
        calls += 1
    assert calls >= len(expected)
    assert {tuple(groups.members(k).tolist()) for k in range(len(groups.masks))} == expected


@pytest.mark.parametrize("seed", range(60))
@pytest.mark.parametrize("limit", [1, 10**6])
def test_partitions_are_all_those_into_groups_of_the_list(seed, limit, monkeypatch):
    """Also when the search is paused after every node, or every group that it looks at."""
    monkeypatch.setattr("ratt_opt.graph.separable_groups.GROUPS_AT_ONCE", [10**6, 1][seed % 2])
    rng = np.random.default_rng(seed)
    threat = random_problem(rng, 1 + seed % 7, kind="logdet", controls=1).threat
    groups = separable_groups(threat, 10_000)
    kept = rng.random(len(groups.masks)) < rng.choice([0.6, 0.9, 1.0])
    few = groups.among(kept)
    search, found = PartitionSearch(few), []
    while not search.finished:
        before = search.nodes
        chosen = search.next(limit)
        assert search.nodes <= before + limit
        if chosen is not None:
            found.append(frozenset(tuple(few.members(k).tolist()) for k in chosen))
    listed = {tuple(groups.members(k).tolist()) for k in np.flatnonzero(kept).tolist()}
    expected = set()
    for partition in connected_partitions(threat):
        parts = frozenset(tuple(i for i in range(threat.graph.n_robots) if mask >> i & 1) for mask in partition)
        if parts <= listed:
            expected.add(parts)
    assert len(found) == len(set(found))
    assert set(found) == expected


def test_too_many_robots_for_a_mask():
    assert separable_groups(Threat(CommunicationGraph.from_networkx(nx.path_graph(61), 61), 1, 1), 10_000) is None


def test_a_partition_of_one_robot():
    groups = separable_groups(Threat(CommunicationGraph(1, frozenset()), 1, 0), 10)
    search = PartitionSearch(groups)
    assert search.next(10) == [0]
    assert search.next(10) is None
    assert search.finished
    search = PartitionSearch(groups.among(np.zeros(1, dtype=np.bool_)))
    assert search.next(10) is None
    assert (search.finished, search.nodes) == (True, 0)


def test_what_c_may_not_read_is_refused():
    groups = separable_groups(Threat(CommunicationGraph.from_networkx(nx.cycle_graph(5), 5), 1, 2), 100)
    PartitionSearch(groups)
    for name in ("masks", "start", "neighbours"):
        array = getattr(groups, name)
        strided = np.repeat(array, 2)[::2]
        for bad in (array.astype(np.int32), array.tolist(), array[:-1].copy(), strided, array[:, None]):
            with pytest.raises(InputError):
                PartitionSearch(replace(groups, **{name: bad}))
