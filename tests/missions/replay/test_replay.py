"""Real data: the noise law comes back from drawn errors; the dataset replayed under attack."""

from dataclasses import replace
from itertools import combinations
from pathlib import Path

import numpy as np
import pytest

from ratt_opt import (
    InputError,
    MaxMinPlanner,
    Problem,
    ReplaySettings,
    TraceObjective,
    fit_sensor,
    load_scenario,
    random_scenario,
    read_mrclam,
    replay_mrclam,
    save_scenario,
    worst_case_attack,
)
from ratt_opt.missions.players.planners import elements_of, get_planner
from ratt_opt.missions.replay.fit_sensor import mrclam_residuals
from tests.strategies import information_data

REAL = Path(__file__).resolve().parents[4] / "shared" / "data" / "mrclam"
real = pytest.mark.skipif(not REAL.is_dir(), reason="the dataset is not here")


def drawn(law: str, outliers: float, n: int = 20_000):
    rng = np.random.default_rng(0)
    distance, bearing = rng.uniform(1, 9, n), rng.uniform(-0.6, 0.6, n)
    of_range, of_bearing = 0.02 + 0.04 * distance, 0.01 + 0.02 * np.abs(bearing)
    if law == "variance":
        of_range, of_bearing = np.sqrt(of_range), np.sqrt(of_bearing)
    errors = rng.standard_normal((2, n)) * [of_range, of_bearing]
    wrong = rng.random(n) < outliers
    errors[:, wrong] = rng.uniform(-3, 3, (2, wrong.sum()))
    return (distance, bearing, *errors), wrong


@pytest.mark.parametrize("law", ["std", "variance"])
@pytest.mark.parametrize("outliers", [0.0, 0.1])
def test_the_law_comes_back(law: str, outliers: float) -> None:
    given, wrong = drawn(law, outliers)
    found = fit_sensor(*given)
    assert found.law == law
    assert found.outliers == pytest.approx(outliers, abs=0.01)
    variances = found.noise_variances(np.array([2.0, 8.0]), np.array([0.1, 0.5]))
    expected = np.array([0.1, 0.34]), np.array([0.012, 0.02])
    for estimate, truth in zip(variances, expected, strict=True):
        np.testing.assert_allclose(estimate, truth**2 if law == "std" else truth, rtol=0.08)
    if outliers:
        of_range, of_bearing = found.noise_variances(given[0], given[1])
        refused = given[2] ** 2 / of_range + given[3] ** 2 / of_bearing > found.gate
        assert refused[wrong].mean() > 0.5
        assert refused[~wrong].mean() < 0.01


def test_a_fitted_sensor_is_a_scenarios(tmp_path) -> None:
    found = fit_sensor(*drawn("std", 0.0, 500)[0])
    scenario = random_scenario(2, 2, alpha_s=0, alpha_c=0, seed=0, sensor=found)
    save_scenario(scenario, tmp_path / "s.json")
    again = load_scenario(tmp_path / "s.json")
    assert np.array_equal(again.information, scenario.information)


def test_bad_residuals() -> None:
    with pytest.raises(InputError, match="residuals must be of one length, at least 20"):
        fit_sensor(*[np.ones(19)] * 4)
    with pytest.raises(InputError, match="residuals must be of one length"):
        fit_sensor(np.ones(30), np.ones(31), np.ones(30), np.ones(30))
    with pytest.raises(InputError, match="bearing must be finite"):
        fit_sensor(np.ones(30), np.full(30, np.nan), np.ones(30), np.ones(30))


def camera_problem(rng, n_robots=5):
    prior, about = information_data(rng, n_robots, 3)
    information = np.zeros((2 * n_robots, *about.shape[1:]))
    information[1::2] = about
    return Problem(TraceObjective(prior, information), np.repeat(np.arange(n_robots), 2), None, 1, 3)


