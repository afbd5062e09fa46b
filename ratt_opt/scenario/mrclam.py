"""A scenario from one instant of the MRCLAM dataset: five real robots among fifteen landmarks."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.errors import InputError
from ratt_opt.scenario.model import Robot, Scenario, Target
from ratt_opt.scenario.mrclam_labels import pose_at
from ratt_opt.scenario.mrclam_reader import MrclamData, opened_mrclam
from ratt_opt.scenario.sensor import Sensor

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence
    from pathlib import Path

    from ratt_opt._validation import FloatArray

__all__ = ["CREATE_CONTROLS", "MRCLAM_SENSOR", "from_mrclam"]

MRCLAM_SENSOR = Sensor(
    law="std",
    range_noise=0.0107,
    range_noise_slope=0.0404,
    bearing_noise=0.009,
    bearing_noise_slope=0.0,
    max_range=9.25,
    field_of_view=1.18,
)
"""Held-out fit to dataset 1: range standard deviation 0.0107 m + 0.0404 r, bearing 0.009 rad at any
bearing; the camera's longest sighting is 9.25 m and its widest 0.59 rad to either side."""

CREATE_CONTROLS = tuple((speed, turn) for speed in (0.0, 0.08) for turn in (0.0, 0.25, -0.25, 0.5, -0.5))
"""Speed [m/s] and turn rate [rad/s] within what the iRobot Create robots were commanded in dataset 1:
at most 0.086 m/s forward, never backward, and 0.57 rad/s to either side."""

LONGEST_GAP = 2.0
"""Poses are interpolated between rows at most this far apart [s]."""


def from_mrclam(
    directory: str | Path | MrclamData,
    time: float,
    *,
    alpha_s: int,
    alpha_c: int,
    corrections: Mapping[int, int] | None = None,
    sensor: Sensor = MRCLAM_SENSOR,
    controls: Sequence[tuple[float, float]] = CREATE_CONTROLS,
    prior_std: float = 0.3,
    sampling_period: float = 2.0,
) -> Scenario:
    """Build a scenario from the robots' poses at one instant, with the landmarks as targets.

    The landmarks were surveyed to less than a millimetre; ``prior_std`` is what the team is *taken* to know
    of them before it measures (0.3 m, two or three times a single sighting's range error). They do not move.
    Two seconds let a robot turn by up to 1 rad, past the edge of its view, so that controls differ in what they see.

    Parameters
    ----------
    directory : dataset folder, see :func:`read_mrclam`, or the dataset
    time : Unix time, or seconds since every robot's poses have begun [s]
    alpha_s, alpha_c : robots that may be blinded, links that may be cut
    corrections : label errors to correct, empty for none; by default the sightings decide, see :func:`read_mrclam`.
        The scenario's notes say which labelling is used, and how many sightings fit.
    sensor, controls, prior_std [m], sampling_period [s] : parameters of the scenario

    Raises
    ------
    FileFormatError : a file is missing or malformed.
    InputError : the time is outside the poses or in a gap, or the corrections are no permutation.
    """
    if not prior_std > 0:
        raise InputError("prior_std", "must be positive", prior_std)
    data = opened_mrclam(directory, corrections)
    instant = _instant(data, time)
    variance = prior_std**2
    landmarks = sorted(data.landmarks.items())
    return Scenario(
        robots=tuple(_robot(k, poses, instant, tuple(controls)) for k, poses in enumerate(data.poses)),
        targets=tuple(
            Target(x=x, y=y, covariance=((variance, 0.0), (0.0, variance)), process_std=0.0, name=f"landmark {subject}")
            for subject, (x, y) in landmarks
        ),
        sensor=sensor,
        sampling_period=sampling_period,
        alpha_s=alpha_s,
        alpha_c=alpha_c,
        notes=_notes(data, instant),
    )


def _instant(data: MrclamData, time: float) -> float:
    first = max(poses[0, 0] for poses in data.poses)
    last = min(poses[-1, 0] for poses in data.poses)
    instant = first + time if time < 1e8 else time  # a Unix time: the dataset is from 2009
    if not first <= instant <= last:
        rule = f"must be in [0, {last - first:.3f}] seconds since the start, or in [{first:.3f}, {last:.3f}] Unix time"
        raise InputError("time", rule, time)
    return float(instant)


def _robot(number: int, poses: FloatArray, instant: float, controls: tuple[tuple[float, float], ...]) -> Robot:
    after = min(int(np.searchsorted(poses[:, 0], instant)), len(poses) - 1)
    before = max(after - 1, 0)
    if poses[after, 0] - poses[before, 0] > LONGEST_GAP and poses[after, 0] != instant:
        rule = f"must not fall between poses more than {LONGEST_GAP} s apart (robot {number + 1})"
        raise InputError("time", rule, f"{instant:.3f}")
    x, y, heading = pose_at(poses, np.array([instant]))[0].tolist()
    return Robot(x=x, y=y, heading=heading, controls=controls, name=f"robot {number + 1}")


def _notes(data: MrclamData, instant: float) -> tuple[str, ...]:
    codes = np.concatenate([rows[:, 1] for rows in data.measurements]).astype(int)
    unlisted = [int(code) for code in codes if int(code) not in data.subject_of]
    notes = [f"MRCLAM poses at Unix time {instant:.3f} s from {', '.join(data.pose_files)}", data.labels]
    if data.inapplicable:
        table = ", ".join(f"{named} means {meant}" for named, meant in sorted(data.inapplicable.items()))
        notes.append(f"label corrections not applied, their subjects are not in this set: {table}")
    if unlisted:
        notes.append(f"{len(unlisted)} measurements with unlisted barcodes ignored: {sorted(set(unlisted))}")
    return tuple(notes)
