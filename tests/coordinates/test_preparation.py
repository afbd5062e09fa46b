"""One door: public searches prepare a problem, write nothing into it, and their ends hold the exact values tightly."""

import gc
import weakref
from dataclasses import replace

import numpy as np
import pytest

import ratt_opt as ro
from ratt_opt.budget import Budget
from ratt_opt.coordinates.preparation import prepared, restored
from tests.exact_values import ExactValues, holds
from tests.strategies import OBJECTIVES

pytestmark = pytest.mark.usefixtures("exact_balls")

PLAN = np.array([0, 2, 4, 6])
TIGHT = 1e-6
"""Widest bracket, as a share of the plan's value without attacks: rounding of ten digits, no more."""


def tracks(seed, kind="trace", digits=9):
    """Four robots of two elements that measure positions of tracks; the prior's variances lie so many digits apart."""
    rng = np.random.default_rng([seed, digits, 65])
    d, targets = 4, 2
    turns = np.linalg.qr(rng.normal(size=(targets, d, d)))[0] if seed % 2 else np.stack([np.eye(d)] * targets)
    prior = (turns * 10.0 ** rng.permuted(np.linspace(0, digits, d))) @ np.swapaxes(turns, -1, -2)
    rows = rng.normal(size=(8, targets, 2, 2)) * 10.0 ** rng.uniform(-2, 1, (8, targets, 1, 1))
    information = np.eye(2, d).T @ (np.swapaxes(rows, -1, -2) @ rows) @ np.eye(2, d)
    output = {"output": np.eye(2, d)} if kind == "maxeig" else {}
    prior, information = ((x + np.swapaxes(x, -1, -2)) / 2 for x in (prior, information))
    return ro.Problem(OBJECTIVES[kind](prior, information, **output), np.repeat(np.arange(4), 2), None, 1, 1)


@pytest.mark.parametrize("kind", ["trace", "logdet", "maxeig"])
@pytest.mark.parametrize("digits", [0, 4, 8])
@pytest.mark.parametrize("seed", range(2))
def test_attacks_are_as_tight_as_measured_coordinates_allow(kind, digits, seed):
    problem = tracks(seed, kind, digits)
    exact, whole = ExactValues(problem), problem.objective(PLAN)
    for attack in (ro.worst_case_attack, ro.bounded_rational_attack):
        found = attack(problem, PLAN)
        if attack is ro.worst_case_attack:
            assert holds(found.lower, exact.worst_case(PLAN), found.upper)
            assert found.upper - found.lower <= TIGHT * whole
        left = exact.team(PLAN, found.attack)
        assert holds(-np.inf, left, found.upper)
        assert float(found.upper - left) <= TIGHT * whole


def test_no_search_writes_into_the_problem():
    problem = tracks(1)
    before = dict(vars(problem))
    ro.worst_case_attack(problem, PLAN)
    ro.solve_maxmin(problem)
    ro.exhaustive_optimum(problem)
    ro.refined(problem, time_limit=None, max_kicks=1)
    ro.links_to_protect(problem, PLAN, 1)
    own = {name for name, kind in vars(ro.Problem).items() if hasattr(kind, "attrname")}  # its cached properties
    assert {name: value for name, value in vars(problem).items() if name not in own - set(before)} == before


def test_the_prepared_problem_is_made_once_and_freed():
    problem = tracks(1)
    searched = prepared(problem)
    assert searched is not problem
    assert prepared(problem) is searched is prepared(searched)
    assert prepared(replace(searched, alpha_s=0)).objective is searched.objective
    gone = weakref.ref(problem), weakref.ref(searched), weakref.ref(problem.objective)
    del problem, searched
    gc.collect()
    assert [ref() for ref in gone] == [None] * 3


def test_a_problem_in_good_coordinates_and_a_function_of_ones_own_stay_themselves():
    rng = np.random.default_rng(0)
    rows = rng.normal(size=(2, 1, 2, 2))
    good = ro.Problem(ro.TraceObjective([np.eye(2)], rows @ np.swapaxes(rows, -1, -2)), [0, 1], None, 1, 0)
    own = ro.Problem(ro.Modular([1.0, 2.0]), [0, 1], None, 1, 0)
    assert (prepared(good), prepared(own)) == (good, own)
    found = ro.solve_maxmin(good)
    assert restored(good, found) is found


def test_changed_coordinates_keep_how_many_robots_may_choose():
    problem = tracks(1)
    information = problem.objective.information.copy()
    information[::2] = 0
    limited = ro.Problem(problem.objective.with_information(information), problem.robot, None, 1, 0, at_most=2)
    searched = prepared(limited)
    assert searched is not limited
    assert searched.at_most == 2
    assert searched.idle.tolist() == limited.idle.tolist() == [0, 2, 4, 6]
    best = ro.exhaustive_optimum(limited)
    assert (best.elements % 2).sum() <= 2


def test_a_budget_changes_no_stage():
    for seed in range(3):
        problem = tracks(seed)
        alone, inside = (ro.worst_case_attack(problem, PLAN, budget=b) for b in (None, Budget()))
        assert [s.name for s in alone.stages] == [s.name for s in inside.stages]
        assert (alone.lower, alone.upper, alone.attack) == (inside.lower, inside.upper, inside.attack)
        alone, inside = (ro.solve_maxmin(problem, budget=b) for b in (None, Budget()))
        assert (alone.lower, alone.upper, alone.nodes) == (inside.lower, inside.upper, inside.nodes)
