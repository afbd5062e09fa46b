"""Late measurements, uncertain poses, robots lost, targets that come and go, attacks seen: against a NumPy filter."""

import json
from time import monotonic, sleep

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from ratt_opt import (
    Attack,
    BearingOnly,
    InputError,
    MaxMinPlanner,
    Measurement,
    MissionModel,
    PositionSensor,
    Robot,
    Scenario,
    Sensor,
    Target,
    Tracker,
    TrackerState,
    random_scenario,
    ratt,
)
from tests.missions import numpy_filter

STILL = ((0.0, 0.0),)
PATIENCE = 60.0
"""Seconds that another thread may need on a busy machine."""


def standing(n_robots=2, n_targets=2, **options):
    """Robots that never move, so that every pose is known at every time."""
    scenario = random_scenario(n_robots, n_targets, alpha_s=0, alpha_c=0, seed=7, controls=STILL)
    return scenario.replace(**options)


def expected(scenario, made, end, *, order="second order", pose_covariances=None):
    """The NumPy filter over measurements (time, robot, target, values) in the order of their times."""
    means, covariances = [], []
    for j, target in enumerate(scenario.targets):
        mean, covariance, time = np.array([target.x, target.y]), np.array(target.covariance), 0.0
        own = sorted((m for m in made if m[2] == j), key=lambda m: m[0])
        for stop in [*dict.fromkeys(m[0] for m in own), end]:
            covariance = covariance + target.process_std**2 * (stop - time) * np.eye(2)
            mean, time = mean + displaced(target, time, stop), stop
            seen = [
                (scenario.poses[m[1]], np.array(m[3]), None if pose_covariances is None else pose_covariances[m[1]])
                for m in own
                if m[0] == stop
            ]
            variances = scenario.sensor.noise_variances
            second = order == "second order"
            mean, covariance = numpy_filter.updated(mean, covariance, seen, variances, second_order=second)
            own = [m for m in own if m[0] != stop]
        means.append(mean)
        covariances.append(covariance)
    return np.array(means), np.array(covariances)


def displaced(target, begin, end):
    """Where a target with a known velocity goes, by small steps of a thousandth of a period: straight in each."""
    times = np.arange(round(begin * 1000), round(end * 1000)) / 1000
    angles = target.heading + (np.floor(times + 1e-9) + 1) * target.turn_rate
    return target.speed / 1000 * np.array([np.cos(angles).sum(), np.sin(angles).sum()])


def seen_from(scenario, robot, target, rng):
    place = np.array([scenario.targets[target].x, scenario.targets[target].y]) + rng.normal(size=2)
    value, *_ = numpy_filter.observed(scenario.poses[robot], place)
    return tuple((value + rng.normal(size=2) * [0.3, 0.02]).tolist())


@settings(max_examples=25)
@given(seed=st.integers(0, 10_000), order=st.sampled_from(["first order", "second order"]))
def test_measurements_in_any_order_are_the_filter_in_order(seed: int, order: str) -> None:
    rng = np.random.default_rng(seed)
    scenario = standing()
    times = rng.choice(8000, size=8, replace=False) / 1000 if rng.random() < 0.7 else rng.integers(0, 8, 8) * 1.0
    pairs = {(float(t), int(rng.integers(2)), int(rng.integers(2))) for t in times}
    made = [(*pair, seen_from(scenario, pair[1], pair[2], rng)) for pair in sorted(pairs)]
    arrives = {m: float(np.ceil(m[0]) + rng.integers(0, 3)) for m in made}
    tracker = Tracker(scenario, model=MissionModel(linearisation=order), gate=None)
    for now in range(12):
        given_now = [Measurement(i, j, z, time=100.0 + t) for t, i, j, z in made if arrives[t, i, j, z] == now]
        rng.shuffle(given_now)
        tracker.step(given_now, now=100.0 + now)
    mean, covariance = expected(scenario, made, 11.0, order=order)
    np.testing.assert_allclose(tracker.beliefs.mean, mean, rtol=1e-9, atol=1e-7)
    np.testing.assert_allclose(tracker.beliefs.covariance, covariance, rtol=1e-7)


def test_a_late_measurement_is_not_the_present() -> None:
    """A target drives past; what was seen of it two seconds ago says where it was then."""
    target = Target(x=20.0, y=0.0, speed=5.0, covariance=((4.0, 0.0), (0.0, 4.0)), process_std=0.1)
    scenario = Scenario(robots=[Robot(x=0.0, y=5.0, controls=STILL)], targets=[target], alpha_s=0, alpha_c=0)
    tracker = Tracker(scenario)
    for now in (0.0, 1.0, 2.0, 3.0):
        tracker.step(now=now)
    value, *_ = numpy_filter.observed(scenario.poses[0], np.array([25.0, 0.0]))
    tracker.step([Measurement(0, 0, tuple(value.tolist()), time=1.0)], now=4.0)
    np.testing.assert_allclose(tracker.beliefs.mean[0], [40.0, 0.0], atol=1e-9)


