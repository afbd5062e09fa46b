"""Worst attacks on networks that are larger than the definition reaches: closed, true, the same for other labels."""

import networkx as nx
import numpy as np
import pytest

import ratt_opt as ro
from ratt_opt.budget import Budget
from tests.attack.engine import LARGE, annealed_value
from tests.brackets import attains
from tests.interrupts import interrupted_at
from tests.strategies import OBJECTIVES, OwnTrace, range_bearing
from tests.ways import go


@pytest.mark.parametrize("family", ["hubs", "disk-6", "disk-12", "small-world"])
@pytest.mark.parametrize("name", ["trace", "logdet", "maxeig"])
def test_few_links_and_many_blinded_are_attacked_no_less_than_by_one_annealing(family, name):
    """Few groups can be left, so nothing was annealed: attacks were 1 to 3 % too mild."""
    problem = ro.network_scenario(family, 40, 15, alpha_s=0.35, alpha_c=0.06, seed=5).problem(name)
    plan = ro.ratt(problem).elements
    annealed = annealed_value(problem, plan, seed=99)
    result = ro.worst_case_attack(problem, plan, max_nodes=300_000, brief=True)
    assert result.upper <= annealed * (1 + 5e-4)
    assert result.lower <= annealed


def disk_graph(seed, n_robots, degree):
    position = np.random.default_rng(seed).random((n_robots, 2))
    distance = np.linalg.norm(position[:, None] - position, axis=-1)
    pairs = np.argwhere(np.triu(np.ones_like(distance), 1))
    nearest = pairs[np.argsort(distance[pairs[:, 0], pairs[:, 1]])][: n_robots * degree // 2]
    graph = nx.empty_graph(n_robots)
    graph.add_edges_from(nearest.tolist())
    return graph


@pytest.mark.parametrize("name", OBJECTIVES)
def test_thirty_robots_on_a_disk_graph_close(name):
    rng = np.random.default_rng(3)
    objective = OBJECTIVES[name](*range_bearing(rng, 30, 20, 1))
    problem = ro.Problem(objective, np.arange(30), disk_graph(3, 30, 6), 5, 10, frozenset({4}), frozenset())
    plan = np.arange(30)
    result = ro.worst_case_attack(problem, plan)
    assert result.stop is ro.Stop.CLOSED
    assert result.upper - result.lower <= 1.1e-10 * result.upper + 2 * problem.evaluation_error
    assert attains(problem, plan, result)
    assert result.upper <= min(ro.greedy_attack(problem, plan).upper, ro.bounded_rational_attack(problem, plan).upper)
    assert all(result.lower <= ro.random_attack(problem, plan, seed=seed).upper for seed in range(100))
    again = ro.worst_case_attack(problem, plan)
    assert (again.attack, again.nodes) == (result.attack, result.nodes)


@pytest.mark.parametrize("seed", range(3))
def test_relabelling_changes_nothing(seed):
    rng = np.random.default_rng(seed)
    prior, information = range_bearing(rng, 24, 6, 1)
    graph, order = disk_graph(seed, 24, 5), rng.permutation(24)
    moved = np.empty_like(information)
    moved[order] = information
    renamed = nx.relabel_nodes(graph, dict(enumerate(order.tolist())))
    values = [
        ro.worst_case_attack(ro.Problem(ro.LogDetObjective(prior, data), np.arange(24), g, 4, 8), np.arange(24)).upper
        for data, g in ((information, graph), (moved, renamed))
    ]
    assert values[0] == pytest.approx(values[1], rel=1e-9)


@pytest.mark.parametrize("calls", [1, 2, 5, 20])
def test_an_interrupt_returns_the_bracket_reached(calls, monkeypatch):
    rng = np.random.default_rng(2)
    problem = ro.Problem(ro.TraceObjective(*range_bearing(rng, 24, 4, 1)), np.arange(24), disk_graph(2, 24, 5), 4, 9)
    expected = ro.worst_case_attack(problem, np.arange(24))
    go(monkeypatch, LARGE)
    asked = interrupted_at(calls, Budget.spend)
    monkeypatch.setattr(Budget, "spend", asked)
    result = ro.worst_case_attack(problem, np.arange(24))
    assert result.stop is (ro.Stop.INTERRUPTED if asked.calls >= calls else ro.Stop.CLOSED)
    assert result.lower <= expected.upper <= result.upper * (1 + 1e-9)
    assert attains(problem, np.arange(24), result)


@pytest.mark.parametrize("name", OBJECTIVES)
def test_a_protected_link_of_a_complete_graph_only_helps(name):
    """The bracket of the team without protection bounds it from below; with a link nobody would cut it closes."""
    rng = np.random.default_rng(1)
    objective, plan = OBJECTIVES[name](*range_bearing(rng, 24, 5, 1)), np.arange(24)
    free = ro.Problem(objective, plan, None, 6, 60)
    worst = ro.worst_case_attack(free, plan)
    spared = min(free.communication.links - worst.attack.links)
    same = ro.worst_case_attack(ro.Problem(objective, plan, None, 6, 60, frozenset(), frozenset([spared])), plan)
    assert same.stop in {ro.Stop.CLOSED, ro.Stop.EXHAUSTED}
    assert same.upper == pytest.approx(worst.upper, rel=1e-9)
    held = ro.Problem(objective, plan, None, 6, 60, frozenset(), worst.attack.links)
    result = ro.worst_case_attack(held, plan, max_nodes=200_000, brief=True)
    assert worst.lower <= result.lower <= result.upper
    assert attains(held, plan, result)


@pytest.mark.parametrize("seed", range(4))
def test_both_exact_ways_agree_at_sixteen_robots(seed, monkeypatch):
    """Dual prices as it is, thresholds for a criterion of one's own, of which no formula is known."""
    rng = np.random.default_rng(seed)
    prior, information = range_bearing(rng, 16, 4, 1)
    plan, graph = np.arange(16), disk_graph(seed, 16, 4)
    budgets, held = (3, 7), (frozenset({seed}), frozenset(sorted((min(e), max(e)) for e in graph.edges)[:seed]))
    with monkeypatch.context() as large:
        go(large, LARGE)
        problem = ro.Problem(ro.TraceObjective(prior, information), plan, graph, *budgets, *held)
        shown = ro.worst_case_attack(problem, plan)
    hidden = ro.worst_case_attack(ro.Problem(OwnTrace(prior, information), plan, graph, *budgets, *held), plan)
    assert (shown.stop, hidden.stop) == (ro.Stop.CLOSED, ro.Stop.EXHAUSTED)
    assert shown.upper == pytest.approx(hidden.upper, rel=2e-10)
