"""Stone Soup's teams under attack: errors of tracks by manager, seconds a step, and what the adapter costs.

Run as ``python -m analysis.benchmarks.stonesoup [--platforms 3 4 10] [--views 30 60 360] [--attackers exact none]
[--managers ratt ...] [--runs 60] [--steps 6] [--log FILE]``, or with ``--quick`` (2 runs of 2 steps). Each row is one
team, view, attacker and manager: the root mean square error of positions over ``runs`` missions with its 95 % interval,
the difference from sequential greedy in the same missions, and seconds of the processor a step. A view of 30 or 60
degrees turns to 13 directions; one of 360 degrees is on a platform that moves to 13 places. Prior tracks and
associations are known, so that managers differ by where their sensors look.

Two managers of Stone Soup are represented by this package's planners on the same reward, which a test shows to choose
plans of the same value: its brute force by max-min without an adversary, its greedy by RATT with everyone as bait. The
seconds of both are Stone Soup's own: brute force's are those of one configuration times their number.
"""

from __future__ import annotations

import argparse
import datetime
import random
import time
from dataclasses import dataclass
from functools import partial
from itertools import product
from math import prod
from typing import Any

import numpy as np
from ordered_set import OrderedSet
from stonesoup.models.transition.linear import CombinedLinearGaussianTransitionModel, ConstantVelocity
from stonesoup.movable.grid import NStepDirectionalGridMovable
from stonesoup.platform import FixedPlatform
from stonesoup.predictor.kalman import KalmanPredictor
from stonesoup.sensor.radar.radar import RadarRotatingBearingRange
from stonesoup.sensormanager.base import GreedySensorManager, RandomSensorManager
from stonesoup.sensormanager.reward import UncertaintyRewardFunction
from stonesoup.types.groundtruth import GroundTruthState
from stonesoup.types.hypothesis import SingleHypothesis
from stonesoup.types.state import GaussianState, State, StateVector
from stonesoup.types.track import Track
from stonesoup.updater.kalman import ExtendedKalmanUpdater

from analysis.benchmarks.timing import best_seconds as best_seconds_by
from analysis.tables import append_csv, print_table
from ratt_opt import InformationInput, Problem, TraceObjective
from ratt_opt.interop.stonesoup import RobustSensorManager, WorstCaseAttacker
from ratt_opt.interop.stonesoup.nodes import options

START = datetime.datetime(2024, 1, 1)
SIDE, REACH, PROCESS_NOISE = 60.0, 60.0, 0.3
BLINDED, TARGETS = {3: 1, 4: 1, 10: 3}, {3: 4, 4: 5, 10: 8}
MAXMIN_SECONDS = {3: 1.0, 4: 1.0, 10: 0.3}
MANAGERS = ("ratt", "refined", "max-min", "brute force", "sequential greedy", "greedy", "random")
PREDICTOR = KalmanPredictor(CombinedLinearGaussianTransitionModel([ConstantVelocity(PROCESS_NOISE)] * 2))
UPDATER = ExtendedKalmanUpdater(None)
best_seconds = partial(best_seconds_by, clock=time.process_time)


@dataclass(frozen=True)
class Setting:
    """A number of platforms, the field of view [degrees], and whether the worst attack strikes at every step."""

    platforms: int
    view: int
    attacked: bool


def time_at(step: int) -> datetime.datetime:
    """The time of a step: one a second."""
    return START + datetime.timedelta(seconds=step)


def team(setting: Setting, rng: np.random.Generator) -> list[FixedPlatform]:
    """Platforms at random places, each with a radar and 13 actions."""
    found = []
    for _ in range(setting.platforms):
        radar = RadarRotatingBearingRange(
            position_mapping=(0, 2),
            ndim_state=4,
            noise_covar=np.diag([np.radians(1.0) ** 2, 0.5**2]),
            dwell_centre=StateVector([0.0]),
            rpm=30 if setting.view < 360 else 0,
            resolution=np.radians(30),
            max_range=REACH,
            fov_angle=np.radians(setting.view),
            seed=int(rng.integers(2**31)),
        )
        radar.timestamp = START
        place = [State(StateVector(rng.uniform(0, SIDE, 2)), timestamp=START)]
        if setting.view < 360:
            found.append(FixedPlatform(states=place, position_mapping=(0, 1), sensors=[radar]))
            continue
        grid = NStepDirectionalGridMovable(states=place, position_mapping=(0, 1), resolution=1.5, n_steps=3)
        found.append(FixedPlatform(movement_controller=grid, sensors=[radar]))
    return found


