"""Attacks by branch and bound on functions known by their values: against the definition, in pieces, on large teams."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import ratt_opt as ro
from ratt_opt.budget import Budget
from tests.attack.engine import AttackMemory, Search, open_nodes, share_of_attacks
from tests.oracles import brute_force_worst_case
from tests.strategies import SEEDED, Opaque, Submodular, information_data, team_problem
from tests.test_own_criterion import RootObjective
from tests.ways import go

DONE = {ro.Stop.CLOSED, ro.Stop.EXHAUSTED}
LIMITED = {ro.Stop.TIME, ro.Stop.EVALUATIONS, *DONE}


@pytest.mark.parametrize("limit", ["nodes", "evaluations"])
@pytest.mark.parametrize("most", [1, 6, 10_000])
@pytest.mark.parametrize("seed", range(12))
def test_against_the_definition_in_pieces(seed, most, limit, monkeypatch):
    """However a piece ends no attack is lost, and the bracket is valid: teams, graphs and what is protected drawn."""
    go(monkeypatch, open_nodes(most))
    problem, plan = team_problem(seed, 3 + seed % 4)
    truth, known = brute_force_worst_case(problem, plan), {}
    tree = Search("branch and bound", problem, plan)
    bracket = tree.bracket
    least = 1 if limit == "nodes" else 8  # values that dividing one node may take
    for piece in range(20_000):
        budget = Budget(**{f"max_{limit}": least + piece % 3})
        tree.meter(budget, known if limit == "evaluations" else None)
        if tree.run(budget) in DONE:
            break
        assert bracket.lower <= truth * (1 + 1e-9) + 1e-10
        assert bracket.upper >= truth * (1 - 1e-9) - 1e-10
    assert bracket.is_closed
    assert bracket.upper == pytest.approx(truth, rel=2e-10, abs=1e-10)
    assert problem.team_value(plan, bracket.attack) == bracket.upper


def network(robots, seed, family="disk-6", **budgets):
    """A team on a network whose trace criterion is known by its values alone, RATT's plan, and the team as it is."""
    scenario = ro.network_scenario(family, robots, 3, alpha_s=1, alpha_c=2, seed=seed)
    problem = replace(scenario.problem(), **budgets)
    return replace(problem, objective=Opaque(problem.objective)), ro.ratt(problem).elements, problem


@pytest.mark.parametrize("robots", [21, 30])
@pytest.mark.parametrize("seed", range(2))
def test_large_teams_close_as_the_criterion_does(robots, seed):
    """Once 58.6 were proved of 87.6, whatever the limit."""
    problem, plan, as_it_is = network(robots, seed)
    found, truth = ro.worst_case_attack(problem, plan, max_evaluations=100_000), ro.worst_case_attack(as_it_is, plan)
    assert found.stop is ro.Stop.CLOSED
    assert found.upper == pytest.approx(truth.upper, rel=1e-9)
    assert found.lower == pytest.approx(truth.lower, rel=1e-9)


@settings(SEEDED, max_examples=5)
@given(st.integers(21, 40), st.integers(0, 99), st.sampled_from(["disk-6", "dense", "hubs"]), st.integers(0, 3000))
def test_nothing_ends_before_its_values_are_spent(robots, seed, family, most):
    """Attacks, best plans, and links, of teams beyond enumeration, with one plan or a few."""
    problem, plan, _ = network(robots, seed, family, alpha_s=robots // 4, alpha_c=robots)
    single = ro.Problem(Submodular(problem.objective.f), problem.robot, problem.graph, 2, 3)
    one = ro.Problem(ro.Modular(np.arange(float(robots))), np.arange(robots), problem.graph, 2, 3)
    for team, chosen in (problem, plan), (single, plan), (one, np.arange(robots)):
        hidden = replace(team, objective=Opaque(team.objective))
        assert ro.worst_case_attack(hidden, chosen, max_evaluations=most).stop in LIMITED
        assert ro.solve_maxmin(hidden, max_evaluations=most).stop in LIMITED


@pytest.mark.parametrize("share", [0.2, 0.0])
@pytest.mark.parametrize("seed", range(2))
def test_links_of_functions_known_by_their_values_are_chosen_until_the_time_is_up(seed, share, monkeypatch):
    """Also where the first attacks have no time to begin their trees."""
    go(monkeypatch, share_of_attacks(share))
    problem, plan, as_it_is = network(24, seed, alpha_s=5, alpha_c=11)
    for search, candidates in (ro.links_to_add, [(0, 1), (2, 3), (4, 5)]), (ro.links_to_protect, as_it_is.graph.edges):
        free = [link for link in candidates if search is ro.links_to_protect or not as_it_is.graph.has_edge(*link)]
        found = search(problem, plan, 1, candidates=free, time_limit=1)
        assert found.stop in LIMITED
        assert found.before.lower <= ro.worst_case_attack(as_it_is, plan).upper * (1 + 1e-9)


def test_an_attack_that_another_search_asks_for_again_goes_on():
    problem, plan, _ = network(24, 0)
    memory, outer = AttackMemory(), Budget(max_evaluations=100_000)
    brief = ro.worst_case_attack(problem, plan, budget=outer, memory=memory, brief=True)
    again = ro.worst_case_attack(problem, plan, budget=outer, memory=memory, brief=True)
    assert brief.stop is ro.Stop.HEURISTIC
    assert again.stop is ro.Stop.CLOSED
    assert again.lower > brief.lower


def test_a_budget_changes_no_stage():
    problem, plan, _ = network(24, 0)
    alone = ro.worst_case_attack(problem, plan, max_evaluations=100_000)
    inside = ro.worst_case_attack(problem, plan, budget=Budget(max_evaluations=100_000))
    assert alone.stop is ro.Stop.CLOSED
    assert inside == alone
    assert [row.name for row in inside.stages] == [row.name for row in alone.stages]


@pytest.mark.parametrize("robots", [21, 30])
def test_attacks_on_criteria_of_one_s_own_go_on_while_there_is_time(robots):
    prior, information = information_data(np.random.default_rng(robots), robots, 2, 3)
    graph = ro.network_scenario("disk-6", robots, 3, alpha_s=0, alpha_c=0, seed=0).problem().graph
    problem = ro.Problem(RootObjective(prior, information), np.arange(robots), graph, 1, 3)
    assert ro.worst_case_attack(problem, np.arange(robots), time_limit=1).stop in LIMITED
