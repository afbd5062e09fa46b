"""Robots to protect against all sets of k, and budgets asked in metres."""

from dataclasses import replace
from itertools import combinations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from ratt_opt import (
    InputError,
    Stop,
    breaking_budgets,
    random_scenario,
    ratt,
    robots_to_protect,
    solve_maxmin,
    worst_case_attack,
)


@settings(max_examples=10)
@given(seed=st.integers(0, 10_000), alpha_s=st.integers(0, 3), alpha_c=st.integers(0, 3), k=st.integers(0, 3))
def test_the_best_robots_are_those_of_all_sets(seed: int, alpha_s: int, alpha_c: int, k: int) -> None:
    problem = random_scenario(6, 3, alpha_s=alpha_s, alpha_c=alpha_c, seed=seed).problem()
    plan = ratt(problem).elements
    found = robots_to_protect(problem, plan, k)
    values = [
        worst_case_attack(replace(problem, protected_robots=frozenset(robots)), plan).lower
        for robots in combinations(range(6), k)
    ]
    assert found.stop is Stop.CLOSED
    assert found.lower == pytest.approx(max(values), rel=1e-9, abs=1e-9)
    assert found.upper == pytest.approx(max(values), rel=1e-9, abs=1e-9)
    assert len(found.robots) <= k
    again = worst_case_attack(replace(problem, protected_robots=frozenset(found.robots)), plan)
    assert again.lower == pytest.approx(found.lower, rel=1e-9, abs=1e-9)


def test_without_time_the_bracket_is_wide_and_true() -> None:
    problem = random_scenario(8, 3, alpha_s=3, alpha_c=0, seed=1).problem()
    plan = ratt(problem).elements
    short, full = robots_to_protect(problem, plan, 3, time_limit=0.0), robots_to_protect(problem, plan, 3)
    assert short.lower <= full.lower <= full.upper <= short.upper + 1e-9
    assert short.stop is Stop.TIME


def test_budgets_are_asked_in_metres() -> None:
    """An attack of these budgets leaves an RMS above the one asked for; one link or robot fewer does not."""
    scenario = random_scenario(5, 3, alpha_s=1, alpha_c=1, seed=4)
    scenario = scenario.replace(
        targets=[t.replace(weight=w) for t, w in zip(scenario.targets, (1.0, 2.0, 0.5), strict=True)]
    )
    problem = scenario.problem()
    plan = ratt(problem).elements
    weights = np.array([1.0, 2.0, 0.5])

    def rms(attack):
        stronger = replace(problem, alpha_s=len(attack.sensing), alpha_c=len(attack.links))
        group = sorted(stronger.best_group(plan, attack))
        information = np.linalg.inv(scenario.prior) + scenario.information[plan[group]].sum(axis=0)
        traces = np.trace(np.linalg.inv(information), axis1=-2, axis2=-1)
        return float(np.sqrt(weights @ traces / weights.sum()))

    whole = rms(type(worst_case_attack(problem, plan).attack)())
    found = breaking_budgets(problem, plan, rms=1.05 * whole)
    assert found
    for one in found:
        assert rms(one.attack) > 1.05 * whole
    with pytest.raises(InputError, match="value must be given, or rms"):
        breaking_budgets(problem, plan)
    with pytest.raises(InputError, match="rms needs the trace"):
        breaking_budgets(scenario.problem("logdet"), plan, rms=1.0)


def test_budgets_against_a_team_that_plans_anew() -> None:
    """Each pair breaks the plan made against it, not the one made against a link fewer; best plans last longest."""
    problem = random_scenario(5, 3, alpha_s=1, alpha_c=1, seed=4).problem()
    fixed = ratt(problem)
    goal = 0.6 * worst_case_attack(problem, fixed).lower

    def value(alpha_s, alpha_c):
        stronger = replace(problem, alpha_s=alpha_s, alpha_c=alpha_c)
        return worst_case_attack(stronger, ratt(stronger)).lower

    found = breaking_budgets(problem, ratt, goal)
    assert found
    for one in found:
        assert value(one.alpha_s, one.alpha_c) < goal
        assert one.alpha_c == 0 or value(one.alpha_s, one.alpha_c - 1) >= goal
    best = {one.alpha_s: one.alpha_c for one in breaking_budgets(problem, solve_maxmin, goal)}
    for one in breaking_budgets(problem, fixed, goal):
        assert all(links >= one.alpha_c for robots, links in best.items() if robots == one.alpha_s)
