"""Doppler, heights, sideways flight, covariances of whole states, noise per second: against NumPy written out again."""

import inspect
import json

import numpy as np
import pytest
from scipy.stats import chi2

import ratt_opt as ro
from ratt_opt import (
    DopplerRadar,
    InputError,
    Measurement,
    MissionModel,
    Robot,
    Scenario,
    SphericalSensor,
    Target,
    TiltedCamera,
    Tracker,
    load_scenario,
    run_mission,
    save_scenario,
)

STILL = ((0.0, 0.0),)
QUAD = ((2.0, 0.0, 0.0, 0.0), (0.0, 2.0, 0.3, 0.0), (0.0, -2.0, 0.0, 1.0), (0.0, 0.0, 0.0, -1.0))


def measured(kind, pose, x):
    """What a sensor measures of a state: Doppler, spherical, tilted."""
    dx, dy = x[0] - pose[0], x[1] - pose[1]
    flat = np.hypot(dx, dy)
    bearing = (np.arctan2(dy, dx) - pose[2] + np.pi) % (2 * np.pi) - np.pi
    if kind == "doppler":
        return np.array([flat, bearing, (dx * x[2] + dy * x[3]) / flat])
    if kind == "spherical":
        return np.array([np.sqrt(flat**2 + (x[4] - pose[3]) ** 2), bearing, np.arctan2(x[4] - pose[3], flat)])
    return np.array([bearing, np.arctan2(pose[3], flat)])


def slope_of(kind, pose, x, step=1e-2):
    """Central differences of sixth order: their error is below 1e-12 at distances of tens of metres."""
    columns = []
    for axis in np.eye(len(x)):
        apart = [
            measured(kind, pose, x + k * step * axis) - measured(kind, pose, x - k * step * axis) for k in (1, 2, 3)
        ]
        columns.append((45 * apart[0] - 9 * apart[1] + apart[2]) / (60 * step))
    return np.stack(columns, axis=-1)


CASES = {
    "doppler": (DopplerRadar(0.5, 0.02, 0.1), "constant velocity", 4, (0.5, 0.02, 0.1)),
    "spherical": (SphericalSensor(0.5, 0.02), "constant velocity 3d", 6, (0.5, 0.02, 0.02)),
    "tilted": (TiltedCamera(std=0.02), "constant velocity", 4, (0.02, 0.02)),
}


