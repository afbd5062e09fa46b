"""Any networkx graph as a communication graph: the stated rule, on drawn graphs of every kind and kind of node."""

from itertools import pairwise

import networkx as nx
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import ratt_opt as ro
from tests.strategies import networkx_graphs


@given(networkx_graphs())
def test_the_rule(graph):
    before = graph.copy()
    found = ro.communication_graph(graph)
    assert nx.utils.graphs_equal(graph, before)
    assert type(found) is nx.Graph
    assert list(found) == list(range(len(graph)))
    node = {i: found.nodes[i]["node"] for i in found}
    assert set(node.values()) == set(graph)
    for i in found:
        for j in found:
            edges = [sum((a, b) == ends for a, b in graph.edges()) for ends in ((node[i], node[j]), (node[j], node[i]))]
            count = max(edges) if graph.is_directed() else sum(edges)
            assert found.has_edge(i, j) == (i != j and count > 0)
            if found.has_edge(i, j):
                assert found.edges[i, j]["count"] == count
    assert all(found.nodes[i]["name"].isprintable() for i in found)
    ro.Problem(ro.Modular(np.ones(len(found))), np.arange(len(found)), found, 0, 0)
    has_parallel = any(count > 1 for *_, count in found.edges(data="count"))
    if has_parallel:
        with pytest.raises(
            ro.InputError, match=r'^graph must have no parallel edges \(parallel="count" takes them\); got'
        ):
            ro.communication_graph(graph, parallel="refuse")
    else:
        assert nx.utils.graphs_equal(ro.communication_graph(graph, parallel="refuse"), found)


@given(
    st.lists(st.one_of(st.integers(), st.text("ab09", max_size=4), st.tuples(st.integers())), unique=True), st.data()
)
def test_numbers_do_not_depend_on_the_order_in_which_nodes_were_added(nodes, data):
    graph, other = nx.Graph(), nx.Graph()
    graph.add_nodes_from([*nodes, "last"])
    other.add_nodes_from([*data.draw(st.permutations(nodes)), "last"])
    for one in (graph, other):
        one.add_edges_from(pairwise([*nodes, "last"]))
    assert nx.utils.graphs_equal(ro.communication_graph(graph), ro.communication_graph(other))


def test_order_and_names():
    graph = nx.MultiDiGraph([("r10", "r2"), ("r2", "r10"), (3, "r2"), (3, "r2"), (3, 3), ((0, 1), 1.5)])
    graph.nodes["r2"]["label"] = "Győr\nwest"
    graph.nodes[3].update(label="", name="three", x=1.0)
    graph.nodes["r10"]["label"] = 10
    found = ro.communication_graph(graph)
    assert [found.nodes[i]["node"] for i in found] == [1.5, 3, "r2", "r10", (0, 1)]
    assert [found.nodes[i]["name"] for i in found] == ["1.5", "three", "Győr west", "10", "(0, 1)"]
    assert sorted(found.edges(data="count")) == [(0, 4, 1), (1, 2, 2), (2, 3, 1)]
    assert found.nodes[1]["x"] == 1.0


def test_weights_of_parallel_edges_add_up_and_of_two_directions_the_heavier_counts():
    graph = nx.MultiDiGraph()
    graph.add_weighted_edges_from(
        [("a", "b", 2.0), ("a", "b", 3.0), ("b", "a", 4.5), ("c", "a", 0.25), ("b", "b", 9.0)]
    )
    graph.add_edge("c", "b")
    found = ro.communication_graph(graph, weight="weight")
    assert sorted(found.edges(data="weight")) == [(0, 1, 5.0), (0, 2, 0.25), (1, 2, 1.0)]
    assert "weight" not in ro.communication_graph(graph).edges[0, 1]
    both = ro.communication_graph(nx.MultiGraph(graph.edges(data=True)), weight="weight")
    assert both.edges[0, 1]["weight"] == 9.5


@pytest.mark.parametrize("weight", [-1.0, float("nan"), "2", None])
def test_weights_that_are_none_are_refused(weight):
    with pytest.raises(ro.InputError, match="weight of the edge between a and b must be a finite number >= 0"):
        ro.communication_graph(nx.Graph([("a", "b", {"weight": weight})]), weight="weight")


def test_what_is_refused():
    for graph, text in ((3, "must be a networkx graph; got int"), (nx.Graph(), "must have at least one node")):
        with pytest.raises(ro.InputError, match=text):
            ro.communication_graph(graph)
    with pytest.raises(ro.InputError, match="parallel must be one of count, refuse; got sum"):
        ro.communication_graph(nx.path_graph(2), parallel="sum")
