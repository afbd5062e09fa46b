"""Partitions into listed groups, against all choices of groups."""

from __future__ import annotations

from itertools import combinations

import networkx as nx
import numpy as np
import pytest

from ratt_opt.attack.pricing import Column
from ratt_opt.attackers.by_prices import partitions
from ratt_opt.attackers.by_prices.partitions import partitions_into
from ratt_opt.budget import Budget
from ratt_opt.graph.communication import CommunicationGraph
from ratt_opt.graph.threat import Threat


@pytest.mark.parametrize("seed", range(40))
def test_partitions_against_all_choices_of_groups(seed, monkeypatch):
    rng = np.random.default_rng(seed)
    monkeypatch.setattr(partitions, "COVERS", int(rng.integers(1, 20)))
    graph = nx.gnp_random_graph(5, 0.6, seed=seed)
    threat = Threat(
        CommunicationGraph(5, frozenset(graph.edges)),
        int(rng.integers(4)),
        int(rng.integers(min(5, len(graph.edges)) + 1)),
    )
    masks = rng.choice(np.arange(1, 32), size=12, replace=False)
    groups = [np.array([bool(mask >> i & 1) for i in range(5)]) for mask in masks]
    columns = [
        Column(robots=group, blinded=group, need=int(need), found=int(need), cost=int(cost))
        for group, need, cost in zip(groups, rng.integers(3, size=12), rng.integers(-1, 3, 12), strict=True)
    ]
    gap = int(rng.integers(1, 5))
    expected = set()
    for chosen in (one for k in range(1, 6) for one in combinations(range(12), k)):
        those = [columns[k] for k in chosen]
        half = sum(nx.cut_size(graph, np.flatnonzero(one.robots).tolist()) for one in those) / 2
        within = half <= threat.alpha_c and sum(one.need for one in those) <= threat.n_blinded
        within = within and sum(max(one.cost, 0) for one in those) <= gap
        if within and (np.sum([one.robots for one in those], axis=0) == 1).all():
            expected.add(chosen)
    found = [tuple(sorted(one)) for one in partitions_into(columns, threat, gap, Budget())]
    assert len(found) == len(set(found))
    assert set(found) == expected
    assert not list(partitions_into([], threat, gap, Budget()))