@pytest.mark.parametrize("name", ["ratt", "greedy", "myopic", "maxmin", "refined"])
@pytest.mark.parametrize("count", [0, 2, 5])
def test_so_many_cameras_run(name: str, count: int) -> None:
    problem = replace(camera_problem(np.random.default_rng(1)), at_most=count)
    plan = elements_of(get_planner(name)(problem), problem)
    assert plan.tolist() == [2 * i + plan[i] % 2 for i in range(5)]
    assert (plan % 2).sum() == count


@pytest.mark.parametrize("seed", range(5))
def test_the_max_min_choice_is_best_of_all_sets(seed: int) -> None:
    problem = replace(camera_problem(np.random.default_rng(seed)), at_most=3)
    plan = elements_of(get_planner("maxmin")(problem), problem)
    best = max(
        worst_case_attack(problem, [2 * i + (i in running) for i in range(5)]).upper
        for running in combinations(range(5), 3)
    )
    assert worst_case_attack(problem, plan).upper >= best * (1 - MaxMinPlanner().gap)


def test_cameras_are_greedy_where_nobody_attacks() -> None:
    problem = replace(camera_problem(np.random.default_rng(2)), at_most=3)
    f, chosen = problem.objective, []
    for _ in range(3):
        rest = [e for e in range(1, 10, 2) if e not in chosen]
        chosen.append(max(rest, key=lambda e: f([*chosen, e])))
    assert sorted(e for e in get_planner("greedy")(problem).elements if e % 2) == sorted(chosen)


@real
def test_the_dataset_replayed() -> None:
    data = read_mrclam(REAL)
    middle = float(np.mean([poses[:, 0].mean() for poses in data.poses]))
    sensor = fit_sensor(mrclam_residuals(data, until=middle))
    later = fit_sensor(mrclam_residuals(data, since=middle))
    assert sensor.law == later.law == "std"
    assert sensor.range_noise_slope == pytest.approx(later.range_noise_slope, rel=0.15)
    assert 0.03 < sensor.range_noise_slope < 0.06
    settings = ReplaySettings(drift_std=0.03)
    free = replay_mrclam(REAL, steps=12, attacker="none", sensor=sensor, settings=settings)
    hit = replay_mrclam(REAL, steps=12, sensor=sensor, settings=settings)
    assert free == replay_mrclam(REAL, steps=12, attacker="none", sensor=sensor, settings=settings)
    assert free.rmse[-1] < free.rmse[0]
    assert all(len(step.running) == 3 for step in hit.steps)
    assert all(len(step.attack.sensing) <= 1 and len(step.attack.links) <= 2 for step in hit.steps)
    assert sum(step.used for step in hit.steps) < sum(step.used for step in free.steps)
    for steps in (10_000, 10**400):
        with pytest.raises(InputError, match="steps must end before the poses do"):
            replay_mrclam(REAL, steps=steps, sensor=sensor)
    with pytest.raises(InputError, match=r"cameras must be an integer in \[0, 5\]; got 6"):
        replay_mrclam(REAL, steps=1, sensor=sensor, settings=ReplaySettings(cameras=6))
    assert fit_sensor(REAL) == fit_sensor(data)


@pytest.mark.parametrize(
    ("change", "text"),
    [
        ({"cameras": -1}, "cameras must be an integer >= 0"),
        ({"cameras": True}, "cameras must be an integer >= 0"),
        ({"seed": -1}, "seed must be an integer >= 0"),
        ({"prior_std": 1e300}, "prior_std must be at most"),
        ({"start": float("nan")}, "start must be a finite number >= 0"),
    ],
)
def test_bad_settings_are_refused(change: dict[str, object], text: str) -> None:
    with pytest.raises(InputError, match=text):
        ReplaySettings(**change)


def test_a_replay_of_something_else_is_refused(tmp_path) -> None:
    for arguments, text in (({"settings": 7}, "settings must be"), ({"sensor": 7}, "sensor must be a FittedSensor")):
        with pytest.raises(InputError, match=text):
            replay_mrclam(tmp_path, steps=1, **arguments)
    with pytest.raises(InputError, match="Landmark_Groundtruth"):
        fit_sensor(tmp_path)
