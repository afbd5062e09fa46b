"""Several steps ahead: the joint criterion is the Kalman filter run step by step; dropped sequences cost nothing."""

from dataclasses import replace
from itertools import product

import numpy as np
import pytest

from ratt_opt import (
    Attack,
    InputError,
    MissionModel,
    random_scenario,
    ratt,
    run_mission,
    solve_maxmin,
    worst_case_attack,
)
from ratt_opt.missions.beam import beam_sequences, solve_by_columns
from ratt_opt.missions.players.attack_models import RenewedAttacks
from ratt_opt.missions.world import World
from tests.oracles import brute_force_worst_case


def world_of(  # noqa: PLR0917
    horizon,
    output="mean",
    motion="known velocity",
    n_robots=3,
    seed=1,
    controls=((1.0, 0.0), (3.0, 1.0), (-3.0, 3.0)),
    objective="trace",
):
    scenario = random_scenario(n_robots, 3, alpha_s=1, alpha_c=min(2, n_robots - 1), seed=seed, controls=controls)
    return World(scenario, MissionModel(motion=motion, output=output, objective=objective), horizon)


def problem_of(world):
    scenario = world.scenario
    offered = world.sequences(scenario.poses)
    objective, kept = world.objective(world.motion.initial(scenario), offered, 0.0)
    return world.problem(
        objective, kept.owner, scenario.poses, RenewedAttacks().threatened(0, Attack(), scenario)
    ), kept


def largest(covariances) -> float:
    return float(np.linalg.eigvalsh(covariances)[..., -1].max())