def manager_of(name: str, platforms: list[FixedPlatform]) -> Any:
    """One of ``MANAGERS`` for this team."""
    n = len(platforms)
    parts: dict[str, Any] = {"platforms": platforms, "predictor": PREDICTOR, "updater": UPDATER, "alpha_s": BLINDED[n]}
    if name in ("ratt", "refined"):
        return RobustSensorManager(method=name, **parts)
    if name == "max-min":
        return RobustSensorManager(method="maxmin", time_limit=MAXMIN_SECONDS[n], **parts)
    if name == "brute force":
        return RobustSensorManager(method="maxmin", time_limit=MAXMIN_SECONDS[n], **parts | {"alpha_s": 0})
    if name == "random":
        return RandomSensorManager(platforms=OrderedSet(platforms), sensors=OrderedSet())
    return RobustSensorManager(method="ratt", **parts | {"alpha_s": 0 if name == "sequential greedy" else n})


def mission(setting: Setting, name: str, seed: int, steps: int) -> tuple[float, float]:
    """Root mean square error [m] and seconds a step of one manager; the same seed is the same world."""
    rng, noise = np.random.default_rng([seed, setting.platforms, setting.view]), np.random.default_rng([seed, 1])
    platforms = team(setting, rng)
    manager = manager_of(name, platforms)
    attacker = WorstCaseAttacker(manager_of("ratt", platforms))
    truth = rng.uniform([0, -1, 0, -1], [SIDE, 1, SIDE, 1], (TARGETS[setting.platforms], 4))
    spread = np.diag([4.0, 1.0, 4.0, 1.0])
    tracks = [Track([GaussianState(rng.multivariate_normal(x, spread), spread, timestamp=START)]) for x in truth]
    model, errors, spent = PREDICTOR.transition_model, [], 0.0
    random.seed(seed)  # of Stone Soup's random manager
    for step in range(1, steps + 1):
        now = time_at(step)
        root = np.linalg.cholesky(model.covar(time_interval=datetime.timedelta(seconds=1)))
        truth = truth @ model.matrix(time_interval=datetime.timedelta(seconds=1)).T
        truth = truth + noise.normal(size=truth.shape) @ root.T
        began = time.process_time()
        (config,) = manager.choose_actions(tracks, now)
        spent += time.process_time() - began
        for actionable, actions in config.items():
            if actions:
                actionable.add_actions(actions)
        for platform in platforms:
            platform.act(now)
            platform.sensors[0].act(now)
        aftermath = attacker.attack(tracks, now) if setting.attacked else None
        seeing = [p.sensors[0] for p in platforms] if aftermath is None else aftermath.best.sensors
        _update(tracks, truth, seeing, now)
        found = np.array([np.asarray(track.state_vector, dtype=float)[[0, 2], 0] for track in tracks])
        errors.append(np.sum((found - truth[:, [0, 2]]) ** 2, axis=1))
    return float(np.sqrt(np.mean(errors))), spent / steps


def _update(tracks: list[Any], truth: Any, sensors: Any, now: datetime.datetime) -> None:
    """Update each track with what the sensors detect of its own target."""
    targets = OrderedSet([GroundTruthState(x, timestamp=now) for x in truth])
    states = {id(t): PREDICTOR.predict(track, timestamp=now) for t, track in zip(targets, tracks, strict=True)}
    for sensor in sensors:
        for detection in sensor.measure(targets):
            own = id(detection.groundtruth_path)
            states[own] = UPDATER.update(SingleHypothesis(states[own], detection))
    for target, track in zip(targets, tracks, strict=True):
        track.append(states[id(target)])


def projected_seconds(setting: Setting) -> dict[str, float]:
    """Seconds a step of Stone Soup's brute force and greedy manager with its own reward."""
    platforms = team(setting, np.random.default_rng(0))
    rng = np.random.default_rng(1)
    states = rng.uniform([0, -1, 0, -1], [SIDE, 1, SIDE, 1], (TARGETS[setting.platforms], 4))
    tracks = {Track([GaussianState(x, np.diag([4.0, 1, 4, 1]), timestamp=START)]) for x in states}
    reward = UncertaintyRewardFunction(PREDICTOR, UPDATER)
    members = [member for platform in platforms for member in (platform, platform.sensors[0])]
    every = {member: options(member, time_at(1)) for member in members}
    config = {member: own[rng.integers(len(own))] for member, own in every.items()}
    one = best_seconds(lambda: reward(config, tracks, time_at(1)))
    greedy = GreedySensorManager(platforms=set(platforms), reward_function=reward)
    return {
        "brute force": one * prod(map(len, every.values())),
        "greedy": best_seconds(lambda: greedy.choose_actions(tracks, time_at(1)), repeats=1),
    }


