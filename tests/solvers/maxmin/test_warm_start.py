"""Searches that start from an earlier plan or result: the same claims as without, in less work."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from ratt_opt import InputError, Scenario, exhaustive_optimum, greedy, random_scenario, solve_maxmin
from tests.solvers.maxmin.proofs import proved_upper
from tests.strategies import OBJECTIVES, random_problem


def moved(scenario: Scenario, plan: np.ndarray) -> Scenario:
    """The scenario one period later, each robot having carried out its element of the plan."""
    poses = scenario.predicted_poses[plan]
    robots = [
        robot.replace(x=float(x), y=float(y), heading=float(np.arctan2(np.sin(angle), np.cos(angle))))
        for robot, (x, y, angle) in zip(scenario.robots, poses.tolist(), strict=True)
    ]
    targets = [
        target.replace(x=float(x), y=float(y), heading=target.heading + scenario.sampling_period * target.turn_rate)
        for target, (x, y) in zip(scenario.targets, scenario.predicted_targets.tolist(), strict=True)
    ]
    return scenario.replace(robots=tuple(robots), targets=tuple(targets))


@settings(max_examples=25, deadline=None)
@given(st.integers(0, 10**6), st.sampled_from(list(OBJECTIVES)))
def test_whatever_it_starts_from_the_optimum_is_the_same(seed: int, kind: str) -> None:
    """Also from the result of another problem: other links, budgets, numbers of targets or controls."""
    rng = np.random.default_rng([8, seed])
    robots = int(rng.integers(1, 6))
    problem, other = (random_problem(rng, robots, kind=kind, controls=4) for _ in range(2))
    expected = exhaustive_optimum(problem).lower
    scale = max(1.0, abs(expected))
    for start in (solve_maxmin(other), solve_maxmin(problem), greedy(problem), greedy(problem).elements):
        result = solve_maxmin(problem, start=start)
        assert result.lower == pytest.approx(expected, abs=1e-8 * scale)
        assert result.upper == pytest.approx(expected, abs=1e-8 * scale)
        if result.proof is not None:
            assert proved_upper(problem, result.proof) <= result.upper + 1e-10 * scale


@pytest.mark.parametrize("kind", OBJECTIVES)
@pytest.mark.parametrize(("robots", "alpha_s", "alpha_c"), [(10, 3, 11), (14, 5, 26)])
def test_a_step_on_from_a_result_the_brackets_agree(kind: str, robots: int, alpha_s: int, alpha_c: int) -> None:
    scenario = random_scenario(robots, 5, alpha_s=alpha_s, alpha_c=alpha_c, seed=2)
    before = solve_maxmin(scenario.problem(kind), gap=1e-6)
    for _ in range(2):
        scenario = moved(scenario, before.elements)
        problem = scenario.problem(kind)
        cold, warm = solve_maxmin(problem, gap=1e-6), solve_maxmin(problem, gap=1e-6, start=before)
        assert max(cold.lower, warm.lower) <= min(cold.upper, warm.upper) * (1 + 1e-12)
        assert warm.upper - warm.lower <= 1e-6 * warm.upper * (1 + 1e-9)
        assert warm.proof is not None
        assert proved_upper(problem, warm.proof) <= warm.upper * (1 + 1e-10)
        before = warm


def test_a_plan_that_is_none_is_refused() -> None:
    problem = random_scenario(4, 3, alpha_s=1, alpha_c=2, seed=17).problem()
    with pytest.raises(InputError, match="elements"):
        solve_maxmin(problem, start=[0, 0, 0, 0])
