"""The exact attackers of larger teams whose groups can be listed, run on teams small enough for the definition."""

from __future__ import annotations

import networkx as nx
import numpy as np
import pytest

import ratt_opt as ro
from ratt_opt.attackers.by_partition import settled_partitions
from ratt_opt.budget import Budget
from tests.attackers.engine import LARGE, NO_LISTS, annealed_value, searched
from tests.brackets import assert_search_closed, attains, worst_value
from tests.interrupts import interrupted_at
from tests.oracles import brute_force_worst_case
from tests.strategies import OBJECTIVES, information_data, random_elements, random_graph, range_bearing
from tests.ways import go


def team_problem(seed, n_robots, *, density=None):
    """Random team on a random graph, connected or not, with protected robots and links now and then."""
    rng = np.random.default_rng(seed)
    name = list(OBJECTIVES)[seed % 3]
    data = range_bearing(rng, n_robots, 4, 3) if seed % 2 else information_data(rng, 3 * n_robots, 3)
    graph = random_graph(rng, n_robots) if density is None else nx.gnp_random_graph(n_robots, density, seed=seed)
    links = sorted((min(link), max(link)) for link in graph.edges)
    held = rng.random() < 0.4
    problem = ro.Problem(
        OBJECTIVES[name](*data, rng.uniform(0.2, 3, len(data[0])) if seed % 4 == 0 else None),
        np.repeat(np.arange(n_robots), 3),
        graph,
        int(rng.integers(0, n_robots + 1)),
        int(rng.integers(0, len(links) + 1)),
        frozenset(i for i in range(n_robots) if held and rng.random() < 0.3),
        frozenset(link for link in links if held and rng.random() < 0.2),
    )
    return problem, random_elements(rng, problem)


SEARCHES = ["partitions", "exact covers"]


def run_split(problem, elements, max_nodes=None, search="partitions"):
    """The search itself, whatever ``worst_case_attack`` would choose for this team."""
    first = ro.bounded_rational_attack(problem, elements).attack
    return searched(search, problem, elements, first, max_nodes=max_nodes)


@pytest.mark.parametrize("search", SEARCHES)
@pytest.mark.parametrize("seed", range(120))
def test_value_is_the_definition_s(seed, search):
    problem, elements = team_problem(seed, 1 + seed % 5)
    bracket, _, stop = run_split(problem, elements, search=search)
    assert_search_closed(problem, elements, bracket, stop, brute_force_worst_case(problem, elements))


@pytest.mark.parametrize("search", SEARCHES)
@pytest.mark.parametrize(
    ("seed", "plain", "sharper"),
    [
        *((seed, 300_000, 20_000) for seed in range(45)),
        *((seed, 0, 20_000) for seed in range(9)),
        *((seed, 3, 2) for seed in range(45)),
    ],
)
def test_agrees_with_the_threshold_search(seed, plain, sharper, search, monkeypatch):
    """Nine and ten robots: subsets found in depth, all by branch and bound, with sharp underestimators soon."""
    monkeypatch.setattr(settled_partitions, "PLAIN_NODES", plain)
    monkeypatch.setattr(settled_partitions, "AXIS_NODES", plain)
    monkeypatch.setattr(settled_partitions, "SHARPER_AFTER", sharper)
    if not plain:
        go(monkeypatch, NO_LISTS)
    problem, elements = team_problem(1000 + seed, 9 + seed % 2, density=(0.2, 0.35, 0.6)[seed // 3 % 3])
    bracket, _, stop = run_split(problem, elements, search=search)
    assert_search_closed(problem, elements, bracket, stop, worst_value(problem, elements))


@pytest.mark.parametrize("family", ["hubs", "disk-6", "disk-12", "small-world"])
@pytest.mark.parametrize("name", ["trace", "logdet", "maxeig"])
def test_few_links_and_many_blinded_are_attacked_no_less_than_by_one_annealing(family, name):
    """Few groups can be left, so nothing was annealed: attacks were 1 to 3 % too mild."""
    problem = ro.network_scenario(family, 40, 15, alpha_s=0.35, alpha_c=0.06, seed=5).problem(name)
    plan = ro.ratt(problem).elements
    annealed = annealed_value(problem, plan, seed=99)
    result = ro.worst_case_attack(problem, plan, max_nodes=300_000)
    assert result.upper <= annealed * (1 + 5e-4)
    assert result.lower <= annealed


@pytest.mark.parametrize("search", SEARCHES)
@pytest.mark.parametrize("seed", range(4))
def test_the_bracket_is_valid_at_every_node_count(seed, search, monkeypatch):
    monkeypatch.setattr(settled_partitions, "PLAIN_NODES", 20)
    problem, elements = team_problem(seed, 7, density=0.4)
    problem = ro.Problem(problem.objective, problem.robot, problem.graph, 2, min(5, len(problem.communication.links)))
    expected = worst_value(problem, elements)
    _, nodes, _ = run_split(problem, elements, search=search)
    previous = 0.0
    for limit in [*range(min(nodes, 120)), nodes, nodes + 1]:
        bracket, used, stop = run_split(problem, elements, limit, search)
        assert used <= limit
        assert previous <= bracket.lower <= expected * (1 + 1e-12) + 1e-12
        assert bracket.upper >= expected * (1 - 2e-10)
        assert problem.team_value(elements, bracket.attack) == bracket.upper
        assert (stop is ro.Stop.NODES) == (limit < nodes)
        previous = bracket.lower


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
    result = ro.worst_case_attack(held, plan, max_nodes=200_000)
    assert worst.lower <= result.lower <= result.upper
    assert attains(held, plan, result)


@pytest.mark.parametrize("seed", range(4))
def test_both_exact_ways_agree_at_sixteen_robots(seed, monkeypatch):
    """Partitions into groups as it is, thresholds for a criterion of one's own, of which no formula is known."""
    rng = np.random.default_rng(seed)
    prior, information = range_bearing(rng, 16, 4, 1)

    class Hidden(ro.TraceObjective):
        def criterion(self, posterior_information):
            return super().criterion(posterior_information)

    plan, graph = np.arange(16), disk_graph(seed, 16, 4)
    budgets, held = (3, 7), (frozenset({seed}), frozenset(sorted((min(e), max(e)) for e in graph.edges)[:seed]))
    with monkeypatch.context() as large:
        go(large, LARGE)
        problem = ro.Problem(ro.TraceObjective(prior, information), plan, graph, *budgets, *held)
        shown = ro.worst_case_attack(problem, plan)
    hidden = ro.worst_case_attack(ro.Problem(Hidden(prior, information), plan, graph, *budgets, *held), plan)
    assert (shown.stop, hidden.stop) == (ro.Stop.CLOSED, ro.Stop.EXHAUSTED)
    assert shown.upper == pytest.approx(hidden.upper, rel=2e-10)
