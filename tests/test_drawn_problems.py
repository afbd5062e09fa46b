"""The headline claims on problems drawn by Hypothesis: round numbers, ties, useless robots, any graph and budget."""

import pytest
from hypothesis import HealthCheck, given, settings

import ratt_opt as ro
from tests.brackets import attains
from tests.oracles import brute_force_optimum, brute_force_outcomes, brute_force_worst_case
from tests.strategies import SEEDED, monotone_tables, problems, problems_with_plans

DRAWN = settings(SEEDED, suppress_health_check=[HealthCheck.too_slow, HealthCheck.data_too_large])


def scale_of(problem):
    """What rounding is measured by: the value of everything."""
    return max(1.0, abs(problem.objective(range(problem.objective.n))))


@DRAWN
@given(problems_with_plans(controls=2))
def test_the_worst_case_is_that_of_all_raw_attacks(given_plan):
    problem, elements = given_plan
    result = ro.worst_case_attack(problem, elements)
    expected = brute_force_worst_case(problem, elements)
    assert result.lower - 1e-9 * scale_of(problem) <= expected <= result.upper + 1e-9 * scale_of(problem)
    assert result.upper == pytest.approx(expected, abs=1e-9 * scale_of(problem))
    assert attains(problem, elements, result)


@DRAWN
@given(problems(controls=2))
def test_the_bracket_of_the_optimum_holds_and_closes(problem):
    result = ro.solve_maxmin(problem)
    expected, rounding = brute_force_optimum(problem), 1e-7 * scale_of(problem)
    assert result.lower - rounding <= expected <= result.upper + rounding
    assert brute_force_worst_case(problem, result.elements) >= result.lower - rounding
    assert result.upper - result.lower <= rounding


@DRAWN
@given(problems(controls=2))
def test_exhaustive_search_finds_the_optimum(problem):
    result = ro.exhaustive_optimum(problem)
    assert 0 <= result.upper - result.lower <= 3 * problem.evaluation_error
    assert result.upper == pytest.approx(brute_force_optimum(problem), abs=1e-9 * scale_of(problem))


@DRAWN
@given(problems(kind="logdet", controls=1))
def test_outcomes_are_those_of_all_raw_attacks_that_no_other_refines(problem):
    assert {frozenset(o) for o in ro.non_dominated_outcomes(problem.threat)} == brute_force_outcomes(problem)


@DRAWN
@given(monotone_tables(4))
def test_monotone_tables_have_no_violation_and_a_bracketed_total_curvature(values):
    f = ro.TableFunction(values)
    assert ro.find_monotonicity_violation(f) is None
    found = ro.total_curvature(f)
    assert 0 <= found.lower <= found.upper <= 1


@DRAWN
@given(problems(n_robots=3, controls=2))
def test_ratt_keeps_what_the_guarantees_promise(problem):
    plan = ro.ratt(problem)
    kept = brute_force_worst_case(problem, plan.elements)
    c = ro.total_curvature(problem.objective, problem.robot)
    promised = ro.pattern_free_bound(c=min(max(c.upper, 0.0), 1.0)) * brute_force_optimum(problem)
    assert kept >= promised - 1e-9 * scale_of(problem)
