"""The attack on a plan whose robots are all alike is the cut that leaves the smallest largest group."""

import json
from pathlib import Path

import networkx as nx
import numpy as np
import pytest

import ratt_opt as ro

DATA = Path(__file__).parents[2].parent / "shared" / "data" / "graph_partition" / "instances.jsonl"


def problem_of(graph, alpha_c, objective, protected=(), alpha_s=0):
    n = graph.number_of_nodes()
    if objective == "modular":
        worth = ro.Modular(np.ones(n))
    else:
        kind = {"trace": ro.TraceObjective, "logdet": ro.LogDetObjective, "maxeig": ro.MaxEigenvalueObjective}
        worth = kind[objective](2.0 * np.eye(2)[None], np.repeat(np.diag([1.0, 0.5])[None, None], n, axis=0))
    return ro.Problem(worth, np.arange(n), graph, alpha_s, alpha_c, protected_links=protected)


def compare(graph, alpha_c, objective, protected=(), **limits):
    """Both brackets share a value, and the attack leaves no larger a group where the size is known."""
    problem = problem_of(graph, alpha_c, objective, protected)
    attack = ro.worst_case_attack(problem, np.arange(len(graph)), **limits)
    size = ro.smallest_largest_group(graph, alpha_c, protected_links=protected, **limits)
    ends = [problem.objective(range(robots)) for robots in (size.lower, size.upper)]
    rounding = 1e-9 * ends[1]
    assert attack.lower <= ends[1] + rounding
    assert ends[0] <= attack.upper + rounding
    if size.is_exact:
        assert attack.stop is ro.Stop.CLOSED
        assert attack.upper == pytest.approx(ends[1], rel=1e-9)
        assert attack.lower == pytest.approx(ends[1], rel=1e-9)
    return size, attack


@pytest.mark.parametrize("seed", range(12))
def test_attack_and_size_agree_on_random_graphs(seed):
    rng = np.random.default_rng(seed)
    n = int(rng.integers(2, 20))
    graph = nx.gnp_random_graph(n, rng.uniform(0.05, 0.4), seed=seed)
    links = sorted(graph.edges)
    protected = [link for link in links if rng.random() < 0.1 * (seed % 2)]
    alpha_c = int(rng.integers(0, len(links) // 2 + 1))
    objective = ("modular", "trace", "logdet", "maxeig")[seed % 4]
    size, _ = compare(graph, alpha_c, objective, protected)
    assert size.is_exact
    compare(graph, alpha_c, objective, protected, max_nodes=int(rng.integers(0, 50)))


@pytest.mark.parametrize("share", [0.1, 0.5])
@pytest.mark.parametrize("name", ["florentine_families", "davis_southern_women", "karate_club"])
def test_attack_and_size_agree_on_public_graphs(name, share):
    graph = nx.convert_node_labels_to_integers(getattr(nx, f"{name}_graph")())
    size, attack = compare(graph, round(share * graph.number_of_edges()), "logdet")
    assert size.is_exact
    assert [stage.name for stage in attack.stages] == ["smallest largest group"]


@pytest.mark.slow
@pytest.mark.skipif(not DATA.exists(), reason="published instances are not beside the repository")
def test_attack_and_size_agree_where_they_once_disagreed():
    """The size search said [6, 12] of dolphins and [8, 13] of Les Miserables."""
    rows = [json.loads(line) for line in DATA.read_text(encoding="utf-8").splitlines()]
    dolphins = next(row for row in rows if row["graph"] == "real-3" and row["n"] == 62)
    graph = nx.empty_graph(62)
    graph.add_edges_from(dolphins["links"])
    assert compare(graph, 78, "logdet", time_limit=60)[0].n_max == 6
    novel = nx.convert_node_labels_to_integers(nx.les_miserables_graph())
    assert compare(novel, 110, "trace", time_limit=60)[0].n_max == 8


@pytest.mark.parametrize("kind", ["small world", "disk"])
def test_brackets_share_a_value_whatever_ends_the_search(kind):
    graph = nx.connected_watts_strogatz_graph(40, 4, 0.2, seed=1)
    if kind == "disk":
        graph = nx.convert_node_labels_to_integers(nx.random_geometric_graph(40, 0.25, seed=2))
    for nodes in (0, 300, 5_000):
        compare(graph, graph.number_of_edges() // 4, "trace", max_nodes=nodes)


def test_robots_that_differ_or_can_be_blinded_are_not_counted():
    graph = nx.path_graph(6)
    problem = problem_of(graph, 2, "trace", alpha_s=1)
    names = {stage.name for stage in ro.worst_case_attack(problem, np.arange(6)).stages}
    assert "smallest largest group" not in names
    unequal = ro.Problem(ro.Modular([1, 1, 1, 1, 1, 2]), np.arange(6), graph, 0, 2)
    found = ro.worst_case_attack(unequal, np.arange(6))
    assert "smallest largest group" not in {stage.name for stage in found.stages}
    assert found.upper == 3.0
