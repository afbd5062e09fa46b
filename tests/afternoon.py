"""A robotics engineer's afternoon as a script: what test_afternoon.py runs, and whose lines it counts."""

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

import ratt_opt as ro
from ratt_opt.studies import Results, mission_study

MODEL = ro.MissionModel(motion="constant velocity")


def team(n_cameras: int = 8, n_radars: int = 2, n_targets: int = 9) -> ro.Scenario:
    """Quadrotors with cameras that look down, ground radars that see speeds, targets with velocities."""
    rng, fly = np.random.default_rng(0), tuple((f, s, 0.0, 0.0) for f in (-2.0, 0.0, 2.0) for s in (-2.0, 0.0, 2.0))
    camera = ro.TiltedCamera(tilt=np.pi / 2, field_of_view=1.6, std=0.02)
    radar = ro.DopplerRadar(range_std=1.0, bearing_std=0.02, rate_std=0.2, max_range=80.0)
    flyers = [
        ro.Robot(x=x, y=y, z=30.0, motion="holonomic", controls=fly, sensor=camera, name=f"quad {k}")
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
    given: dict[str, Any] = {"alpha_s": 2, "alpha_c": 2, "communication_range": 60.0, "sampling_period": 0.2}
    return ro.Scenario(robots=[*flyers, *ground], targets=targets, **given)


def nearest(problem: ro.Problem, world: ro.PlannerWorld) -> list[int]:
    """Fly to the nearest target."""
    apart = np.linalg.norm(world.ends[:, None, :2] - world.targets, axis=-1).min(axis=1)
    return [int(choice[np.argmin(apart[choice])]) for choice in problem.choices]


def compare(own: ro.Scenario, folder: Path, *, trials: int = 20) -> Results:
    """Six planners under two attackers, with intervals, tables and a figure."""
    planners = ["ratt", "greedy", "myopic", "refined", "random", nearest]
    asked: dict[str, Any] = {"attackers": ["worst", "random"], "steps": 3, "trials": trials, "model": MODEL}
    flown = mission_study(own, planners=planners, metrics=("rmse", "largest"), **asked)
    flown.save(folder)
    return flown


def seen(tracker: ro.Tracker, truth: np.ndarray, now: float, rng: np.random.Generator) -> list[ro.Measurement]:
    """Sightings of one moment, in place of real sensors."""
    made = []
    for i, (sensor, pose) in enumerate(zip(tracker.world.sensors, tracker.state.poses, strict=True)):
        for j, state in zip(tracker.targets, truth[list(tracker.targets), : sensor.reads], strict=True):
            noise = rng.normal(size=sensor.size) * np.sqrt(sensor.noise(pose, state))
            if sensor.sees(pose, state) and i not in dict(tracker.state.lost):
                made.append(ro.Measurement(i, j, tuple((sensor.measure(pose, state) + noise).tolist()), now))
    return made


def fly(own: ro.Scenario, steps: int = 12) -> tuple[ro.Tracker, np.ndarray, list[str]]:
    """Live loop at 5 Hz: bad packets, a robot that dies, a target that appears and one that goes."""
    rng, tracker = np.random.default_rng(1), ro.Tracker(own, model=MODEL, time_limit=0.1)
    truth, reasons, held = np.vstack([tracker.beliefs.mean, [40.0, 40.0, 0.0, 0.0]]), [], []
    for k, now in enumerate(100.0 + 0.2 * np.arange(steps)):
        truth[:, :2] += 0.2 * truth[:, 2:]
        made = seen(tracker, truth, float(now), rng)
        if k == 4:  # one range comes in millimetres; the right one is held back,
            held = [radar := next(m for m in made if m.robot >= 8)]
            made[made.index(radar)] = replace(radar, values=(1000 * radar.values[0], *radar.values[1:]))
        if k == 6:  # and arrives late, twice, with a target and a robot that nobody knows
            made += [*held, *held, ro.Measurement(0, 77, (0.0, 1.0)), ro.Measurement(99, 0, (0.0, 1.0))]
        reasons += [one.reason for one in tracker.step(made, now=float(now)).skipped]
        if k == 7:
            tracker.lose(3)
            tracker.add_target(ro.Target(x=40.0, y=40.0, velocity_std=0.1))
            tracker.drop_target(0)
    return tracker, truth, reasons


def protect(own: ro.Scenario) -> tuple[ro.BestRobots, ro.BestLinks]:
    """Three robots and three links whose protection gains most."""
    problem = own.problem()
    plan = ro.ratt(problem)
    return ro.robots_to_protect(problem, plan, 3), ro.links_to_protect(problem, plan, 3, time_limit=5.0)


def replay(bag: Path, mapping: Path, folder: Path) -> list[Path]:
    """A recorded bag in, plans out."""
    return ro.replay_bag(bag, mapping).save(folder)