@pytest.mark.parametrize("order", ["first order", "second order"])
def test_uncertain_poses_inflate_the_noise(order: str) -> None:
    rng = np.random.default_rng(3)
    scenario = standing()
    root = rng.normal(size=(2, 3, 3)) * [[[1.0], [1.0], [0.05]]]
    unsure = root @ root.swapaxes(-1, -2)
    made = [(1.0, i, j, seen_from(scenario, i, j, rng)) for i in range(2) for j in range(2)]
    tracker = Tracker(scenario, model=MissionModel(linearisation=order), gate=None)
    tracker.step(now=0.0)
    measured = [Measurement(i, j, z) for _, i, j, z in made]
    tracker.step(measured, now=1.0, pose_covariances=unsure)
    mean, covariance = expected(scenario, made, 1.0, order=order, pose_covariances=unsure)
    np.testing.assert_allclose(tracker.beliefs.mean, mean, rtol=1e-9)
    np.testing.assert_allclose(tracker.beliefs.covariance, covariance, rtol=1e-9)
    exact = Tracker(scenario, gate=None)
    exact.step(now=0.0)
    exact.step(measured, now=1.0)
    assert exact.beliefs.trace < tracker.beliefs.trace


def test_a_sighting_between_two_poses_is_from_between() -> None:
    """The robot drives along x and turns across pi; the sighting of the middle is from the middle."""
    far = Target(x=5.0, y=30.0, covariance=((9.0, 0.0), (0.0, 9.0)), process_std=0.0)
    scenario = Scenario(robots=[Robot(x=0.0, y=0.0, controls=STILL)], targets=[far], alpha_s=0, alpha_c=0)
    tracker = Tracker(scenario)
    ends = [np.array([[0.0, 0.0, 3.0]]), np.array([[10.0, 0.0, -3.0]])]
    tracker.step(now=0.0, poses=ends[0])
    middle = np.array([5.0, 0.0, np.pi])
    value, *_ = numpy_filter.observed(middle, np.array([5.0, 30.0]))
    tracker.step([Measurement(0, 0, tuple(value.tolist()), time=0.5)], now=1.0, poses=ends[1])
    np.testing.assert_allclose(tracker.beliefs.mean[0], [5.0, 30.0], atol=1e-9)


def test_stamps_that_cannot_be_taken_in_are_refused() -> None:
    tracker = Tracker(standing(), lag=2.0, strict=True)
    for now in range(6):
        tracker.step([Measurement(0, 0, (30.0, 0.1))], now=float(now))
    before = tracker.state
    cases = (
        (Measurement(0, 1, (30.0, 0.1), 2.9), r"measurements\[0\].time must not be before 3 s, the oldest time"),
        (Measurement(0, 1, (30.0, 0.1), 6.11), r"measurements\[0\].time must not be after this step's 6 s \(by more"),
        (Measurement(0, 0, (31.0, 0.1), 4.0), r"measurements\[0\] must not repeat robot 0 and target 0 at one time"),
    )
    for measurement, text in cases:
        with pytest.raises(InputError, match=text) as refused:
            tracker.step([measurement], now=6.0)
        assert "\n" not in str(refused.value)
        assert tracker.state is before
    tracker.step([Measurement(0, 1, (30.0, 0.1), 3.5)], now=6.0)


def test_a_lost_robot_neither_plans_nor_measures() -> None:
    scenario = random_scenario(4, 3, alpha_s=1, alpha_c=2, seed=3)
    tracker = Tracker(scenario, strict=True)
    tracker.step(now=0.0)
    tracker.lose(1)
    place = tracker.state.poses[1].copy()
    belief, poses = tracker.beliefs, tracker.state.poses
    plan = tracker.step(now=1.0)
    assert tracker.controls[1].tolist() == [0.0, 0.0]
    assert np.array_equal(tracker.state.poses[1], place)
    alive = [0, 2, 3]
    smaller = scenario.replace(robots=tuple(scenario.robots[i] for i in alive))
    state = Tracker(smaller).state
    heir = Tracker(smaller, state=state_of(state, belief, poses[alive]))
    own = heir.step(now=1.0).elements
    assert [int(e) % 12 for e in own] == [int(plan.elements[i]) % 12 for i in alive]
    with pytest.raises(InputError, match=r"measurements\[0\].robot must not be lost when it measured; got 1"):
        tracker.step([Measurement(1, 0, (20.0, 0.1))], now=2.0)
    tracker.step([Measurement(1, 0, (20.0, 0.1), time=0.0)], now=2.0)
    with pytest.raises(InputError, match="robot must not be lost already; got 1"):
        tracker.lose(1)
    for robot in alive:
        tracker.lose(robot)
    assert tracker.step(now=3.0).elements.shape == (4,)