@pytest.mark.parametrize("objective", ["trace", "maxeig"])
@pytest.mark.parametrize("motion", ["known velocity", "constant velocity", "coordinated turn"])
@pytest.mark.parametrize("horizon", [1, 2, 3])
def test_the_last_step_is_the_kalman_filters(motion: str, horizon: int, objective: str) -> None:
    world = world_of(horizon, "last", motion, objective=objective)
    problem, kept = problem_of(world)
    plan = np.array([choice[len(choice) // 2] for choice in problem.choices])
    belief = first = world.motion.initial(world.scenario)
    ahead = []
    for h in range(horizon):
        first = first.predicted(world.motion, world.period, float(h))
        ahead.append(first)
    covariance = belief.covariance
    for h, predicted in enumerate(ahead):
        # Linearised where the plan does: at what is predicted before any measurement.
        state = belief.mean if h == 0 else ahead[h - 1].mean
        F = world.motion.transition(state, world.period)
        covariance = F @ covariance @ F.swapaxes(-1, -2) + world.motion.noise(world.period)
        for i, element in enumerate(plan):
            here = kept.poses[element : element + 1, h]
            about = world.sensors[i].information(here, predicted.positions, predicted.position_covariance)[0]
            whole = np.zeros_like(covariance)
            whole[:, :2, :2] = about
            covariance = np.linalg.inv(np.linalg.inv(covariance) + whole)
    before, after = ahead[-1].covariance[:, :2, :2], covariance[:, :2, :2]
    if objective == "trace":
        expected = before.trace(axis1=1, axis2=2).sum() - after.trace(axis1=1, axis2=2).sum()
    else:
        expected = largest(before) - largest(after)
    assert problem.objective(plan) == pytest.approx(expected, rel=1e-8)


def test_the_worst_axis_of_all_steps() -> None:
    """Of the errors of all steps together, over their number: between that of the worst step and as much of it."""
    problem, _ = problem_of(world_of(2, "mean", objective="maxeig"))
    f = problem.objective
    plan = [choice[1] for choice in problem.choices]
    covariance = np.linalg.inv(np.linalg.inv(f.prior) + f.information[plan].sum(axis=0))
    assert f(plan) == pytest.approx((largest(f.prior) - largest(covariance)) / 2)
    steps = [largest(covariance[:, 2 * h : 2 * h + 2, 2 * h : 2 * h + 2]) for h in range(2)]
    assert max(steps) / 2 <= f.prior_criterion - f(plan) <= max(steps) * (1 + 1e-9)


def test_the_mean_is_that_of_the_steps() -> None:
    """Without process noise a later measurement improves an earlier estimate; the last of both outputs agree."""
    problem, _ = problem_of(world_of(2, "mean"))
    f = problem.objective
    plan = [choice[1] for choice in problem.choices]
    covariance = np.linalg.inv(np.linalg.inv(f.prior) + f.information[plan].sum(axis=0))
    change = (f.prior - covariance).reshape(3, 2, 2, 2, 2)
    expected = sum(np.trace(change[:, h, :, h], axis1=1, axis2=2).sum() for h in range(2)) / 2
    assert f(plan) == pytest.approx(expected)


def test_one_step_of_the_first_order_is_the_scenarios_problem() -> None:
    scenario = world_of(1).scenario
    problem, _ = problem_of(World(scenario, MissionModel(linearisation="first order"), 1))
    today = scenario.problem()
    assert type(problem.objective) is type(today.objective)
    assert np.array_equal(problem.objective.prior, today.objective.prior)
    assert np.array_equal(problem.objective.information, today.objective.information)


@pytest.mark.parametrize("objective", ["trace", "maxeig"])
@pytest.mark.parametrize("seed", range(3))
def test_worst_attacks_over_two_steps(seed: int, objective: str) -> None:
    problem, _ = problem_of(world_of(2, "mean", "constant velocity", seed=seed, objective=objective))
    plan = ratt(problem).elements
    assert worst_case_attack(problem, plan).upper == pytest.approx(brute_force_worst_case(problem, plan), rel=1e-9)


@pytest.mark.parametrize("objective", ["trace", "maxeig"])
def test_the_optimum_over_two_steps_is_that_of_all_plans(objective: str) -> None:
    world = world_of(2, n_robots=2, controls=((1.0, 0.0), (3.0, 1.0)), objective=objective)
    problem, _ = problem_of(world)
    best = max(brute_force_worst_case(problem, plan) for plan in product(*(c.tolist() for c in problem.choices)))
    found = solve_maxmin(problem)
    assert found.lower == pytest.approx(best, rel=1e-8)
    assert found.upper == pytest.approx(best, rel=1e-7)


@pytest.mark.parametrize("output", ["mean", "last"])
def test_missions_look_ahead_for_the_worst_axis(output: str) -> None:
    world = world_of(2, output, objective="maxeig")
    mission = run_mission(world.scenario, steps=3, horizon=2, model=world.model)
    assert len(mission.steps) == 3
    with pytest.raises(InputError, match="objective must be trace or maxeig if a plan looks several steps ahead"):
        world_of(2, objective="logdet")


@pytest.mark.parametrize("objective", ["logdet", "maxeig"])
def test_one_step_of_moving_targets_takes_any_criterion(objective: str) -> None:
    """Velocities are not measured: the criterion of the position is that of the position's block of a Kalman filter."""
    scenario = random_scenario(3, 3, alpha_s=1, alpha_c=2, seed=1)
    world = World(scenario, MissionModel(motion="constant velocity", objective=objective), 1)
    problem, kept = problem_of(world)
    plan = np.array([choice[0] for choice in problem.choices])
    predicted = world.motion.initial(scenario).predicted(world.motion, world.period, 0.0)
    information = np.zeros((3, 4, 4))
    for e in plan:
        spread = predicted.position_covariance
        information[:, :2, :2] += world.sensors[0].information(kept.poses[e], predicted.positions, spread)[0]
    after = np.linalg.inv(np.linalg.inv(predicted.covariance) + information)[:, :2, :2]
    before = predicted.position_covariance
    if objective == "logdet":
        expected = np.linalg.slogdet(before)[1].sum() - np.linalg.slogdet(after)[1].sum()
    else:
        expected = np.linalg.eigvalsh(before).max() - np.linalg.eigvalsh(after).max()
    assert problem.objective(plan) == pytest.approx(expected, rel=1e-9)


def test_dropping_loses_no_value() -> None:
    from ratt_opt import Sensor
    from ratt_opt.missions.ahead.horizon import control_sequences

    sensor = Sensor(bearing_noise_slope=0.0)
    scenario = random_scenario(
        2, 2, alpha_s=0, alpha_c=0, seed=3, sensor=sensor, controls=((1.0, 0.0), (1.0, 1.0), (3.0, 0.0))
    )
    world = World(scenario, MissionModel(), 2)
    offered = control_sequences(scenario, scenario.poses, 2, world.move, 20_000)
    problem, kept = problem_of(world)
    assert len(kept.owner) < len(offered.owner)  # the last turn moves nothing: ties
    everything = world.criterion(world.motion.initial(scenario), offered, 0.0)
    best = max(everything([a, 9 + b]) for a in range(9) for b in range(9))
    assert max(problem.objective([a, b]) for a in problem.choices[0] for b in problem.choices[1]) == pytest.approx(best)


@pytest.mark.parametrize("seed", range(3))
def test_columns_bracket_the_optimum_over_all_elements(seed: int) -> None:
    problem, _ = problem_of(world_of(2, "mean", seed=seed))
    whole = solve_maxmin(problem)
    start = np.array([choice[-1] for choice in problem.choices])
    found = solve_by_columns(problem, start, gap=1e-6)
    assert found.lower <= whole.upper * (1 + 1e-9)
    assert found.upper >= whole.lower * (1 - 1e-9)
    assert found.upper - found.lower <= 1e-6 * found.upper
    assert worst_case_attack(problem, found.elements).upper == pytest.approx(found.lower, rel=1e-6)
    # One round proves less, and truly: what the first elements alone can do is no bound.
    first = solve_by_columns(problem, start, gap=0.9)
    assert first.upper >= whole.lower * (1 - 1e-9)


def test_a_beam_keeps_the_best_alone() -> None:
    world = world_of(3)
    belief = world.motion.initial(world.scenario)
    everything = world.sequences(world.scenario.poses)
    wide = replace(world, model=replace(world.model, beam=27))
    kept = beam_sequences(wide, belief, world.scenario.poses, 0.0)
    assert np.array_equal(kept.controls, everything.controls)
    assert np.array_equal(kept.poses, everything.poses)
    narrow = replace(world, model=replace(world.model, beam=4))
    kept = beam_sequences(narrow, belief, world.scenario.poses, 0.0)
    assert np.bincount(kept.owner).tolist() == [4, 4, 4]
    alone = world.criterion(belief, everything, 0.0).singletons()
    for i in range(3):
        own = everything.owner == i
        best = everything.controls[own][np.argmax(alone[own])]
        assert (kept.controls[kept.owner == i] == best).all(axis=(1, 2)).any()
    mission = run_mission(world.scenario, steps=2, horizon=3, model=replace(world.model, beam=4))
    assert len(mission.steps) == 2
    with pytest.raises(InputError, match="beam must be an integer >= 1"):
        MissionModel(beam=0)
