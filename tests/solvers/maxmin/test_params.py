"""Parameters of the search for best plans: passed down, read from TOML, refused if a search could not go on."""

from functools import cache
from typing import Any

import numpy as np
import pytest

import ratt_opt as ro
from ratt_opt import MaxMinParams
from ratt_opt.solvers.maxmin import params as plan_params
from ratt_opt.solvers.maxmin.params import AT_LEAST_ONE
from tests.extremes import places, value_at, with_one
from tests.solvers.by_values.test_rows import OwnSum
from tests.solvers.maxmin.engine import NO_PLANS_LISTED
from tests.ways import go


@cache
def team(seed: int = 0) -> ro.Problem:
    return ro.limited_view_scenario(4, 5, alpha_s=1, alpha_c=2, seed=seed).problem("logdet")


@cache
def best_value(seed: int = 0) -> float:
    return ro.exhaustive_optimum(team(seed)).lower


def extreme(value: Any, *, least: bool) -> Any:
    """The smallest value that a parameter may have, or one that is huge for it."""
    if isinstance(value, tuple):
        return (0.0,) if least else (0.0, *value, 0.99)
    return type(value)(0 if least else 20 * value + 1)


PLACES = places(MaxMinParams())


def check_at_extremes(place: str, problem: ro.Problem, best: float, **limits: Any) -> None:
    """Whatever one parameter is, the search ends and its bracket holds the best plan of all."""
    value = value_at(MaxMinParams(), place)
    for least in (True, False):
        try:
            params = with_one(MaxMinParams(), place, extreme(value, least=least))
        except ro.InputError:
            assert place in AT_LEAST_ONE
            continue
        found = ro.solve_maxmin(problem, params=params, **limits)
        assert found.lower <= best * (1 + 1e-9)
        assert found.upper >= best * (1 - 1e-9)


@pytest.mark.parametrize("place", PLACES)
def test_no_parameter_changes_what_is_claimed(place: str) -> None:
    check_at_extremes(place, team(), best_value(), max_nodes=4, time_limit=0.5)


BY_VALUES = {
    "value_checks",
    "first_plans",
    "value_walk",
    "value_turns",
    "part_bounds",
    "part_rows",
    "regions",
    "row_tree",
}


@cache
def own_team() -> tuple[ro.Problem, float]:
    """Five robots and a sum of parts of one's own, and its best worst case."""
    f = ro.FacilityLocation(np.random.default_rng(0).random((15, 6)))
    problem = ro.Problem(f, np.repeat(np.arange(5), 3), None, 1, 2)
    return problem, ro.exhaustive_optimum(problem).lower


@cache
def exchangeable_team() -> tuple[ro.Problem, float]:
    """Four robots that choose among the same six sites, two of them lost, and its best worst case."""
    f = ro.FacilityLocation(np.tile(np.random.default_rng(0).random((6, 6)), (4, 1)))
    problem = ro.Problem(f, np.repeat(np.arange(4), 6), None, 2, 0)
    return problem, ro.exhaustive_optimum(problem).lower


@cache
def team_of_own_parts() -> tuple[ro.Problem, float]:
    """Four robots and a sum of one's own, and its best worst case."""
    f = OwnSum(np.random.default_rng(0).random((12, 4)) < 0.7)
    problem = ro.Problem(f, np.repeat(np.arange(4), 3), None, 1, 0)
    return problem, ro.exhaustive_optimum(problem).lower


TEAMS = {"regions": exchangeable_team, "part_bounds": team_of_own_parts}


@pytest.mark.parametrize("place", [place for place in PLACES if place.split(".")[0] in BY_VALUES])
def test_no_parameter_changes_what_is_claimed_of_functions_by_values(
    place: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    problem, best = TEAMS.get(place.split(".", maxsplit=1)[0], own_team)()
    go(monkeypatch, NO_PLANS_LISTED)
    check_at_extremes(place, problem, best, max_nodes=2, time_limit=0.1)


def test_parameters_that_are_passed_are_used(monkeypatch: pytest.MonkeyPatch) -> None:
    few = with_one(MaxMinParams(), "outcomes.robots", 0)
    listed: list[int] = []
    plain = ro.solvers.maxmin.outcome_pool.OutcomePool.list_all

    def list_all(pool: Any, params: Any) -> None:
        listed.append(params.robots)
        plain(pool, params)

    monkeypatch.setattr(ro.solvers.maxmin.outcome_pool.OutcomePool, "list_all", list_all)
    ro.solve_maxmin(team(), params=few, max_nodes=1)
    ro.solve_maxmin(team(), max_nodes=1)
    assert listed == [0, plan_params.DEFAULT.outcomes.robots]


@pytest.mark.parametrize(("place", "value"), [("walk.back", 0), ("levels.runs", 0), ("restarts.growth", 0.5)])
def test_what_a_search_cannot_go_on_with_is_refused(place: str, value: float) -> None:
    with pytest.raises(ro.InputError, match=rf"params.{place} must be at least 1; got {value}"):
        with_one(MaxMinParams(), place, value)


def test_a_search_without_the_level_of_the_best_plan_is_refused() -> None:
    with pytest.raises(ro.InputError, match="must hold 0"):
        with_one(MaxMinParams(), "levels.shares", ())


def test_the_values_of_a_plan_do_not_depend_on_parameters() -> None:
    problem = team(1)
    found = ro.solve_maxmin(problem, params=with_one(MaxMinParams(), "walk.back", 3))
    assert np.array_equal(found.elements, problem.check_plan(found.elements))
    assert found.stop is ro.Stop.CLOSED