def state_of(state, belief, poses):
    """A state one period after its start, at these poses with this belief."""
    from dataclasses import replace

    moment = replace(state.moments[0], belief=belief, poses=poses)
    return replace(state, moments=(moment,), poses=poses, steps=1, now=0.0)


def test_plans_know_the_attack_that_was_seen() -> None:
    """The plan is the one for the team without what was hit, against what is left of the budgets."""
    scenario = random_scenario(4, 3, alpha_s=2, alpha_c=3, seed=3)
    first = Tracker(scenario, model=MissionModel(linearisation="first order"))
    first.attacked(Attack({2}, {(0, 1), (1, 3)}))
    problem = scenario.replace(alpha_s=1, alpha_c=1).problem()
    information = problem.objective.information.copy()
    information[problem.robot == 2] = 0.0
    from ratt_opt import Problem

    graph = scenario.graph_at(scenario.poses)
    import networkx as nx

    graph = nx.complete_graph(4) if graph is None else graph
    graph.remove_edges_from([(0, 1), (1, 3)])
    known = Problem(problem.objective.with_information(information), problem.robot, graph, 1, 1)
    assert np.array_equal(first.step().elements, ratt(known).elements)
    first.attacked(Attack())
    assert first.state.attack == Attack()
    for attack, text in ((Attack({4}), "attack robot must be"), (3, "attack must be an Attack")):
        with pytest.raises(InputError, match=text):
            first.attacked(attack)


@settings(max_examples=15)
@given(seed=st.integers(0, 1000), motion=st.sampled_from(["known velocity", "constant velocity", "coordinated turn"]))
def test_targets_that_come_and_go_leave_the_others_as_they_were(seed: int, motion: str) -> None:
    """Each target's filter is its own: those that stay believe what they would alone, numbers and all."""
    rng = np.random.default_rng(seed)
    scenario = standing(n_targets=3)
    new = scenario.targets[0].replace(x=40.0, y=60.0, speed=1.5, turn_rate=0.2, heading=0.7)
    model = MissionModel(motion=motion)
    tracker, calm = Tracker(scenario, model=model, gate=None), Tracker(scenario, model=model, gate=None)
    for now in range(8):
        made = [
            Measurement(i, j, seen_from(scenario, i, j, rng), now - 0.5 if now else None)
            for i in (0, 1)
            for j in (0, 2)
        ]
        tracker.step(made, now=float(now))
        calm.step(made, now=float(now))
        if now == 2:
            assert tracker.add_target(new) == 3
        if now == 4:
            tracker.drop_target(1)
    assert tracker.targets == (0, 2, 3)
    np.testing.assert_allclose(tracker.beliefs.mean[:2], calm.beliefs.mean[[0, 2]], rtol=1e-12)
    np.testing.assert_allclose(tracker.beliefs.covariance[:2], calm.beliefs.covariance[[0, 2]], rtol=1e-12)
    alone = Tracker(scenario.replace(targets=(new,)), model=model, gate=None)
    for now in np.arange(0.0, 5.25, 0.5):  # as the others' sightings part the time
        alone.step(now=now)
    np.testing.assert_allclose(tracker.beliefs.mean[2], alone.beliefs.mean[0], rtol=1e-9)
    np.testing.assert_allclose(tracker.beliefs.covariance[2], alone.beliefs.covariance[0], rtol=1e-9)
    state = TrackerState.from_dict(json.loads(json.dumps(tracker.state.to_dict())))
    heir = Tracker(tracker.scenario, model=model, state=state, gate=None)
    late = [Measurement(0, 3, (30.0, 0.3), time=6.2)]
    assert np.array_equal(heir.step(late, now=8.0).elements, tracker.step(late, now=8.0).elements)
    assert heir.state == tracker.state


