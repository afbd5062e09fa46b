import numpy as np
import pytest

import ratt_opt as ro
from ratt_opt import AttackParams
from ratt_opt.budget import Budget
from tests.attack.engine import FAMILIES, NO_LISTS, searched
from tests.brackets import attained, attains, worst_value
from tests.interrupts import interrupted_at
from tests.strategies import OBJECTIVES, information_data, random_elements, range_bearing
from tests.ways import go


def team_problem(seed, n_robots, name, *, protect=False):
    rng = np.random.default_rng(seed)
    data = range_bearing(rng, n_robots, 4, 3) if seed % 2 else information_data(rng, 3 * n_robots, 3)
    links = n_robots * (n_robots - 1) // 2
    protected = frozenset(i for i in range(n_robots) if protect and rng.random() < 0.3)
    owners = np.repeat(np.arange(n_robots), 3)
    budgets = int(rng.integers(0, n_robots)), int(rng.integers(0, links + 1))
    weights = rng.uniform(0.2, 3, len(data[0])) if seed % 4 == 0 else None
    problem = ro.Problem(OBJECTIVES[name](*data, weights), owners, None, *budgets, protected)
    return problem, random_elements(rng, problem)


def run_large(problem, elements, max_nodes=None):
    """The large-team search, also where ``worst_case_attack`` would use the one for small teams."""
    first = ro.bounded_rational_attack(problem, elements).attack
    return searched("size vectors", problem, elements, first, max_nodes=max_nodes)


@pytest.mark.parametrize("name", OBJECTIVES)
@pytest.mark.parametrize("seed", range(25))
@pytest.mark.parametrize("way", ["as it is", "families", "bounded lists", "branches"])
def test_agrees_with_the_threshold_search(name, seed, way, monkeypatch):
    """As it is; by lists and a search for disjoint sets; by lists that are cut down by bounds; by branches with hardly
    any search in depth."""
    if way == "branches":
        go(monkeypatch, NO_LISTS)
    if way in {"families", "bounded lists"}:
        go(monkeypatch, FAMILIES)
    if way == "bounded lists":
        go(monkeypatch, {(AttackParams, "families.few_sets"): 10, (AttackParams, "family_exchanges.shaken"): 0})
    problem, elements = team_problem(seed, 4 + seed % 6, name, protect=seed % 3 == 0)
    expected = worst_value(problem, elements)
    bracket, _, stop = run_large(problem, elements)
    assert bracket.upper == pytest.approx(expected, rel=2e-10, abs=1e-12)
    assert bracket.lower <= expected + 1e-12
    assert bracket.upper - bracket.lower <= 1.1e-10 * abs(bracket.upper) + 1e-12
    assert stop is ro.Stop.CLOSED
    assert attained(problem, elements, bracket) == bracket.upper


@pytest.mark.parametrize("name", OBJECTIVES)
@pytest.mark.parametrize("blinded", [0, 2])
def test_many_equal_groups_close(name, blinded):
    """The class of budgets between the paper's: several groups of the same size, hardly anybody blinded."""
    rng = np.random.default_rng(blinded)
    n_robots = 14 + blinded
    data = range_bearing(rng, n_robots, 6, 1)
    groups = 14 * 3 // 2 + 2 * blinded
    links = n_robots * (n_robots - 1) // 2
    problem = ro.Problem(OBJECTIVES[name](*data), np.arange(n_robots), None, blinded, links - groups)
    result = ro.worst_case_attack(problem, np.arange(n_robots), time_limit=60)
    assert result.stop is ro.Stop.CLOSED
    assert result.upper - result.lower <= 1e-9 * result.upper
    assert result.upper <= ro.greedy_attack(problem, np.arange(n_robots)).upper


@pytest.mark.parametrize("name", OBJECTIVES)
@pytest.mark.parametrize("seed", [1, 2])
@pytest.mark.parametrize("limits", [(), (NO_LISTS,), (FAMILIES,)])
def test_the_bracket_is_valid_at_every_node_count(name, seed, limits, monkeypatch):
    go(monkeypatch, *limits)
    go(monkeypatch, {(AttackParams, "disjoint.nodes_of_look"): 3})
    problem, elements = team_problem(seed, 8, name)
    problem = ro.Problem(problem.objective, problem.robot, None, 2, 9)
    expected = worst_value(problem, elements)
    _, nodes, _ = run_large(problem, elements)
    previous = 0.0
    for limit in [*range(min(nodes, 150)), nodes, nodes + 1]:
        bracket, used, stop = run_large(problem, elements, limit)
        assert used <= limit
        assert bracket.lower <= expected * (1 + 1e-12) + 1e-12
        assert bracket.upper >= expected * (1 - 2e-10)
        assert bracket.lower >= previous
        previous = bracket.lower
        assert (stop is ro.Stop.NODES) == (limit < nodes)


@pytest.mark.parametrize("name", OBJECTIVES)
def test_a_team_of_twenty_closes_and_is_beaten_by_no_local_search(name):
    rng = np.random.default_rng(5)
    problem = ro.Problem(OBJECTIVES[name](*range_bearing(rng, 20, 20)), np.repeat(np.arange(20), 12), None, 10, 63)
    plan = ro.ratt(problem).elements
    result = ro.worst_case_attack(problem, plan)
    assert result.stop is ro.Stop.CLOSED
    assert result.upper - result.lower <= 1e-9 * result.upper
    assert result.upper <= ro.greedy_attack(problem, plan).upper
    weakest = min(problem.objective(plan[rng.choice(20, 7, replace=False)]) for _ in range(3000))
    assert result.lower <= weakest
    again = ro.worst_case_attack(problem, plan)
    assert (again.attack, again.nodes) == (result.attack, result.nodes)


def test_everyone_blinded():
    rng = np.random.default_rng(0)
    problem = ro.Problem(OBJECTIVES["trace"](*range_bearing(rng, 14, 2, 1)), np.arange(14), None, 14, 3)
    result = ro.worst_case_attack(problem, np.arange(14))
    assert (result.lower, result.upper, result.stop) == (0.0, 0.0, ro.Stop.CLOSED)


@pytest.mark.parametrize("calls", range(1, 6))
def test_an_interrupt_returns_the_bracket_reached(calls, monkeypatch):
    """Wherever the interrupt lands: at the first bound, deep in the tree, or never."""
    go(monkeypatch, NO_LISTS)
    rng = np.random.default_rng(2)
    problem = ro.Problem(OBJECTIVES["trace"](*range_bearing(rng, 13, 4, 1)), np.arange(13), None, 3, 20)
    expected = ro.worst_case_attack(problem, np.arange(13))
    assert expected.stop is ro.Stop.CLOSED
    asked = interrupted_at(calls, Budget.spend)
    monkeypatch.setattr(Budget, "spend", asked)
    result = ro.worst_case_attack(problem, np.arange(13))
    assert result.stop is (ro.Stop.INTERRUPTED if asked.calls >= calls else ro.Stop.CLOSED)
    assert result.lower <= expected.upper <= result.upper * (1 + 1e-9)
    assert attains(problem, np.arange(13), result)