def rows_of(setting: Setting, managers: list[str], runs: int, steps: int) -> list[dict[str, Any]]:
    """One row for each manager; the first missions are flown once before, so that nothing is loaded while timed."""
    for name in managers:
        mission(setting, name, 0, 1)
    found = {name: np.array([mission(setting, name, seed, steps) for seed in range(runs)]) for name in managers}
    projected, greedy = projected_seconds(setting), found["sequential greedy"][:, 0]
    rows = []
    for name, values in found.items():
        errors = values[:, 0]
        apart = 100 * (errors - greedy) / greedy.mean()
        rows.append(
            {
                "platforms": setting.platforms,
                "view": setting.view,
                "attacker": "worst" if setting.attacked else "none",
                "manager": name,
                "rmse_m": errors.mean(),
                "interval": _interval(errors),
                "percent_of_greedy": apart.mean(),
                "its_interval": _interval(apart),
                "seconds_a_step": projected.get(name, values[:, 1].mean()),
            }
        )
    return rows


def _interval(values: np.ndarray) -> float:
    """Half of the 95 % interval of the mean."""
    return float(1.96 * values.std(ddof=1) / np.sqrt(len(values)))


def speeds() -> list[dict[str, Any]]:
    """Time the adapter and the model-free input, beside what they are compared with."""
    rows: list[dict[str, Any]] = []
    rng = np.random.default_rng(2)
    states = rng.uniform([0, -1, 0, -1], [SIDE, 1, SIDE, 1], (8, 4))
    tracks = [Track([GaussianState(x, np.diag([4.0, 1, 4, 1]), timestamp=START)]) for x in states]
    ten, four = team(Setting(10, 60, attacked=True), rng), team(Setting(4, 360, attacked=True), rng)
    for platform in four:  # five places, 25 turns
        platform.movement_controller.n_steps = 1
        platform.sensors[0].rpm, platform.sensors[0].fov_angle = 60, np.radians(60)
    for label, platforms in (("10 platforms of 13 actions", ten), ("4 platforms of 125 configurations", four)):
        for kind in (RadarRotatingBearingRange, OwnRadar):
            for platform in platforms:
                platform.sensors[0].__class__ = kind
            manager = manager_of("ratt", platforms)
            choices = tuple(tuple(options(a, time_at(1)) for a in node.actionables) for node in manager.nodes)
            seconds = best_seconds(partial(manager.step, manager.nodes, choices, tracks, time_at(1)))
            how = "any sensor" if kind is OwnRadar else "closed forms"
            rows.append({"what": f"problem of {label}, {how}", "seconds": seconds})
        for platform in platforms:
            platform.sensors[0].__class__ = RadarRotatingBearingRange
        for name in ("ratt", "refined"):
            manager = manager_of(name, platforms)
            seconds = best_seconds(partial(manager.choose_actions, tracks, time_at(1)))
            rows.append({"what": f"a step of {name}, {label}", "seconds": seconds})
    shapes = rng.normal(size=(520, 8, 2, 4))
    information = np.swapaxes(shapes, -1, -2) @ shapes
    parts: dict[str, Any] = {"prior": [4 * np.eye(4)] * 8, "information": information}
    owners: Any = np.arange(520) // 13
    rows.append(
        {
            "what": "Problem of 520 elements, 8 targets, d = 4",
            "seconds": best_seconds(lambda: Problem(TraceObjective(**parts), owners, None, 2, 0)),
        }
    )
    rows.append(
        {
            "what": "InformationInput of the same",
            "seconds": best_seconds(lambda: InformationInput(**parts, robot=owners, alpha_s=2, alpha_c=0)),
        }
    )
    return rows


class OwnRadar(RadarRotatingBearingRange):  # type: ignore[misc]
    """A class that the adapter does not know, so that it asks Stone Soup's objects."""


def main() -> None:
    """Fly the missions, measure the speeds, print both tables."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--platforms", type=int, nargs="+", choices=sorted(BLINDED), default=sorted(BLINDED))
    parser.add_argument("--views", type=int, nargs="+", default=[30, 60, 360])
    parser.add_argument("--attackers", nargs="+", choices=["worst", "none"], default=["worst", "none"])
    parser.add_argument("--runs", type=int, default=60)
    parser.add_argument("--steps", type=int, default=6)
    parser.add_argument("--managers", nargs="+", choices=MANAGERS, default=list(MANAGERS))
    parser.add_argument("--quick", action="store_true", help="2 runs of 2 steps")
    parser.add_argument("--log", help="append the rows to this CSV file as they are found")
    args = parser.parse_args()
    runs, steps = (2, 2) if args.quick else (args.runs, args.steps)
    managers = [name for name in MANAGERS if name in args.managers or name == "sequential greedy"]
    print_table("What the adapter costs", speeds())
    rows: list[dict[str, Any]] = []
    for platforms, view, attacker in product(args.platforms, args.views, args.attackers):
        found = rows_of(Setting(platforms, view, attacker == "worst"), managers, runs, steps)
        rows += found
        for row in found if args.log else ():
            append_csv(args.log, row)
        print_table(f"{platforms} platforms, {view} degrees, attacker {attacker}", found)
    print_table(f"{runs} missions of {steps} steps a row", rows)


if __name__ == "__main__":
    main()