def test_what_cannot_come_or_go_is_refused() -> None:
    tracker = Tracker(standing(n_targets=2), strict=True)
    tracker.step(now=0.0)
    tracker.drop_target(0)
    tracker.step(now=5.0)
    number = tracker.add_target(Target(x=9.0, y=9.0))
    for measurement, text in (
        (Measurement(0, 0, (9.0, 0.0)), r"measurements\[0\].target must be one of the targets \[1, 2\]; got 0"),
        (Measurement(0, number, (9.0, 0.0), time=4.0), r"must not be before target 2 was added"),
    ):
        with pytest.raises(InputError, match=text):
            tracker.step([measurement], now=6.0)
    for call, text in (
        (lambda: tracker.drop_target(0), r"target must be one of the targets \[1, 2\]; got 0"),
        (lambda: tracker.add_target("new"), "target must be a Target"),
        (lambda: tracker.lose(9), r"robot must be an integer in \[0, 1\]"),
    ):
        with pytest.raises(InputError, match=text):
            call()
    fixed = Tracker(standing(), model=MissionModel(motion=tracker.world.motion))
    with pytest.raises(InputError, match="motion must move any number of targets"):
        fixed.add_target(Target(x=1.0, y=1.0))


@pytest.mark.parametrize("sensor", [None, BearingOnly(Sensor()), PositionSensor(0.5)])
def test_on_top_of_the_robot_a_sighting_counts_or_is_named(sensor) -> None:
    """The target is expected exactly where the robot is; the sighting says otherwise."""
    here = Target(x=3.0, y=4.0, covariance=((25.0, 0.0), (0.0, 25.0)), process_std=0.0)
    scenario = Scenario(robots=[Robot(x=0.0, y=0.0, controls=((1.0, 0.0),))], targets=[here], alpha_s=0, alpha_c=0)
    tracker = Tracker(scenario, model=MissionModel(sensor=sensor))
    tracker.step(now=0.0)
    values = {None: (5.0, 0.1), BearingOnly: (0.1,), PositionSensor: (7.0, 4.5)}[sensor and type(sensor)]
    if isinstance(sensor, BearingOnly):
        (silent,) = tracker.step([Measurement(0, 0, values)], now=1.0, poses=[[3.0, 4.0, 0.0]]).skipped
        assert silent.reason == "tells nothing"
        assert tracker.beliefs.trace == pytest.approx(50.0)
    else:
        tracker.step([Measurement(0, 0, values)], now=1.0, poses=[[3.0, 4.0, 0.0]])
        assert tracker.beliefs.trace < 25.0
        assert np.linalg.norm(tracker.beliefs.mean[0] - [8.0, 4.5]) < 3.0


def test_a_search_that_is_late_leaves_ratts_plan_and_the_next_step_in_time() -> None:
    """A search that never ends by itself is told to stop: no step after it finds it still busy for long."""
    told = []

    class Endless(MaxMinPlanner):
        def within(self, problem, budget, start):
            while not budget.is_interrupted:
                pass
            told.append(budget)
            return super().within(problem, budget, start)

    scenario = random_scenario(4, 3, alpha_s=1, alpha_c=2, seed=3)
    tracker, plain = Tracker(scenario, planner=Endless(), time_limit=0.05), Tracker(scenario)
    for now in range(3):
        assert np.array_equal(tracker.step(now=float(now)).elements, plain.step(now=float(now)).elements)
    assert tracker.state.missed == 3
    until = monotonic() + PATIENCE
    while not told and monotonic() < until:
        sleep(0.01)
    assert told


@settings(max_examples=15)
@given(scale=st.floats(1e4, 1e10), order=st.sampled_from(["first order", "second order"]))
def test_a_wide_covariance_beside_a_near_robot_is_planned(scale: float, order: str) -> None:
    """Nothing is known of the target, and a robot stands three metres from where it is expected."""
    wide = Target(x=3.0, y=0.0, covariance=((scale, 0.0), (0.0, scale)), process_std=0.0)
    near = Target(x=90.0, y=0.0)
    precise = Sensor(range_noise=1e-4, range_noise_slope=0.0, bearing_noise=1e-8, bearing_noise_slope=0.0)
    scenario = Scenario(
        robots=[Robot(x=0.0, y=0.0, controls=STILL), Robot(x=80.0, y=0.0, controls=STILL)],
        targets=[near, near],
        sensor=precise,
        alpha_s=1,
        alpha_c=0,
    )
    tracker = Tracker(scenario, model=MissionModel(linearisation=order))
    tracker.step(now=0.0)
    tracker.drop_target(1)
    state = tracker.state.to_dict()
    state["moments"][-1] |= {"mean": [[wide.x, wide.y]], "covariance": [np.diag([scale, scale]).tolist()]}
    heir = Tracker(tracker.scenario, model=MissionModel(linearisation=order), state=TrackerState.from_dict(state))
    heir.step(now=1.0)  # a plan while nothing is known
    heir.step([Measurement(0, 0, (3.0, 0.0))], now=2.0)
    assert np.linalg.norm(heir.beliefs.mean[0] - [3.0, 0.0]) < 1e-6
