"""Groups that an attack may leave, as their list in C has them, against the definition."""

from itertools import combinations

import networkx as nx
import numpy as np
import pytest

from ratt_opt import InputError
from ratt_opt.budget import Budget
from ratt_opt.graph import group_list
from ratt_opt.graph.communication import CommunicationGraph
from ratt_opt.graph.group_list import GroupList
from tests.strategies import random_problem


@pytest.mark.parametrize("seed", range(40))
def test_groups_against_all_sets(seed, monkeypatch):
    """In one part and in many; in few bytes and in more."""
    monkeypatch.setattr(group_list, "STEPS", [group_list.STEPS, 3][seed % 2])
    is_large = seed // 2 % 2
    if is_large:
        monkeypatch.setattr(group_list, "NARROW", 0)
        monkeypatch.setattr(group_list, "MOST_CUT", -1)
    rng = np.random.default_rng(seed)
    threat = random_problem(rng, int(rng.integers(1, 8)), kind="logdet", controls=1).threat
    graph = nx.Graph(threat.graph.links)
    graph.add_nodes_from(range(threat.graph.n_robots))
    listed, cuts = GroupList(threat.graph, threat.alpha_c, threat.protected_links).all(Budget())
    expected = {}
    for size in range(1, threat.graph.n_robots + 1):
        for inside in combinations(range(threat.graph.n_robots), size):
            leaving = [link for link in threat.graph.links if (link[0] in inside) != (link[1] in inside)]
            if (
                nx.is_connected(graph.subgraph(inside))
                and len(leaving) <= threat.alpha_c
                and not threat.protected_links.intersection(leaving)
            ):
                expected[sum(1 << i for i in inside)] = len(leaving)
    assert (listed.dtype, cuts.dtype) == ((np.int64, np.int64) if is_large else (np.uint32, np.uint8))
    assert dict(zip(listed.tolist(), cuts.tolist(), strict=True)) == expected


@pytest.mark.parametrize("robots", [0, 1])
def test_the_smallest_lists(robots):
    groups = GroupList(CommunicationGraph(robots, frozenset()), 3, frozenset())
    masks, links = groups.all(Budget())
    assert (masks.tolist(), links.tolist(), len(groups)) == ([1] * robots, [0] * robots, robots)


@pytest.mark.parametrize(("robots", "kind"), [(32, np.uint32), (33, np.int64), (63, np.int64)])
def test_groups_of_as_many_robots_as_a_mask_has(robots, kind):
    """All parts of a row that two cuts leave."""
    row = CommunicationGraph.from_networkx(nx.path_graph(robots), robots)
    masks, links = GroupList(row, 2, frozenset()).all(Budget())
    parts = {((1 << b) - (1 << a), (a > 0) + (b < robots)) for b in range(1, robots + 1) for a in range(b)}
    assert set(zip(masks.tolist(), links.tolist(), strict=True)) == parts
    assert len(masks) == len(parts)
    assert masks.dtype == kind


def test_robots_that_a_mask_does_not_have():
    with pytest.raises(InputError, match="must have at most 63 robots"):
        GroupList(CommunicationGraph(64, frozenset()), 0, frozenset())
