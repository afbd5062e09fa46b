"""Groups and links of a communication graph against networkx, of few robots and of hundreds."""

import networkx as nx
import numpy as np
import pytest

from ratt_opt.graph.communication import CommunicationGraph


@pytest.mark.parametrize("robots", [1, 2, 7, 30, 64, 65, 200, 500])
@pytest.mark.parametrize("degree", [0.5, 2.0, 12.0])
def test_groups_and_links_are_those_of_the_graph(robots, degree):
    graph = nx.gnp_random_graph(robots, min(1.0, degree / robots), seed=robots)
    rng, communication = np.random.default_rng(robots), CommunicationGraph.from_networkx(graph, robots)
    links = sorted(communication.links)
    cut = {links[k] for k in rng.permutation(len(links))[: len(links) // 3]}
    left = graph.copy()
    left.remove_edges_from(cut)
    assert communication.groups(cut) == tuple(sorted(map(frozenset, nx.connected_components(left)), key=min))
    some = frozenset(np.flatnonzero(rng.random(robots) < 0.5).tolist())
    among = map(frozenset, nx.connected_components(graph.subgraph(some)))
    assert communication.groups_among(some) == tuple(sorted(among, key=min))
    for robot in range(0, robots, 7):
        assert communication.links_of(robot) == {(min(edge), max(edge)) for edge in graph.edges(robot)}
    home = rng.integers(0, 3, robots)
    between = {(i, j) for i, j in links if home[i] != home[j]}
    for groups in (
        [np.flatnonzero(home == k).tolist() for k in range(4)],
        [np.flatnonzero(home == k) for k in range(4)],
    ):
        found = communication.links_between(groups)
        assert found == between
        assert {type(robot) for link in found for robot in link} <= {int}
