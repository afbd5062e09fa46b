"""The physical model against finite differences, the EKF in Joseph form, and its symmetries."""

import math
import pickle

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from pydantic import ValidationError

from ratt_opt import InputError, Robot, Scenario, Sensor, Target, random_scenario
from ratt_opt.scenario.motion import move_robots, predict_targets
from ratt_opt.scenario.sensor import jacobian, measure, wrap_angle
from tests.strategies import angles, coordinates

PINNED = [38.26911772203264, 52.66818260948598, 67.11128139283758, 5 / 3]
"""Numbers this generator gave when it was written; any machine must give them again."""


@given(coordinates, coordinates, angles, st.floats(0.5, 60), angles)
@settings(max_examples=300, deadline=None)
def test_jacobian_is_the_derivative_of_the_measurement(x: float, y: float, heading: float, r: float, a: float) -> None:
    pose, target = np.array([x, y, heading]), np.array([x + r * math.cos(a), y + r * math.sin(a)])
    step = 1e-5 * r
    for axis in range(2):
        forward, backward = target.copy(), target.copy()
        forward[axis] += step
        backward[axis] -= step
        difference = measure(pose, forward) - measure(pose, backward)
        difference[1] = wrap_angle(difference[1])
        assert jacobian(pose, target)[:, axis] == pytest.approx(difference / (2 * step), rel=1e-5, abs=1e-6 / r)


@pytest.mark.parametrize("law", ["variance", "std"])
def test_information_is_h_r_h(law: str) -> None:
    rng = np.random.default_rng(1)
    sensor = Sensor(law=law, range_noise=0.3, range_noise_slope=0.1, bearing_noise=0.01, bearing_noise_slope=0.02)
    poses, targets = rng.uniform(-9, 9, (5, 3)), rng.uniform(-9, 9, (4, 2))
    information = sensor.information(poses, targets)
    for k, pose in enumerate(poses):
        for j, target in enumerate(targets):
            r, bearing = measure(pose, target)
            noise = np.array([0.3 + 0.1 * r, 0.01 + 0.02 * abs(bearing)])
            variances = noise if law == "variance" else noise**2
            h = jacobian(pose, target)
            assert information[k, j] == pytest.approx(h.T @ np.diag(1 / variances) @ h)


def test_unicycle_moves_along_the_heading_before_the_turn() -> None:
    pose = np.array([1.0, 2.0, math.pi / 2])
    assert move_robots(pose, np.array([3.0, 1.0]), 2.0) == pytest.approx([1.0, 8.0, math.pi / 2 + 2.0])


def test_target_motion_is_the_papers_with_heading_zero_and_period_one() -> None:
    speed, turn = 5 / 3, 1 / 10
    moved = predict_targets(np.array([[7.0, 8.0]]), np.array([[speed, turn, 0.0]]), 1.0)
    assert moved[0] == pytest.approx([7 + speed * math.cos(turn), 8 + speed * math.sin(turn)])


def test_prior_is_the_predicted_covariance() -> None:
    target = Target(x=0, y=0, covariance=((4.0, 1.0), (1.0, 3.0)), process_std=2.0)
    scenario = Scenario(robots=(Robot(x=9, y=9),), targets=(target,), alpha_s=0, alpha_c=0)
    assert scenario.prior[0].tolist() == [[8.0, 1.0], [1.0, 7.0]]


@pytest.mark.parametrize(
    ("bearing", "wrapped"),
    [
        (math.pi, math.pi),
        (-math.pi, math.pi),
        (math.nextafter(math.pi, 4), math.pi),
        (3.5, 3.5 - 2 * math.pi),
        (0.0, 0.0),
    ],
)
def test_angles_wrap_to_the_half_open_interval(bearing: float, wrapped: float) -> None:
    assert wrap_angle(np.array(bearing)) == pytest.approx(wrapped)


