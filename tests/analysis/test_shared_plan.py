"""No better planner of these kinds: instances on which all planners agree on a plan that no exchange mends."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction
from itertools import combinations

import numpy as np
import pytest

from analysis.ratios.shared_plan import exchange_gain, shared_plan_ratio
from ratt_opt import Problem, TableFunction, exhaustive_optimum, ratt, worst_case_attack, worst_case_ratio
from ratt_opt.worst_ratio.families import shared_plan_instance
from ratt_opt.worst_ratio.witness import PLANNERS, RatioQuestion, replay


def question(n, alpha_s, curvature, family="nondecreasing"):
    return RatioQuestion(n_robots=n, alpha_s=alpha_s, alpha_c=0, curvature=Fraction(curvature), family=family)


@pytest.mark.parametrize(("n", "alpha_s"), [(3, 1), (4, 2)])
def test_the_best_of_three_planners_is_no_better_than_ratt(n, alpha_s):
    found = shared_plan_ratio(question(n, alpha_s, "1/4"), range(n))
    alone = worst_case_ratio(n, alpha_s, 0, curvature="1/4", family="nondecreasing")
    assert found.lower == found.upper == alone.exact_upper
    plans = {tuple(plan(found.witness.problem()).elements) for plan in PLANNERS.values()}
    assert len(plans) == 1


@pytest.mark.parametrize("size", [1, 2, 3])
def test_three_planners_agree_on_a_plan_that_tends_to_the_pattern_free_bound(size):
    witness, k = shared_plan_instance(size, Fraction(1, 3)), Fraction(1, 3)
    for planner in PLANNERS:
        assert replay(replace(witness, planner=planner)) == (1 + (size - 1) * (1 - k)) / size
    assert len({tuple(plan(witness.problem()).elements) for plan in PLANNERS.values()}) == 1


def test_nor_is_exchanging_one_robot():
    """N = 6, four blinded: two pairs of bait robots are equally bad, so one of them stays."""
    found = shared_plan_ratio(question(6, 4, "1/4"), (0, 2, 4, 5, 1, 3), attacks=[(0b000011,), (0b001100,)])
    alone = worst_case_ratio(6, 4, 0, curvature="1/4", family="nondecreasing")
    assert found.upper == alone.exact_upper == Fraction(3, 4)
    for planner, plan in PLANNERS.items():
        assert replay(replace(found.witness, planner=planner)) == Fraction(3, 4)
        assert exchange_gain(found.witness.problem(), plan(found.witness.problem()).elements) == 0


@pytest.mark.parametrize(("n", "exchanged"), [(2, 1), (4, 1), (5, 1), (3, 2), (4, 2)])
def test_a_plan_that_no_exchange_mends_can_keep_nothing(n, exchanged):
    """As many robots may be blinded as are exchanged; every robot has a useless and a useful control."""
    table = np.bitwise_count(np.arange(1 << 2 * n) >> n).astype(float)
    problem = Problem(TableFunction(table), np.tile(np.arange(n), 2), None, exchanged, 0)
    useless = np.arange(n)
    assert worst_case_attack(problem, useless).upper == exchange_gain(problem, useless) == 0
    for changed in combinations(range(n), exchanged):
        plan = useless.copy()
        plan[list(changed)] += n
        assert worst_case_attack(problem, plan).upper == 0
    assert exhaustive_optimum(problem).lower == n - exchanged


def test_an_exchange_that_helps_is_found():
    table = np.array([0.0, 1, 0, 1, 3, 4, 3, 4])
    problem = Problem(TableFunction(table), np.array([0, 1, 0]), None, 0, 0)
    assert exchange_gain(problem, np.array([0, 1])) == 2
    assert exchange_gain(problem, ratt(problem).elements) == 0
