"""Agents in real processes make the plans of the simulation."""

import networkx as nx
import numpy as np
import pytest

import ratt_opt as ro
from ratt_opt.decentralised.processes import ProcessParams, plan_in_processes
from tests.decentralised.teams import team


def test_four_processes_make_ratts_plan():
    problem = team(np.random.default_rng(5), 4, objective="trace")
    plan, known = plan_in_processes(problem), ro.ratt(problem)
    assert list(plan.elements) == list(known)
    assert plan.bait == known.bait
    assert plan.components == ((0, 1, 2, 3),)


@pytest.mark.slow
def test_ten_processes_plan_within_two_seconds_once_connected():
    scenario = ro.limited_view_scenario(10, 8, alpha_s=2, alpha_c=3, seed=1)
    for graph in (None, nx.cycle_graph(10), nx.path_graph(10)):
        problem = ro.Problem(scenario.problem().objective, scenario.problem().robot, graph, 2, 3)
        plan = plan_in_processes(problem)
        assert list(plan.elements) == list(ro.ratt(problem))
        assert plan.seconds < 2.0


def test_a_killed_process_leaves_ratts_plans_of_what_is_left():
    problem = team(np.random.default_rng(8), 4, objective="logdet")
    path = ro.Problem(problem.objective, problem.robot, nx.path_graph(4), 1, 1)
    plan = plan_in_processes(path, killed=(1,))
    simulated = ro.decentralised_ratt(path, faults=ro.Faults(crashed=((0, 1),)))
    assert plan.elements[1] is None
    assert [plan.elements[i] for i in (0, 2, 3)] == [list(simulated)[i] for i in (0, 2, 3)]
    assert plan.components == ((0,), (1,), (2, 3))


@pytest.mark.slow
def test_a_process_of_another_version_is_left_out():
    problem = team(np.random.default_rng(8), 4, objective="logdet")
    path = ro.Problem(problem.objective, problem.robot, nx.path_graph(4), 1, 1)
    plan = plan_in_processes(path, versions={1: 99})
    simulated = ro.decentralised_ratt(path, faults=ro.Faults(crashed=((0, 1),)))
    assert plan.components == ((0,), (1,), (2, 3))
    assert [plan.elements[i] for i in (0, 2, 3)] == [list(simulated)[i] for i in (0, 2, 3)]


def test_too_many_processes_are_refused():
    with pytest.raises(ro.InputError, match="n_robots"):
        plan_in_processes(team(np.random.default_rng(0), 5), params=ProcessParams(most_robots=4))


def test_a_limit_that_is_too_short_is_said():
    with pytest.raises(ro.InputError, match="seconds"):
        plan_in_processes(team(np.random.default_rng(0), 2), params=ProcessParams(seconds=0.0))
