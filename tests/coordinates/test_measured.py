"""Coordinates that nothing measures are left out: values, attacks and plans stay, and proofs are of all coordinates."""

import numpy as np
import pytest

import ratt_opt as ro
from tests.strategies import OBJECTIVES

POSITION = np.eye(2, 4)


def spd(rng, count, d):
    factors = rng.normal(size=(count, d, d))
    return factors @ np.swapaxes(factors, -1, -2) + 0.3 * np.eye(d)


def measured_team(seed, kind="trace", *, doppler=False, d=4, turned=False, **more):
    """Six elements of three robots about two targets; the sensors tell of two coordinates, Doppler ones of three."""
    rng = np.random.default_rng([seed, 383])
    n_targets, rows = 2, POSITION[:, :d] if d <= 4 else np.eye(2, d)
    if doppler:
        rows = np.eye(3, d)
    if turned:
        rows = rows @ np.linalg.qr(rng.normal(size=(d, d)))[0]
    seen = spd(rng, 6 * n_targets, len(rows)).reshape(6, n_targets, len(rows), len(rows))
    seen[rng.random((6, n_targets)) < 0.3] = 0
    information = rows.T @ seen @ rows
    objective = OBJECTIVES[kind](spd(rng, n_targets, d), information, rng.uniform(0.5, 2.0, n_targets), **more)
    return ro.Problem(objective, [0, 0, 1, 1, 2, 2], None, 1, 1)


def assert_same_values(problem, reduced, rng, count):
    members = rng.random((count, problem.objective.n)) < 0.5
    assert reduced.objective.evaluate(members) == pytest.approx(
        problem.objective.evaluate(members), rel=1e-10, abs=1e-10
    )


@pytest.mark.parametrize("case", range(100))
def test_values_stay_in_ten_thousand_cases(case):
    rng = np.random.default_rng([case, 38])
    kind, d = ("trace", "logdet")[case % 2], int(rng.integers(3, 7))
    more = {"output": rng.normal(size=(int(rng.integers(1, d + 1)), d))} if case % 4 == 2 else {}
    problem = measured_team(case, kind, d=d, turned=case % 3 == 0, **more)
    reduced = ro.measured_coordinates(problem)
    assert reduced.objective.dimension == 2
    assert_same_values(problem, reduced, rng, 100)


@pytest.mark.parametrize("kind", ["trace", "logdet"])
@pytest.mark.parametrize("turned", [False, True])
def test_the_best_plan_and_its_certificate_are_of_the_problem_that_was_given(kind, turned, tmp_path):
    problem = measured_team(3, kind, turned=turned)
    best, found = ro.exhaustive_optimum(problem), ro.solve_maxmin(problem)
    assert found.lower == pytest.approx(best.lower, rel=1e-9)
    assert found.upper == pytest.approx(best.lower, rel=1e-8)
    assert all(cut.point.shape == (2, 4, 4) for cut in found.proof.cuts)
    stated = ro.certify(problem, found, tmp_path / "proof.json")
    assert stated.verified.lower_proved
    assert stated.upper_raised <= 1e-7 * found.upper
    assert stated.lower_shaved <= 1e-7 * found.lower
    again = ro.solve_maxmin(problem, start=found)
    assert again.lower == pytest.approx(best.lower, rel=1e-9)


@pytest.mark.parametrize("kind", ["trace", "logdet"])
def test_attacks_stay(kind):
    problem = measured_team(5, kind)
    reduced = ro.measured_coordinates(problem)
    plan = [0, 3, 4]
    attack = ro.worst_case_attack(reduced, plan)
    assert problem.team_value(plan, attack.attack) == pytest.approx(attack.upper, rel=1e-10)
    assert ro.worst_case_attack(problem, plan).upper == pytest.approx(attack.upper, rel=1e-10)


@pytest.mark.parametrize("kind", ["trace", "logdet"])
def test_a_doppler_sensor_keeps_its_dimension(kind):
    assert ro.measured_coordinates(measured_team(1, kind, doppler=True)).objective.dimension == 3
    whole = measured_team(1, kind, doppler=True, d=3)
    reduced = ro.measured_coordinates(whole)
    assert reduced.objective is whole.objective
    assert not reduced.is_smaller


def test_one_target_that_is_measured_whole_keeps_all_coordinates():
    information = np.zeros((1, 2, 3, 3))
    information[0, 0], information[0, 1, 0, 0] = np.eye(3), 1.0
    problem = ro.Problem(ro.TraceObjective([np.eye(3)] * 2, information), [0], None, 0, 0)
    assert not ro.measured_coordinates(problem).is_smaller
    information[0, 0, 2, 2] = 0
    fewer = ro.measured_coordinates(ro.Problem(ro.TraceObjective([np.eye(3)] * 2, information), [0], None, 0, 0))
    assert fewer.objective.dimension == 2
    assert fewer.objective([0]) == pytest.approx(1.5)


def test_without_any_information_one_coordinate_is_left_and_worth_nothing():
    problem = ro.Problem(ro.TraceObjective([np.eye(4)], np.zeros((2, 1, 4, 4))), [0, 1], None, 1, 0)
    reduced = ro.measured_coordinates(problem)
    assert reduced.objective.dimension == 1
    assert reduced.objective([0, 1]) == 0
    found = ro.solve_maxmin(problem)
    assert found.stop is ro.Stop.CLOSED
    assert found.lower == 0 <= found.upper < 1e-11


def test_the_largest_eigenvalue_keeps_what_is_not_measured():
    assert not ro.measured_coordinates(measured_team(2, "maxeig")).is_smaller
    positions = measured_team(2, "maxeig", output=POSITION)
    reduced = ro.measured_coordinates(positions)
    assert reduced.objective.dimension == 2
    assert_same_values(positions, reduced, np.random.default_rng(0), 64)
    found = ro.solve_maxmin(positions)
    assert found.upper == pytest.approx(ro.exhaustive_optimum(positions).lower, rel=1e-8)
    assert not ro.measured_coordinates(measured_team(2, "maxeig", output=np.eye(1, 4, 3))).is_smaller


def test_an_output_that_no_measurement_tells_of_leaves_the_problem_as_it_is():
    information = np.zeros((1, 1, 4, 4))
    information[..., 0, 0] = 1.0
    objective = ro.TraceObjective([np.eye(4)], information, output=np.eye(1, 4, 3))
    assert not ro.measured_coordinates(ro.Problem(objective, [0], None, 0, 0)).is_smaller


@pytest.mark.parametrize(("noise", "dimension"), [(1e-15, 2), (1e-6, 4)])
def test_rounding_is_no_measurement_and_a_weak_measurement_is_one(noise, dimension):
    problem = measured_team(7)
    objective = problem.objective
    noisy = objective.with_information(objective.information + noise * np.eye(4))
    changed = ro.Problem(noisy, problem.robot, None, 1, 1)
    assert ro.measured_coordinates(changed).objective.dimension == dimension


def test_what_is_no_criterion_is_refused():
    with pytest.raises(ro.InputError, match="objective must be a criterion of information matrices"):
        ro.measured_coordinates(ro.Problem(ro.Modular([1.0]), [0], None, 0, 0))
