"""Refined plans: never worse than RATT's, with a true bracket, and mostly the best where teams are small."""

from itertools import product

import numpy as np
import pytest

from ratt_opt import (
    Attack,
    InputError,
    Plan,
    Problem,
    RefinedPlanner,
    TableFunction,
    limited_view_scenario,
    ratt,
    refined,
    run_mission,
    solve_maxmin,
)
from tests.oracles import brute_force_worst_case
from tests.strategies import random_problem

KINDS = ("trace", "logdet", "maxeig")


@pytest.mark.parametrize("kind", KINDS)
def test_never_worse_than_ratt_and_the_bracket_is_true(kind: str):
    best = 0
    for seed in range(40):
        problem = random_problem(np.random.default_rng([seed, 7]), kind=kind)
        scale = max(1e-3, problem.objective(range(problem.objective.n)))
        found = refined(problem, time_limit=None, max_kicks=10)
        own = brute_force_worst_case(problem, found.elements)
        assert found.lower - 1e-9 * scale <= own <= found.upper + 1e-9 * scale
        assert own >= brute_force_worst_case(problem, ratt(problem).elements) - 1e-9 * scale
        assert found.unattacked == pytest.approx(problem.team_value(found.elements, Attack()))
        plans = product(*(choice.tolist() for choice in problem.choices))
        optimum = max(brute_force_worst_case(problem, np.array(plan)) for plan in plans)
        best += own >= optimum - 1e-9 * scale
    assert best >= 38


@pytest.mark.parametrize("time_limit", [0, 0.01, 0.1])
def test_any_time_is_enough_for_ratts_plan(time_limit: float):
    problem = limited_view_scenario(8, 8, alpha_s=2, alpha_c=6, seed=3, communication_range=45).problem()
    found = refined(problem, time_limit=time_limit)
    first = ratt(problem)
    assert found.lower <= found.upper
    at_least = solve_maxmin(problem, start=first, time_limit=10)
    assert found.upper <= at_least.upper * (1 + 1e-9) or np.array_equal(found.elements, first.elements)


def test_the_same_kicks_give_the_same_plan_and_more_are_no_worse():
    problem = limited_view_scenario(8, 8, alpha_s=2, alpha_c=6, seed=3, communication_range=45).problem()
    plans = [refined(problem, time_limit=None, max_kicks=kicks, seed=1) for kicks in (0, 5, 5, 40)]
    assert plans[1] == plans[2]
    assert plans[0].lower <= plans[1].lower <= plans[3].lower
    assert isinstance(plans[0], Plan)


def test_a_good_start_is_kept():
    problem = limited_view_scenario(6, 8, alpha_s=2, alpha_c=4, seed=4, communication_range=45).problem()
    best = solve_maxmin(problem)
    found = refined(problem, start=best.elements, time_limit=None, max_kicks=0)
    assert found.lower == pytest.approx(best.lower)


def test_what_it_cannot_take_is_refused_by_name():
    problem = limited_view_scenario(4, 4, alpha_s=1, alpha_c=1, seed=0).problem()
    with pytest.raises(InputError, match="time_limit"):
        refined(problem, time_limit=-1)
    with pytest.raises(InputError, match="max_kicks"):
        refined(problem, max_kicks=-1)
    with pytest.raises(InputError, match="elements"):
        refined(problem, start=[0])
    own = Problem(TableFunction(np.array([0.0, 1.0])), [0], None, 0, 0)
    with pytest.raises(InputError, match="elements"):
        refined(own, start=[1])
    with pytest.raises(InputError, match="max_kicks"):
        refined(own, max_kicks=-1)


def test_missions_are_planned_by_it_and_are_the_same_again():
    scenario = limited_view_scenario(5, 5, alpha_s=1, alpha_c=2, seed=0, communication_range=45)
    flights = [run_mission(scenario, steps=3, planner=planner, seed=1) for planner in ("refined", RefinedPlanner())]
    assert [step.value for step in flights[0].steps] == [step.value for step in flights[1].steps]


def test_ties_go_to_the_plan_that_is_worth_more_without_attack():
    richer = 0
    for seed in range(30):
        scenario = limited_view_scenario(4, 5, alpha_s=1, alpha_c=2, seed=seed, headings=4, communication_range=45)
        problem = scenario.problem()
        found = solve_maxmin(problem)
        unattacked = problem.team_value(found.elements, Attack())
        assert found.unattacked == pytest.approx(unattacked)
        for i, choice in enumerate(problem.choices):
            for e in choice.tolist():
                other = found.elements.copy()
                other[i] = e
                value = problem.team_value(other, Attack())
                if value > unattacked * (1 + 1e-6):
                    richer += 1
                    assert brute_force_worst_case(problem, other) < found.lower * (1 - 1e-9)
    assert richer > 20
