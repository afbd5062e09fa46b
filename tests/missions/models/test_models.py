"""Motions and sensors: derivatives against differences, motions against many small steps, noise against samples."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from ratt_opt import (
    BearingOnly,
    ConstantVelocity,
    CoordinatedTurn,
    InputError,
    KnownVelocity,
    PositionSensor,
    RangeBearing,
    RangeOnly,
    Sensor,
    random_scenario,
)
from ratt_opt.missions.models.robots import check_robot_motion, move_on_arcs
from ratt_opt.missions.models.sensors import sensors_of
from ratt_opt.missions.models.targets import target_motion

SENSORS = (RangeBearing(Sensor()), RangeOnly(Sensor()), BearingOnly(Sensor()), PositionSensor(0.7))


def differences(f, x, step=1e-5):
    """Central differences of f (..., k) by the last axis of x (..., n): (..., k, n)."""
    columns = [(f(x + e) - f(x - e)) / (2 * step) for e in step * np.eye(x.shape[-1])]
    return np.stack(columns, axis=-1)


@pytest.mark.parametrize("sensor", SENSORS, ids=lambda s: type(s).__name__)
def test_derivatives_of_sensors(sensor) -> None:
    rng = np.random.default_rng(0)
    poses, points = rng.uniform(-5, 5, (20, 3)), rng.uniform(8, 20, (20, 2))
    poses[:, 2] = 0.7  # no bearing near the cut at pi
    slopes = sensor.jacobian(poses, points)
    np.testing.assert_allclose(slopes, differences(lambda x: sensor.measure(poses, x), points), atol=1e-7)
    bends = differences(lambda x: sensor.jacobian(poses, x).reshape(20, -1), points).reshape(20, -1, 2, 2)
    np.testing.assert_allclose(sensor.hessian(poses, points), bends, atol=1e-7)


def test_range_and_bearing_is_the_scenarios() -> None:
    scenario = random_scenario(3, 4, alpha_s=1, alpha_c=1, seed=2)
    sensor = sensors_of(scenario)[0]
    own = scenario.robot == 0
    given = sensor.information(scenario.predicted_poses[own], scenario.predicted_targets)
    assert np.array_equal(given, scenario.information[own])
    both = sensor.information(scenario.predicted_poses[own], scenario.predicted_targets)
    noise = scenario.sensor
    parts = [
        s(noise).information(scenario.predicted_poses[own], scenario.predicted_targets)
        for s in (RangeOnly, BearingOnly)
    ]
    np.testing.assert_allclose(parts[0] + parts[1], both, rtol=1e-12, atol=1e-15)


def test_the_second_order_term_is_the_variance_that_the_linearisation_leaves() -> None:
    rng = np.random.default_rng(1)
    sensor, pose, point = RangeBearing(Sensor()), np.zeros(3), np.array([9.0, 4.0])
    covariance = np.array([[1.0, 0.3], [0.3, 0.6]])
    draws = rng.multivariate_normal(np.zeros(2), covariance, 400_000)
    left = sensor.measure(pose, point + draws) - sensor.measure(pose, point) - draws @ sensor.jacobian(pose, point).T
    term = sensor.noise_covariance(pose, point, covariance) - sensor.noise_covariance(pose, point)
    np.testing.assert_allclose(np.cov(left.T), term, rtol=0.15, atol=0.02 * float(np.diagonal(term).prod()) ** 0.5)


@pytest.mark.parametrize("rate", [0.0, 1e-7, 1e-5, 0.3, -2.0])
def test_coordinated_turn(rate: float) -> None:
    motion = CoordinatedTurn(np.array([0.5]))
    state = np.array([[1.0, 2.0, 3.0, -1.0, rate]])
    small = state
    for _ in range(20_000):  # midpoint rule
        half = small + 0.25e-4 * np.array([small[0, 2], small[0, 3], -rate * small[0, 3], rate * small[0, 2], 0])
        small = small + 0.5e-4 * np.array([half[0, 2], half[0, 3], -rate * half[0, 3], rate * half[0, 2], 0])
    np.testing.assert_allclose(motion.predict(state, 1.0, 0.0), small, atol=1e-7)
    found = differences(lambda x: motion.predict(x, 1.0, 0.0), state, 1e-6)
    np.testing.assert_allclose(motion.transition(state, 1.0), found, atol=1e-7)


def test_noise_moves_a_target_by_its_process_std() -> None:
    for period in (0.5, 2.0):
        noise = ConstantVelocity(np.array([0.5, 1.0]), period).noise(period)
        np.testing.assert_allclose(noise[:, 0, 0], [0.25, 1.0])
        assert (np.linalg.eigvalsh(noise) > 0).all()


@pytest.mark.parametrize("kind", [ConstantVelocity, CoordinatedTurn, KnownVelocity])
def test_two_half_periods_add_up_to_the_noise_of_a_whole_one(kind) -> None:
    motion = kind.of(random_scenario(1, 2, alpha_s=0, alpha_c=0, seed=0))
    straight = np.zeros((2, motion.dimension))
    if kind is CoordinatedTurn:
        motion = CoordinatedTurn(motion.process_std, turn_noise=0.0)
    F = motion.transition(straight, 0.5)
    halves = F @ motion.noise(0.5) @ F.swapaxes(-1, -2) + motion.noise(0.5)
    np.testing.assert_allclose(halves, motion.noise(1.0), rtol=1e-12, atol=1e-15)


def test_known_velocity_starts_as_the_scenario_and_circles() -> None:
    scenario = random_scenario(1, 3, alpha_s=0, alpha_c=0, seed=0)
    motion = KnownVelocity.of(scenario)
    belief = motion.initial(scenario)
    first = belief.predicted(motion, 1.0, 0.0)
    assert np.array_equal(first.mean, scenario.predicted_targets)
    assert np.array_equal(first.covariance, scenario.prior)
    states, steps = belief.mean, []
    for k in range(4):
        steps.append(motion.predict(states, 1.0, float(k)) - states)
        states = states + steps[-1]
    turned = [np.arctan2(*(step[:, ::-1].T)) for step in steps]
    np.testing.assert_allclose(np.diff(np.unwrap(turned, axis=0), axis=0), np.tile(motion.motions[:, 1], (3, 1)))


def test_arcs_are_many_small_steps() -> None:
    pose, control = np.array([1.0, 2.0, 0.5]), np.array([3.0, 1.2])
    small = pose
    for _ in range(1000):
        small = move_on_arcs(small, control, 1e-3)
    np.testing.assert_allclose(move_on_arcs(pose, control, 1.0), small, rtol=1e-9)
    straight = move_on_arcs(pose, np.array([3.0, 0.0]), 1.0)
    np.testing.assert_allclose(straight, [1 + 3 * np.cos(0.5), 2 + 3 * np.sin(0.5), 0.5])


def test_names_that_do_not_exist() -> None:
    scenario = random_scenario(1, 1, alpha_s=0, alpha_c=0, seed=0)
    with pytest.raises(InputError, match="robot_motion must be paper, arc, holonomic or a RobotMotion"):
        check_robot_motion("omni")
    with pytest.raises(InputError, match="motion must be known velocity"):
        target_motion("random walk", scenario)
    with pytest.raises(InputError, match="sensor must be a SensorModel"):
        sensors_of(scenario, SENSORS)
    with pytest.raises(InputError, match="std"):
        PositionSensor(0.0)


@settings(max_examples=30)
@given(
    parts=st.lists(st.floats(0.01, 3.7), min_size=1, max_size=6),
    begin=st.floats(0.0, 20.0),
    period=st.sampled_from([0.5, 1.0, 2.0]),
)
def test_known_velocity_does_not_depend_on_how_often_it_is_predicted(parts, begin: float, period: float) -> None:
    scenario = random_scenario(2, 4, alpha_s=0, alpha_c=0, seed=5).replace(sampling_period=period)
    motion = KnownVelocity.of(scenario)
    start, time = scenario.predicted_targets, begin
    moved = start
    for part in parts:
        moved, time = motion.predict(moved, part, time), time + part
    np.testing.assert_allclose(moved, motion.predict(start, sum(parts), begin), rtol=0, atol=1e-8)


def test_known_velocity_over_whole_periods_is_the_papers() -> None:
    scenario = random_scenario(2, 4, alpha_s=0, alpha_c=0, seed=5)
    motion, places = KnownVelocity.of(scenario), np.array([(t.x, t.y) for t in scenario.targets])
    assert np.array_equal(motion.predict(places, 1.0, 0.0), scenario.predicted_targets)
    for k in range(5):
        expected = [
            t.speed * np.array([np.cos(t.heading + (k + 1) * t.turn_rate), np.sin(t.heading + (k + 1) * t.turn_rate)])
            for t in scenario.targets
        ]
        np.testing.assert_allclose(motion.predict(places, 1.0, float(k)) - places, expected, atol=1e-12)


@pytest.mark.parametrize("sensor", SENSORS, ids=lambda s: type(s).__name__)
def test_derivatives_by_the_pose(sensor) -> None:
    rng = np.random.default_rng(0)
    poses, points = rng.uniform(-5, 5, (20, 3)), rng.uniform(8, 20, (20, 2))
    poses[:, 2] = 0.7
    numeric = differences(lambda x: sensor.measure(x, points), poses)
    np.testing.assert_allclose(sensor.pose_jacobian(poses, points), numeric, atol=1e-7)
