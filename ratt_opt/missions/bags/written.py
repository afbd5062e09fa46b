"""Files of a replay: tables, a figure, and a log for viewers."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from ratt_opt._files import output_directory, write_json, write_together
from ratt_opt.missions.drawing.frames import MOST_LINKS
from ratt_opt.missions.drawing.log import save_frames
from ratt_opt.report.csv_file import write_csv
from ratt_opt.report.ellipses import ellipse_of
from ratt_opt.report.figure import save_figure
from ratt_opt.report.lettering import choose_fonts
from ratt_opt.running.interrupts import imported_whole

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

    from matplotlib.figure import Figure

    from ratt_opt.missions.bags.record import BagStep, ReplayedBag

__all__ = ["FILES", "write_replay"]

FILES = ("replay.json", "tracks.csv", "plans.csv", "skipped.csv", "replay.png", "replay.svg", "replay.mcap")
TRACKS = ("time", "target", "object", "x", "y", "covariance_xx", "covariance_xy", "covariance_yy", "vx", "vy")
PLANS = ("time", "robot", "name", "x", "y", "heading", "element", "control", "fallback")
SKIPPED = ("time", "robot", "target", "reason", "why")


def write_replay(replay: ReplayedBag, folder: str | Path) -> list[Path]:
    """Write all of ``FILES`` and return them. InputError : the folder cannot be written, or ``mcap`` is missing."""
    out = output_directory(folder, *FILES)
    figure, frames = _figure(replay), [_frame(k, step) for k, step in enumerate(replay.steps, start=1)]
    times = [step.time for step in replay.steps]
    numbers = [{"step": k, **row} for k, row in enumerate(_rows(replay), start=1)]
    writers = (
        lambda file: write_json(file, _document(replay)),
        lambda file: write_csv(file, TRACKS, _tracks(replay)),
        lambda file: write_csv(file, PLANS, _plans(replay)),
        lambda file: write_csv(file, SKIPPED, _skipped(replay)),
        lambda file: save_figure(figure, file),
        lambda file: save_figure(figure, file),
        lambda file: save_frames(file, frames, numbers, times),
    )
    return write_together(out, dict(zip(FILES, writers, strict=True)))


def _rows(replay: ReplayedBag) -> list[dict[str, Any]]:
    return [
        {
            "time": step.time,
            "measured": step.measured,
            "skipped": len(step.plan.skipped),
            "trace": step.belief.trace / max(len(step.targets), 1),
            "fallback": step.plan.fallback,
        }
        for step in replay.steps
    ]


def _document(replay: ReplayedBag) -> dict[str, Any]:
    return {
        "format": "ratt-opt replay",
        "version": 1,
        "n_robots": replay.scenario.n_robots,
        "objects": {str(j): name for j, name in sorted(replay.objects.items())},
        "steps": _rows(replay),
    }


def _tracks(replay: ReplayedBag) -> Iterator[tuple[object, ...]]:
    for step in replay.steps:
        for j, mean, spread in zip(step.targets, step.belief.mean, step.belief.position_covariance, strict=True):
            velocity = mean[2:4].tolist() if len(mean) > 3 else ["", ""]
            entries = (spread[0, 0], spread[0, 1], spread[1, 1])
            yield step.time, j, replay.objects.get(j, ""), *mean[:2].tolist(), *map(float, entries), *velocity


def _plans(replay: ReplayedBag) -> Iterator[tuple[object, ...]]:
    robots = replay.scenario.robots
    owner = np.arange(replay.scenario.n_robots)
    for step in replay.steps:
        labels = replay.scenario.control_labels(owner, step.controls)
        for i, (pose, element) in enumerate(zip(step.poses.tolist(), step.plan.elements.tolist(), strict=True)):
            yield step.time, i, robots[i].name, *pose[:3], element, labels[i], step.plan.fallback


def _skipped(replay: ReplayedBag) -> Iterator[tuple[object, ...]]:
    for step in replay.steps:
        for one in step.plan.skipped:
            yield step.time, one.measurement.robot, one.measurement.target, one.reason, one.why


def _frame(number: int, step: BagStep) -> dict[str, Any]:
    """The picture of one step; there is no truth in a bag."""
    return {
        "step": number,
        "robots": step.poses[:, :3].tolist(),
        "roles": ["best group"] * len(step.poses),
        "links": [list(link) for link in sorted(step.links)[:MOST_LINKS]],
        "cut": [],
        "targets": [],
        "estimates": step.belief.positions.tolist(),
        "ellipses": [ellipse_of(covariance) for covariance in step.belief.position_covariance],
    }


def _figure(replay: ReplayedBag) -> Figure:
    """Estimated tracks from above, and the uncertainty over time."""
    figure: Figure = imported_whole("matplotlib.figure").Figure(figsize=(9, 4.5), layout="constrained")
    plan, curve = figure.subplots(1, 2)
    for i in range(replay.scenario.n_robots):
        plan.plot(*np.array([step.poses[i, :2] for step in replay.steps]).T, color="0.6", linewidth=1)
    for j in sorted({j for step in replay.steps for j in step.targets}):
        rows = [step.belief.positions[step.targets.index(j)] for step in replay.steps if j in step.targets]
        plan.plot(*np.array(rows).T, marker=".", markersize=3, label=replay.objects.get(j) or f"target {j}")
    plan.set_aspect("equal", adjustable="datalim")
    plan.set(xlabel="x [m]", ylabel="y [m]")
    plan.legend(fontsize="small")
    rows = _rows(replay)
    begin = rows[0]["time"]
    curve.plot([row["time"] - begin for row in rows], [row["trace"] ** 0.5 for row in rows])
    curve.set(xlabel="time [s]", ylabel="what the filter states (root of the mean trace) [m]", ylim=(0, None))
    choose_fonts(figure)
    return figure
