"""A robotics engineer's afternoon: a team of one's own, planners compared, a live loop with bad packets, protection."""

from __future__ import annotations

import time

import numpy as np
import pytest
from scipy.stats import chi2

import ratt_opt as ro

FLY = tuple((f, s, 0.0, 0.0) for f in (-2.0, 0.0, 2.0) for s in (-2.0, 0.0, 2.0))
MODEL = ro.MissionModel(motion="constant velocity")


def team(n_cameras=8, n_radars=2, n_targets=9, seed=0):
    """Quadrotors with cameras that look down, ground radars that see speeds, targets with velocities."""
    rng = np.random.default_rng(seed)
    camera = ro.TiltedCamera(tilt=np.pi / 2, field_of_view=1.6, std=0.02)
    radar = ro.DopplerRadar(range_std=1.0, bearing_std=0.02, rate_std=0.2, max_range=80.0)
    flyers = [
        ro.Robot(x=x, y=y, z=30.0, motion="holonomic", controls=FLY, sensor=camera, name=f"quad {k}")
        for k, (x, y) in enumerate(rng.uniform(0, 80, (n_cameras, 2)))
    ]
    ground = [
        ro.Robot(x=x, y=-5.0, motion="holonomic", controls=((0.0, 0.0),), sensor=radar, name=f"radar {x:g}")
        for x in np.linspace(10, 70, n_radars)
    ]
    targets = [
        ro.Target(x=x, y=y, speed=1.0, heading=h, velocity_std=0.5, process_noise=0.2, name=f"boat {j}")
        for j, (x, y, h) in enumerate(rng.uniform(0, 1, (n_targets, 3)) * [80, 80, 6.28])
    ]
    return ro.Scenario(
        robots=[*flyers, *ground], targets=targets, alpha_s=2, alpha_c=2, communication_range=60.0, sampling_period=0.2
    )


def nearest(problem, world):
    """Fly to the nearest target."""
    apart = np.linalg.norm(world.ends[:, None, :2] - world.targets, axis=-1).min(axis=1)
    return [choice[np.argmin(apart[choice])] for choice in problem.choices]


def test_planners_fly_the_same_mission() -> None:
    small = team(4, 1, 4)
    planners = ["ratt", "greedy", "myopic", "refined", "random", nearest]
    flown = [ro.run_mission(small, steps=3, planner=planner, model=MODEL) for planner in planners]
    assert all(np.isfinite(mission.rmse).all() for mission in flown)


def test_the_live_loop_at_5_hz() -> None:
    """Late, doubled, wrong-unit and alien measurements, a robot that dies, a target that comes, one that goes."""
    own, rng = team(), np.random.default_rng(1)
    tracker = ro.Tracker(own, model=MODEL, time_limit=0.1)
    truth = tracker.beliefs.mean.copy()
    seconds, reasons, held = [], [], []
    for k in range(12):
        now = 100.0 + 0.2 * k
        truth[:, :2] += 0.2 * truth[:, 2:]
        made = []
        for i, sensor in enumerate(tracker.world.sensors):
            seen = sensor.sees(tracker.state.poses[i], truth[:, : sensor.reads])
            for j in np.flatnonzero(seen).tolist():
                z = sensor.measure(tracker.state.poses[i], truth[j, : sensor.reads])
                z = z + rng.normal(size=sensor.size) * np.sqrt(
                    sensor.noise(tracker.state.poses[i], truth[j, : sensor.reads])
                )
                made.append(ro.Measurement(i, j, tuple(z.tolist()), now))
        made = [m for m in made if m.target in tracker.targets and m.robot not in dict(tracker.state.lost)]
        radar = next((m for m in made if m.robot >= 8), None)
        if k == 4 and radar is not None:
            made = [m for m in made if m is not radar]
            held = [radar]
            made.append(ro.Measurement(radar.robot, radar.target, (1000 * radar.values[0], *radar.values[1:]), now))
        if k == 6:
            made += [*held, *held, ro.Measurement(0, 77, (0.0, 1.0), now), ro.Measurement(99, 0, (0.0, 1.0), now)]
        began = time.process_time()
        plan = tracker.step(made, now=now)
        seconds.append(time.process_time() - began)
        reasons += [one.reason for one in plan.skipped]
        if k == 7:
            tracker.lose(3)
            tracker.add_target(ro.Target(x=40.0, y=40.0))
            tracker.drop_target(0)
    assert {"outlier", "repeated", "unknown target", "unknown robot"} <= set(reasons)
    assert len(tracker.targets) == 9
    errors = tracker.beliefs.positions[:-1] - truth[1:, :2]
    assert np.sqrt((errors**2).sum(axis=1).mean()) < 3.0
    assert sorted(seconds)[len(seconds) // 2] < 0.1  # of the processor, at ten robots and nine targets


def test_what_to_protect() -> None:
    problem = team(5, 1, 4).problem()
    plan = ro.ratt(problem)
    robots, links = ro.robots_to_protect(problem, plan, 3), ro.links_to_protect(problem, plan, 3, time_limit=5.0)
    assert robots.lower >= ro.worst_case_attack(problem, plan).lower - 1e-9
    assert len(robots.robots) <= 3
    assert len(links.links) <= 3


@pytest.mark.slow
def test_the_filter_is_consistent_over_200_runs() -> None:
    """NEES of positions and velocities at the end, radars with Doppler, gate on: the mean is in its 95 % interval."""
    one = ro.Target(x=30.0, y=40.0, speed=1.0, heading=1.0, velocity_std=0.5, process_noise=0.2)
    radar = ro.DopplerRadar(range_std=1.0, bearing_std=0.01, rate_std=0.2)
    robots = [ro.Robot(x=x, y=0.0, controls=((0.0, 0.0),)) for x in (0.0, 60.0)]
    own = ro.Scenario(robots=robots, targets=[one], sensor=radar, alpha_s=0, alpha_c=0, sampling_period=0.2)
    values = []
    for seed in range(200):
        rng, tracker = np.random.default_rng(seed), ro.Tracker(own, model=MODEL)
        belief, motion = tracker.beliefs, tracker.world.motion
        truth = belief.mean + rng.multivariate_normal(np.zeros(4), belief.covariance[0])
        for k in range(15):
            if k:
                drift = rng.multivariate_normal(np.zeros(4), motion.noise(0.2)[0])
                truth = motion.predict(truth, 0.2, 0.0) + drift
            made = [
                ro.Measurement(
                    i, 0, tuple((radar.measure(p, truth[0]) + rng.normal(size=3) * [1.0, 0.01, 0.2]).tolist())
                )
                for i, p in enumerate(own.poses)
            ]
            tracker.step(made, now=0.2 * k)
        values.append(float(tracker.beliefs.nees(truth)[0]))
    low, high = chi2.ppf([0.025, 0.975], 4 * 200) / 200
    assert low < np.mean(values) < high, np.mean(values)
