"""Gain from the gate: ``python -m analysis.gates [MRCLAM FOLDER]``.

Ranges of ultra-wideband anchors to a moving tag, 10 % of them metres too long (reflections, as in the libRSF data), and
sightings of MRCLAM's landmarks with misread labels: error of the tracker with the gate and without.
"""

from __future__ import annotations

import sys
from dataclasses import dataclass

import numpy as np

import ratt_opt as ro
from ratt_opt.scenario.mrclam import from_mrclam
from ratt_opt.scenario.mrclam_labels import pose_at
from ratt_opt.scenario.mrclam_reader import read_mrclam

STILL = ((0.0, 0.0),)


@dataclass(frozen=True, slots=True)
class Settings:
    """``runs`` of ``steps`` at ``period`` [s]; ``share`` of ranges are longer by ``excess`` [m] on average.

    ``seconds`` : of MRCLAM; ``misread`` : share of its sightings that name another landmark.
    """

    runs: int = 20
    steps: int = 100
    period: float = 0.1
    share: float = 0.1
    excess: float = 4.0
    seconds: int = 120
    misread: float = 0.02


def uwb(gate: float | None, seed: int, s: Settings) -> tuple[float, float]:
    """RMS and largest error of a tag among four anchors [m]."""
    rng = np.random.default_rng(seed)
    sensor = ro.RangeOnly(ro.Sensor(range_noise=0.01, range_noise_slope=0.0))
    anchors = [ro.Robot(x=x, y=y, controls=STILL) for x, y in ((0, 0), (20, 0), (20, 15), (0, 15))]
    tag = ro.Target(x=8.0, y=6.0, speed=0.8, heading=0.3, velocity_std=0.3, process_noise=0.3)
    team = ro.Scenario(
        robots=tuple(anchors), targets=(tag,), sensor=sensor, alpha_s=0, alpha_c=0, sampling_period=s.period
    )
    tracker = ro.Tracker(team, model=ro.MissionModel(motion="constant velocity"), gate=gate)
    motion, state, errors = tracker.world.motion, tracker.beliefs.mean.copy(), []
    for k in range(s.steps):
        if k:
            state = motion.predict(state, s.period, 0.0)
            state = state + rng.multivariate_normal(np.zeros(4), motion.noise(s.period)[0])
        ranges = np.linalg.norm(team.poses[:, :2] - state[0, :2], axis=1) + rng.normal(size=4) * 0.1
        wild = rng.random(4) < s.share
        ranges = ranges + wild * rng.exponential(s.excess, 4)
        tracker.step([ro.Measurement(i, 0, (float(z),)) for i, z in enumerate(ranges)], now=s.period * k)
        errors.append(np.linalg.norm(tracker.beliefs.positions[0] - state[0, :2]))
    return float(np.sqrt(np.mean(np.square(errors)))), float(np.max(errors))


def mrclam(folder: str, gate: float | None, s: Settings) -> tuple[float, float]:
    """RMS error over the landmarks at the end, and the largest of one [m]; real sightings, some labels misread."""
    data, rng = read_mrclam(folder), np.random.default_rng(0)
    team = from_mrclam(data, 60.0, alpha_s=0, alpha_c=0, sensor=ro.fit_sensor(data), sampling_period=1.0)
    begin = max(poses[0, 0] for poses in data.poses) + 60.0
    subjects = sorted(data.landmarks)
    truth = np.array([data.landmarks[j] for j in subjects])
    moved = truth + rng.normal(size=truth.shape) * 0.5
    targets = [
        t.replace(x=float(x), y=float(y), covariance=((0.25, 0.0), (0.0, 0.25)), process_std=0.01)
        for t, (x, y) in zip(team.targets, moved, strict=True)
    ]
    tracker = ro.Tracker(team.replace(targets=targets), gate=gate)
    for k in range(s.seconds):
        end, made = begin + k, []
        poses = np.concatenate([pose_at(poses, np.array([end])) for poses in data.poses])
        for i, rows in enumerate(data.measurements):
            last = {
                data.subject_of[int(code)]: (distance, bearing)
                for time, code, distance, bearing in rows
                if end - 0.1 < time <= end and data.subject_of.get(int(code), -1) in data.landmarks
            }
            for subject, values in last.items():
                j = subjects.index(subject) if rng.random() > s.misread else int(rng.integers(len(subjects)))
                made.append(ro.Measurement(i, j, values))
        tracker.step(made, now=float(k), poses=poses)
    errors = np.linalg.norm(tracker.beliefs.positions - truth, axis=1)
    return float(np.sqrt(np.mean(errors**2))), float(errors.max())


def main() -> None:
    """Print a line for each data set."""
    s = Settings()
    for name, gate in (("gate 0.999", 0.999), ("no gate", None)):
        rows = np.array([uwb(gate, seed, s) for seed in range(s.runs)])
        print(f"UWB, {name}: RMS {np.sqrt((rows[:, 0] ** 2).mean()):.3f} m, largest error {rows[:, 1].max():.2f} m")
        for folder in sys.argv[1:]:
            rms, largest = mrclam(folder, gate, s)
            print(f"MRCLAM, {name}: RMS {rms:.3f} m at the end, largest {largest:.2f} m")


if __name__ == "__main__":
    main()
