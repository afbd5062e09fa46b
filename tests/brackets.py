"""Brackets of attacks: published ends are those computed, moved apart by what computing them may have rounded."""

import pytest

import ratt_opt as ro


def attained(problem, plan, result):
    """What the result's attack leaves of the plan, as computed."""
    return problem.team_value(plan, result.attack)


def worst_value(problem, plan):
    """What the worst attack leaves of the plan, as computed."""
    return attained(problem, plan, ro.worst_case_attack(problem, plan))


def attains(problem, plan, result):
    """Whether the result's upper end is what its attack leaves; 0 is exact where no robot tells anything."""
    value = attained(problem, plan, result)
    is_nothing = value == 0.0 and not problem.has_information(problem.check_plan(plan), result.attack)
    return result.upper == (0.0 if is_nothing else problem.widen_by_rounding(0.0, value)[1])


def is_exact(problem, plan, result):
    """Whether both ends are what its attack leaves."""
    value = attained(problem, plan, result)
    return result.lower == problem.widen_by_rounding(value, value)[0] and attains(problem, plan, result)


def assert_closed(problem, plan, bracket, expected):
    """Both ends are what is expected, and the attack attains the upper one."""
    assert bracket.upper == pytest.approx(expected, rel=2e-10, abs=1e-10)
    assert bracket.lower == pytest.approx(expected, rel=2e-10, abs=1e-10)
    assert problem.team_value(plan, bracket.attack) == bracket.upper


def assert_search_closed(problem, elements, bracket, stop, expected):
    """A search ended because its bracket closed at what is expected."""
    assert stop is ro.Stop.CLOSED
    assert bracket.upper == pytest.approx(expected, rel=2e-10, abs=1e-12)
    assert bracket.lower <= expected * (1 + 1e-12) + 1e-12
    assert bracket.upper - bracket.lower <= 1.1e-10 * abs(bracket.upper) + 1e-12
    assert problem.team_value(elements, bracket.attack) == bracket.upper