def transition(d, period):
    F = np.eye(d)
    for i, j in ((0, 2), (1, 3), (4, 5))[: d // 2]:
        F[i, j] = period
    return F


def acceleration_noise(d, period, q):
    Q = np.zeros((d, d))
    for i, j in ((0, 2), (1, 3), (4, 5))[: d // 2]:
        Q[i, i], Q[i, j], Q[j, i], Q[j, j] = period**3 / 3, period**2 / 2, period**2 / 2, period
    return q**2 * Q


def updated(kind, x, P, sightings, *, stds, gate):
    """Update by stacked sightings (pose, values) within the gate, and the number of those outside."""
    R, kept = np.diag(np.square(stds)), []
    for pose, z in sightings:
        H, surprise = slope_of(kind, pose, x), z - measured(kind, pose, x)
        square = surprise @ np.linalg.solve(H @ P @ H.T + R, surprise)
        if gate is None or square <= chi2.ppf(gate, len(stds)):
            kept.append((H, surprise))
    if not kept:
        return x, P, len(sightings)
    H, R = np.concatenate([h for h, _ in kept]), np.kron(np.eye(len(kept)), R)
    gain = P @ H.T @ np.linalg.inv(H @ P @ H.T + R)
    joseph = np.eye(len(x)) - gain @ H
    x = x + gain @ np.concatenate([surprise for _, surprise in kept])
    return x, joseph @ P @ joseph.T + gain @ R @ gain.T, len(sightings) - len(kept)


@pytest.mark.parametrize("gate", [0.999, 0.8, None])
@pytest.mark.parametrize("kind", CASES)
def test_the_tracker_is_a_numpy_filter(kind: str, gate: float | None) -> None:
    """First-order EKF with a gate over steps of unequal length, two robots with heights, one target, wild sightings."""
    sensor, motion, d, stds = CASES[kind]
    rng = np.random.default_rng(5)
    robots = [Robot(x=0.0, y=0.0, z=30.0, controls=STILL), Robot(x=60.0, y=10.0, heading=2.0, z=25.0, controls=STILL)]
    P = np.diag([9.0, 9.0, 1.0, 1.0, 4.0, 0.25])[:d, :d] + 0.1
    target = Target(x=30.0, y=40.0, z=8.0, speed=2.0, heading=0.5, climb=0.2, covariance=P.tolist(), process_noise=0.3)
    team = Scenario(robots=robots, targets=[target], sensor=sensor, alpha_s=1, alpha_c=0, sampling_period=0.2)
    tracker = Tracker(team, model=MissionModel(motion=motion, linearisation="first order"), gate=gate)
    x = np.array([30.0, 40.0, 2 * np.cos(0.5), 2 * np.sin(0.5), 8.0, 0.2])[:d]
    truth, now, refused = x + rng.normal(size=d) * 0.5, 0.0, 0
    tracker.step(now=now)
    np.testing.assert_allclose(tracker.beliefs.mean[0], x, rtol=1e-12)
    for k, span in enumerate((0.2, 0.2, 0.5, 0.13, 0.2, 1.0, 0.2)):
        now += span
        truth = transition(d, span) @ truth
        values = [measured(kind, pose, truth) + rng.normal(size=len(stds)) * stds for pose in team.poses]
        if k in {2, 5}:
            values[1] = values[1] + np.array(stds) * 40
        skipped = tracker.step([Measurement(i, 0, tuple(z)) for i, z in enumerate(values)], now=now).skipped
        parts = [0.2] * int(span / 0.2 + 1e-9) + ([span % 0.2] if 1e-9 < span % 0.2 < 0.2 - 1e-9 else [])
        for part in parts:
            F = transition(d, part)
            x, P = F @ x, F @ P @ F.T + acceleration_noise(d, part, 0.3)
        x, P, wild = updated(kind, x, P, list(zip(team.poses, values, strict=True)), stds=stds, gate=gate)
        assert len(skipped) == wild
        refused += wild
        np.testing.assert_allclose(tracker.beliefs.mean[0], x, rtol=1e-9, atol=1e-9)
        np.testing.assert_allclose(tracker.beliefs.covariance[0], P, rtol=1e-9, atol=1e-9)
    assert refused >= 2 if gate else refused == 0


@pytest.mark.parametrize("kind", CASES)
def test_derivatives_and_files(kind: str, tmp_path) -> None:
    sensor, motion, d, _ = CASES[kind]
    rng = np.random.default_rng(1)
    poses, points = rng.normal(size=(5, 4)) * [20, 20, 1, 1] + [0, 0, 0, 30], rng.normal(size=(5, 6)) * 20
    r = sensor.reads
    for pose, point in zip(poses, points[:, :r], strict=True):
        slope = slope_of(kind, pose, point)
        np.testing.assert_allclose(sensor.jacobian(pose, point), slope, rtol=1e-6, atol=1e-8)
    target = Target(x=30.0, y=40.0, z=5.0, velocity_std=0.4, process_noise=0.2)
    robot = Robot(x=0.0, y=0.0, z=30.0, controls=QUAD, motion="holonomic")
    team = Scenario(robots=[robot, Robot(x=9.0, y=9.0)], targets=[target], sensor=sensor, alpha_s=1, alpha_c=0)
    save_scenario(team, tmp_path / "team.json")
    assert load_scenario(tmp_path / "team.json") == team
    assert team.poses.shape == (2, 4)
    mission = run_mission(team, steps=3, model=MissionModel(motion=motion), horizon=2)
    assert mission.dimension == d
    report = ro.bound(team, time_limit=2.0, guarantees="none")
    assert report.optimum.lower <= report.optimum.upper
    twin = ro.bound(team.to_information(), time_limit=2.0, guarantees="none")
    assert twin.optimum.lower == report.optimum.lower
    mission.save(tmp_path / "mission")
    head = (tmp_path / "mission/tracks.csv").read_text().splitlines()[0]
    assert "vx,vy" in head
    assert "true_vx" in head
    assert "z,left,climb" in (tmp_path / "mission/mission.csv").read_text().splitlines()[0]


def test_a_quadrotor_flies_sideways_and_climbs() -> None:
    robot = Robot(x=1.0, y=2.0, heading=np.pi / 2, z=10.0, controls=QUAD, motion="holonomic")
    team = Scenario(robots=[robot], targets=[Target(x=50.0, y=0.0)], alpha_s=0, alpha_c=0, sampling_period=0.5)
    after = team.predicted_poses
    np.testing.assert_allclose(after[0], [1.0, 3.0, np.pi / 2, 10.0])
    np.testing.assert_allclose(after[2], [2.0, 2.0, np.pi / 2, 10.5])
    np.testing.assert_allclose(after[1, 2:], [np.pi / 2 + 0.15, 10.0])
    assert team.element_labels[2] == "0 m/s forward, -2 m/s left, 1 m/s up"
    flown = run_mission(team, steps=1, model=MissionModel(linearisation="first order"))
    np.testing.assert_allclose(flown.steps[0].poses[0], after[flown.decisions[0][0][0]])


def test_a_camera_sees_a_disk_that_grows_with_height() -> None:
    camera = TiltedCamera(tilt=np.pi / 2, field_of_view=1.0)
    for height in (5.0, 40.0):
        edge = height * np.tan(0.5)
        pose = np.array([3.0, 4.0, 0.7, height])
        seen = camera.sees(pose, np.array([[3.0 + 0.99 * edge, 4.0], [3.0, 4.0 - 1.01 * edge]]))
        assert seen.tolist() == [True, False]
    ahead = TiltedCamera(tilt=0.5, field_of_view=0.2)
    pose = np.array([0.0, 0.0, 0.0, 10.0])
    assert ahead.sees(pose, np.array([[10 / np.tan(0.5), 0.0], [-10 / np.tan(0.5), 0.0]])).tolist() == [True, False]


class Drift(ro.RobotMotion):
    """Controls are displacements."""

    def move(self, poses, controls, period):
        after = np.array(poses, dtype=float)
        after[..., :2] += period * controls[..., :2]
        return after


def test_a_motion_of_ones_own() -> None:
    team = ro.random_scenario(3, 2, alpha_s=1, alpha_c=1, seed=0)
    mission = run_mission(team, steps=2, model=MissionModel(robot_motion=Drift()))
    for before, step in zip((mission.start, mission.steps[0].poses), mission.steps, strict=True):
        np.testing.assert_allclose(step.poses[:, :2], before[:, :2] + step.controls[:, :2])


@pytest.mark.parametrize("motion", ["known velocity", "constant velocity"])
def test_noise_per_second_does_not_depend_on_the_period(motion: str) -> None:
    """After two seconds without a measurement teams at 1 Hz and at 5 Hz are as uncertain."""
    target = Target(x=5.0, y=9.0, process_noise=0.7)
    traces = []
    for period in (1.0, 0.2):
        team = Scenario(robots=[Robot(x=0.0, y=0.0)], targets=[target], alpha_s=0, alpha_c=0, sampling_period=period)
        tracker = Tracker(team, model=MissionModel(motion=motion))
        tracker.step(now=0.0)
        tracker.step(now=2.0)
        traces.append(tracker.beliefs.trace)
        one = team.replace(sampling_period=period).step_noise_std[0]
        assert one == pytest.approx(0.7 * period**0.5)
    assert traces[0] == pytest.approx(traces[1], rel=1e-9)


def test_what_does_not_fit_is_refused() -> None:
    with pytest.raises(InputError, match=r"covariance must be 2 x 2, 4 x 4 or 6 x 6; got"):
        Target(x=0.0, y=0.0, covariance=np.eye(3).tolist())
    with pytest.raises(InputError, match="covariance must be symmetric"):
        Target(x=0.0, y=0.0, covariance=(np.eye(4) + np.eye(4, k=1)).tolist())
    with pytest.raises(InputError, match="covariance must be positive definite"):
        Target(x=0.0, y=0.0, covariance=np.diag([1.0, 1.0, 1.0, -1.0]).tolist())
    with pytest.raises(InputError, match="controls must be pairs of a unicycle"):
        Robot(x=0.0, y=0.0, controls=QUAD)
    team = ro.random_scenario(2, 2, alpha_s=0, alpha_c=0, seed=0).replace(sensor=DopplerRadar())
    with pytest.raises(InputError, match="motion must have states of 4 numbers"):
        run_mission(team, steps=1)
    with pytest.raises(InputError, match="height must be given"):
        team.replace(sensor=TiltedCamera())


def test_files_without_the_new_fields_are_as_they_were() -> None:
    team = ro.random_scenario(2, 2, alpha_s=0, alpha_c=0, seed=0)
    document = json.loads(team.model_dump_json())
    assert "z" not in document["robots"][0]
    assert "process_noise" not in document["targets"][0]
    assert document["targets"][0]["covariance"] == [[9.0, 0.0], [0.0, 9.0]]


@pytest.mark.parametrize("kind", CASES)
def test_log_det_takes_all_that_is_read(kind: str) -> None:
    """Plans, reports and missions with the log-det of the state that sensors read, by its definition."""
    sensor, motion, d, _ = CASES[kind]
    robots = [Robot(x=0.0, y=0.0, z=30.0), Robot(x=60.0, y=10.0, heading=2.0, z=25.0)]
    target = Target(x=30.0, y=40.0, z=8.0, speed=2.0, heading=0.5, velocity_std=0.5, process_noise=0.3)
    team = Scenario(robots=robots, targets=[target], sensor=sensor, alpha_s=1, alpha_c=0)
    f = team.problem("logdet").objective
    for chosen in ([], [3], [3, 14]):
        after = np.linalg.inv(team.prior[0]) + team.information[chosen, 0].sum(axis=0)
        gained = np.linalg.slogdet(after)[1] + np.linalg.slogdet(team.prior[0])[1]
        assert f(chosen) == pytest.approx(gained, rel=1e-9, abs=1e-9)
    model = MissionModel(motion=motion, objective="logdet")
    assert run_mission(team, steps=2, model=model).dimension == d
    report = ro.bound(team, model=model, time_limit=2.0, guarantees="none")
    assert report.optimum.lower <= report.optimum.upper
    with pytest.raises(InputError, match="objective must be trace or maxeig if a plan looks several steps ahead"):
        run_mission(team, steps=2, horizon=2, model=model)


def test_one_step_is_drawn_with_velocities_too() -> None:
    """Errors over many draws are as large as the posterior says, whose trace is what the plan promised."""
    robots = [Robot(x=0.0, y=0.0), Robot(x=60.0, y=10.0, heading=2.0)]
    near = ((0.04, 0.0), (0.0, 0.04))
    target = Target(x=30.0, y=40.0, speed=2.0, heading=0.5, covariance=near, velocity_std=0.5, process_noise=0.1)
    radar = DopplerRadar(range_std=0.2, bearing_std=0.01, rate_std=0.1)
    team = Scenario(robots=robots, targets=[target], sensor=radar, alpha_s=0, alpha_c=0)
    plan = ro.ratt(team.problem())
    drawn = ro.simulate_tracking(team, plan, range(2), seed=0, draws=4000)
    after = np.linalg.inv(np.linalg.inv(team.prior[0]) + team.information[plan.elements, 0].sum(axis=0))
    np.testing.assert_allclose(drawn.covariances[0, 0], after[:2, :2], rtol=1e-9)
    errors = drawn.estimates[:, 0] - drawn.truth[:, 0]
    nees = np.einsum("di,ij,dj->d", errors, np.linalg.inv(after[:2, :2]), errors)
    assert 1.8 < nees.mean() < 2.4  # 2, and what is not linear
    nothing = ro.simulate_tracking(team, plan, [], seed=0, draws=100)
    assert nothing.mse > 2 * drawn.mse


def test_help_on_a_scenario_is_readable() -> None:
    told = str(inspect.signature(Scenario))
    assert "Annotated" not in told
    assert "FieldInfo" not in told
    assert "alpha_s: int" in told
    assert "communication_range: float | None = None" in told
    assert len(told) < 1200
