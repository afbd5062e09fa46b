"""Choice of the robots whose cameras run under attack: planners on the MRCLAM dataset, replayed.

``python -m analysis.missions.real_data --data FOLDER --trials 5``

Trials start at different times and believe the landmarks elsewhere at first; all planners fly every trial. The sensor
is fitted to the half of the dataset that is not replayed, and so is the drift by which landmarks are taken to move: the
one whose beliefs score best there, replayed without an attack.
"""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

import numpy as np

from ratt_opt.missions.replay.cameras import CAMERA_PLANNERS
from ratt_opt.missions.replay.fit_sensor import FittedSensor, fit_sensor, mrclam_residuals
from ratt_opt.missions.replay.replay import Replay, ReplaySettings, replay_mrclam
from ratt_opt.scenario.mrclam_reader import read_mrclam
from ratt_opt.studies.statistics import estimate

STEPS = 30
APART = 60.0
"""Time between the starts of two trials [s]."""
DRIFTS = (0.0, 0.005, 0.01, 0.02, 0.03, 0.05, 0.08)
"""Standard deviations to choose from, by which landmarks are taken to move in a step [m]."""


def training(folder: Path) -> tuple[FittedSensor, float]:
    """The sensor fitted to the second half of the dataset, and when that begins [s since all poses have begun]."""
    data = read_mrclam(folder)
    first = max(poses[0, 0] for poses in data.poses)
    middle = float(np.mean([(poses[0, 0] + poses[-1, 0]) / 2 for poses in data.poses]))
    return fit_sensor(mrclam_residuals(data, since=middle)), middle - first


def scores(folder: Path, trials: int, sensor: FittedSensor, begin: float) -> dict[float, float]:
    """Mean log score of each drift over the second half of attack-free replays that start after ``begin`` [s]."""
    found = {}
    for drift in DRIFTS:
        flown = []
        for trial in range(trials):
            settings = ReplaySettings(start=begin + APART * trial, drift_std=drift, seed=1000 + trial)
            flown.append(replay_mrclam(folder, steps=STEPS, attacker="none", sensor=sensor, settings=settings))
        found[drift] = float(np.mean([replay.log_score[STEPS // 2 :].mean() for replay in flown]))
    return found


def replays(folder: Path, trials: int, sensor: FittedSensor, drift: float) -> dict[str, list[Replay]]:
    """Every planner's replays under the exact attack, and RATT's without attack."""
    found: dict[str, list[Replay]] = {name: [] for name in (*CAMERA_PLANNERS, "ratt, no attack")}
    for trial in range(trials):
        settings = ReplaySettings(start=60.0 + APART * trial, drift_std=drift, seed=trial)
        for name in CAMERA_PLANNERS:
            found[name].append(replay_mrclam(folder, steps=STEPS, planner=name, sensor=sensor, settings=settings))
        free = replay_mrclam(folder, steps=STEPS, attacker="none", sensor=sensor, settings=settings)
        found["ratt, no attack"].append(free)
    return found


def table(folder: Path, trials: int) -> str:
    """RMSE over the second half of each replay, its difference from RATT's, and NEES, with 95 % intervals."""
    sensor, begin = training(folder)
    trained = scores(folder, trials, sensor, begin)
    chosen = max(trained, key=lambda drift: trained[drift])
    shown = ", ".join(f"{drift:g} m: {score:.3g}" for drift, score in trained.items())
    lines = [
        f"Mean log score on the training half by drift: {shown}. Chosen: {chosen:g} m.",
        "",
        "| taken to drift | planner | RMSE [m] | minus RATT's [m] | NEES of 2 |",
        "| --- | --- | --- | --- | --- |",
    ]
    for drift in dict.fromkeys((0.0, chosen)):
        found = replays(folder, trials, sensor, drift)
        errors = {name: np.array([r.rmse[STEPS // 2 :].mean() for r in flown]) for name, flown in found.items()}
        for name, flown in found.items():
            nees = estimate([float(r.nees[STEPS // 2 :].mean()) for r in flown])
            paired = estimate(errors[name] - errors["ratt"]).show() if name != "ratt" else ""
            row = (f"{drift:g} m", name, estimate(errors[name]).show(), paired, nees.show())
            lines.append(f"| {' | '.join(row)} |")
    return "\n".join(lines)


def main() -> int:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--data", type=Path, required=True, help="folder of the MRCLAM dataset")
    parser.add_argument("--trials", type=int, default=5)
    options = parser.parse_args()
    print(table(options.data, options.trials))
    return 0


if __name__ == "__main__":
    sys.exit(main())
