"""Any budget, any limit, any input: brackets are valid, closed where plans are few, and never empty."""

import time

import networkx as nx
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import ratt_opt as ro
from tests.brackets import attains
from tests.oracles import brute_force_optimum, brute_force_worst_case
from tests.strategies import (
    OBJECTIVES,
    SEEDED,
    degenerate_networks,
    degenerate_problems,
    information_data,
    problems_with_plans,
)

DONE = {ro.Stop.CLOSED, ro.Stop.EXHAUSTED, ro.Stop.GAP}


@SEEDED
@given(problems_with_plans(), st.sampled_from([0, 1e-6, 1e-3]))
def test_any_limit_leaves_a_valid_bracket(drawn_pair, limit):
    problem, plan = drawn_pair
    attack = ro.worst_case_attack(problem, plan, time_limit=limit)
    worst = brute_force_worst_case(problem, plan)
    assert attack.lower <= worst + 1e-9 * abs(worst) + 1e-12
    assert attack.upper >= worst - 1e-9 * abs(worst) - 1e-12
    assert attains(problem, plan, attack)
    found = ro.solve_maxmin(problem, time_limit=limit)
    assert found.lower <= brute_force_worst_case(problem, found.elements) * (1 + 1e-9) + 1e-9


@SEEDED
@given(degenerate_problems())
def test_ties_zeros_and_extremes_close(problem):
    """An optimum of 0, two equal elements, a value slightly negative by rounding: once each an endless loop."""
    found = ro.solve_maxmin(problem, time_limit=60)
    best = brute_force_optimum(problem)
    searched = ro.measured_coordinates(problem)
    slack = 1e-9 * abs(best) + 10 * problem.objective.rounding + 2 * searched.evaluation_error
    assert found.stop in DONE
    assert found.lower <= best + slack
    assert found.upper >= best - slack
    assert found.upper - found.lower <= slack


@settings(SEEDED, max_examples=25)
@given(degenerate_networks(), st.sampled_from([0.0, 0.02, 0.1]))
def test_a_bracket_that_is_closed_says_so(problem, limit):
    """Whatever ended the search: where the first bounds met, thresholds were decided until the time was up."""
    found = ro.worst_case_attack(problem, ro.myopic(problem).elements, time_limit=limit)
    width = max(1e-10 * abs(found.upper), problem.objective.rounding) + 2 * problem.evaluation_error
    width += 4 * np.spacing(abs(found.upper))  # each end was moved, and rounded
    assert (found.stop in DONE) == (found.lower >= found.upper - width)


@pytest.mark.parametrize("name", OBJECTIVES)
@pytest.mark.parametrize("kind", ["useless", "identical", "line"])
def test_larger_degenerate_teams_close(name, kind):
    rng = np.random.default_rng(3)
    prior, information = information_data(rng, 30, 3, 2)
    v = rng.normal(size=(30, 3, 2))
    shapes = {
        "useless": np.zeros_like(information),
        "identical": np.repeat(information[:1], 30, axis=0),
        "line": v[..., :, None] * v[..., None, :],
    }
    problem = ro.Problem(OBJECTIVES[name](prior, shapes[kind]), np.repeat(np.arange(15), 2), None, 3, 40)
    attack = ro.worst_case_attack(problem, ro.ratt(problem).elements, time_limit=60)
    assert attack.stop is ro.Stop.CLOSED
    assert ro.solve_maxmin(problem, time_limit=60).stop in DONE


@pytest.mark.parametrize("graph", ["complete", "ring", "random"])
@pytest.mark.parametrize("n_robots", [6, 9, 12, 14, 30, 70])
def test_what_is_known_at_once_is_not_empty(n_robots, graph):
    rng = np.random.default_rng(n_robots)
    graphs = {
        "complete": None,
        "ring": nx.cycle_graph(n_robots),
        "random": nx.gnp_random_graph(n_robots, 0.6, seed=1),
    }
    prior, information = information_data(rng, 2 * n_robots, 4, 2)
    owners = np.repeat(np.arange(n_robots), 2)
    problem = ro.Problem(OBJECTIVES["trace"](prior, information), owners, graphs[graph], 2, 5)
    attack = ro.worst_case_attack(problem, ro.ratt(problem).elements, time_limit=0)
    assert 0 < attack.lower <= attack.upper
    found = ro.solve_maxmin(problem, time_limit=0)
    assert 0 < found.lower <= found.upper <= problem.objective(range(problem.objective.n)) * (1 + 1e-12)


@pytest.mark.parametrize("budget", [(0, 80), (3, 70), (0, 60)])
def test_limits_are_kept_where_groups_are_many(budget):
    """In processor time, which a busy machine does not stretch."""
    problem = ro.random_scenario(20, 12, alpha_s=budget[0], alpha_c=2 * budget[1], seed=1).problem()
    plan = ro.ratt(problem).elements
    ro.worst_case_attack(problem, plan, time_limit=1)  # loads modules
    for limit in (0.1, 0.5):
        began = time.process_time()
        ro.worst_case_attack(problem, plan, time_limit=limit)
        assert time.process_time() - began <= 1.05 * limit + 0.5
