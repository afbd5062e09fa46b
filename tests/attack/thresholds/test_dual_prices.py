"""The exact attacker of larger teams on any graph, run on teams small enough for the definition or a table."""

import networkx as nx
import numpy as np
import pytest

import ratt_opt as ro
from ratt_opt.attack.thresholds.dual_prices import ThresholdDecision
from ratt_opt.attack.thresholds.threshold_search import Answer, Threshold
from ratt_opt.budget import Budget
from tests.attack.engine import Search, searched
from tests.brackets import assert_closed, worst_value
from tests.oracles import brute_force_worst_case
from tests.strategies import team_problem


def run_prices(problem, plan, **limits):
    """The search itself, whatever ``worst_case_attack`` would choose for this team."""
    bracket, _, stop = searched("annealed attacks and dual prices", problem, plan, **limits)
    return bracket, stop


@pytest.mark.parametrize("seed", range(60))
def test_against_the_definition(seed):
    problem, plan = team_problem(seed, 3 + seed % 4)
    bracket, stop = run_prices(problem, plan)
    assert stop is ro.Stop.CLOSED
    assert_closed(problem, plan, bracket, brute_force_worst_case(problem, plan))


@pytest.mark.parametrize("seed", range(8))
def test_against_a_table_of_thresholds(seed):
    families = (nx.gnp_random_graph(13, 0.4, seed=seed), nx.watts_strogatz_graph(13, 4, 0.2, seed=seed))
    problem, plan = team_problem(seed, 13, graph=families[seed % 2])
    bracket, stop = run_prices(problem, plan, time_limit=60)
    assert stop is ro.Stop.CLOSED
    assert_closed(problem, plan, bracket, worst_value(problem, plan))


@pytest.mark.parametrize("n_robots", [1, 2, 5])
@pytest.mark.parametrize("seed", range(3))
def test_where_nothing_can_be_attacked_no_group_is_weak(n_robots, seed):
    problem, plan = team_problem(seed, n_robots, graph=nx.path_graph(n_robots))
    links = [(i, i + 1) for i in range(n_robots - 1)]
    safe = ro.Problem(problem.objective, problem.robot, problem.graph, n_robots, len(links), range(n_robots), links)
    bracket, stop = run_prices(safe, plan)
    assert stop is ro.Stop.CLOSED
    assert_closed(safe, plan, bracket, problem.objective(plan))


@pytest.mark.parametrize("nodes", [0, 1, 100, 2_000])
def test_a_bracket_that_is_stopped_is_valid(nodes):
    problem, plan = team_problem(1, 13, graph=nx.gnp_random_graph(13, 0.5, seed=1))
    exact = worst_value(problem, plan)
    bracket, _ = run_prices(problem, plan, max_nodes=nodes)
    assert bracket.lower <= exact * (1 + 1e-12)
    assert exact <= bracket.upper * (1 + 1e-12)


@pytest.mark.parametrize("seed", range(5))
@pytest.mark.parametrize("seconds", [2.0, 3.0, 7.0])
def test_thresholds_are_within_reach_of_the_seconds_left(seed, seconds, monkeypatch):
    """Each refutation takes a second; the last step is a small one, as one that does not end proves nothing."""
    problem, plan = team_problem(seed, 5)
    clock, asked = [0.0], []

    def decide(_decision, threshold, _budget, _nodes):
        asked.append(threshold)
        clock[0] += 1.0
        return Answer(verdict=Threshold.REFUTED)

    budget = Budget(time_limit=seconds)
    monkeypatch.setattr(ThresholdDecision, "decide", decide)
    checked, start = Budget.__post_init__, budget.started

    def begin(part):
        checked(part)
        part.started = start + clock[0]

    monkeypatch.setattr(Budget, "__post_init__", begin)
    monkeypatch.setattr("ratt_opt.budget.monotonic", lambda: start + clock[0])
    search = Search("dual prices", problem, plan)
    assert search.run(budget) is ro.Stop.TIME
    steps = np.diff([0.0, *asked]) / (search.bracket.upper - np.array([0.0, *asked[:-1]]))
    assert len(asked) == seconds
    assert steps[0] == pytest.approx(0.5)
    assert steps[-1] == pytest.approx(0.25)