def test_nothing_is_seen_outside_range_and_field_of_view() -> None:
    sensor = Sensor(max_range=5.0, field_of_view=math.pi / 2)
    targets = np.array([[4.0, 0.0], [6.0, 0.0], [0.0, 4.0], [2.0, 2.1], [2.1, 2.0]])
    information = sensor.information(np.zeros((1, 3)), targets)[0]
    assert [bool(m.any()) for m in information] == [True, False, False, False, True]


def test_a_target_on_top_of_a_robot_is_refused() -> None:
    with pytest.raises(InputError, match=r"robots\[0\] with control 3 m/s, 0 rad/s must not end on top of target 0"):
        Scenario(robots=(Robot(x=0, y=0),), targets=(Target(x=3, y=0),), alpha_s=0, alpha_c=0)


def test_random_scenarios_are_reproducible_everywhere() -> None:
    scenario = random_scenario(2, 2, alpha_s=1, alpha_c=1, seed=2026)
    shown = [scenario.robots[0].x, scenario.robots[1].y, scenario.targets[0].x, scenario.targets[1].speed]
    assert shown == pytest.approx(PINNED, rel=1e-15)
    larger = random_scenario(5, 7, alpha_s=1, alpha_c=1, seed=2026)
    assert larger.robots[:2] == scenario.robots
    assert larger.targets[:2] == scenario.targets
    assert random_scenario(2, 2, alpha_s=1, alpha_c=1, seed=2027).robots != scenario.robots


def test_random_scenarios_follow_section_vi() -> None:
    scenario = random_scenario(20, 30, alpha_s=3, alpha_c=9, seed=0)
    assert (scenario.poses[:, 2] == 0).all()
    assert ((scenario.poses[:, :2] >= 0) & (scenario.poses[:, :2] <= 100)).all()
    assert {abs(t.speed) for t in scenario.targets} == {5 / 3, 5 / 2, 5.0}
    assert {t.turn_rate for t in scenario.targets} == {1 / 10, 1 / 20, 1 / 30}
    assert scenario.robots[0].controls == tuple((v, w) for v in (1, -1, 3, -3) for w in (0, 1, 3))
    assert scenario.graph is None
    assert scenario.problem().alpha_c == 9


def test_a_communication_range_makes_a_disk_graph() -> None:
    robots = tuple(Robot(x=float(x), y=0) for x in (0, 4, 8, 20))
    scenario = Scenario(
        robots=robots,
        targets=(Target(x=5, y=5),),
        alpha_s=0,
        alpha_c=1,
        communication_range=4.0,
        protected_links=((2, 1),),
    )
    problem = scenario.problem()
    assert sorted(problem.communication.links) == [(0, 1), (1, 2)]
    assert problem.protected_links == {(1, 2)}
    assert [sorted(g) for g in problem.communication.groups()] == [[0, 1, 2], [3]]


def test_a_scenario_cannot_be_changed_through_its_arrays() -> None:
    scenario = random_scenario(2, 2, alpha_s=0, alpha_c=0, seed=1)
    names = ("robot", "controls", "poses", "predicted_poses", "predicted_targets", "prior", "information")
    assert not any(getattr(scenario, name).flags.writeable for name in names)
    with pytest.raises(ValidationError, match="frozen"):
        scenario.alpha_s = 1
    again = pickle.loads(pickle.dumps(scenario))
    assert again == scenario
    assert hash(again) == hash(scenario)


def test_default_noise_neither_hides_nor_saturates_the_gain() -> None:
    """The best single measurement and ten robots together remove a share of the prior trace well inside (0, 1)."""
    for seed in range(5):
        scenario = random_scenario(10, 15, alpha_s=3, alpha_c=11, seed=seed)
        f = scenario.problem().objective
        total = float(np.trace(scenario.prior, axis1=1, axis2=2).sum())
        assert 0.3 < max(f([e]) for e in range(f.n)) / total < 0.7
        assert 0.8 < f(range(0, f.n, 12)) / total < 0.97
        first = scenario.information[:12].reshape(12, -1)
        assert len(np.unique(first, axis=0)) == 12  # the paper's controls do not collapse into ties
