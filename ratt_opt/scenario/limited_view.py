"""Random teams of cameras or radars that turn: each robot must choose what to look at."""

from __future__ import annotations

import math
from itertools import count
from typing import TYPE_CHECKING

import networkx as nx
import numpy as np

from ratt_opt._validation import check_integer
from ratt_opt.errors import InputError
from ratt_opt.scenario.model import Robot, Scenario, Target
from ratt_opt.scenario.problem_record import MOST_ENTRIES, MOST_ROBOTS
from ratt_opt.scenario.sensor import Sensor

if TYPE_CHECKING:
    from collections.abc import Sequence

__all__ = ["SENSORS", "demo_scenario", "limited_view_scenario"]

SENSORS = {
    "camera": Sensor(law="std", range_noise=0.3, range_noise_slope=0.02, bearing_noise=0.01, bearing_noise_slope=0.0),
    "radar": Sensor(law="std", range_noise=0.2, range_noise_slope=0.0, bearing_noise=0.03, bearing_noise_slope=0.0),
}
"""A stereo camera (0.6 degrees; depth to 2 % and 0.3 m) and a small radar (0.2 m; 1.7 degrees)."""


def limited_view_scenario(
    n_robots: int,
    n_targets: int,
    *,
    alpha_s: int,
    alpha_c: int,
    seed: int,
    view: float = 60,
    reach: float | None = None,
    headings: int = 8,
    communication_range: float | None = None,
    sensor: str | Sensor = "camera",
    prior_std: float = 3.0,
    process_std: float = 0.5,
    speeds: Sequence[float] = (0.0, 2.0),
    target_speed: float = 0.5,
    side: float = 60.0,
    crowd: int = 10,
) -> Scenario:
    """Draw a team with limited views: each robot must choose what to look at.

    A control is a speed and one of ``headings`` equal turns of the full circle; the robot drives along
    its old heading and looks along the new one. Robots and slow targets stand uniformly in a square, which
    grows with large teams so that each robot has as much area. They come from two child streams of
    ``SeedSequence(seed)``, one number after the other.

    Parameters
    ----------
    n_robots, n_targets : N, M >= 1
    alpha_s, alpha_c : robots that may be blinded, links that may be cut
    seed : integer >= 0
    view : full angle that a sensor sees about its robot's heading [degrees], in (0, 360]
    reach : distance up to which a sensor sees [m]; no limit if ``None``
    headings : directions in which a robot can look after a step
    communication_range : robots within this distance are linked [m]; all are if ``None``
    sensor : ``"camera"`` (precise bearing), ``"radar"`` (precise range), or a :class:`Sensor` whose noise is taken
    prior_std, process_std : standard deviation per axis of each target's estimate and motion noise [m]
    speeds : of a robot's controls [m/s]: it stands or drives by default
    target_speed : up to which targets move [m/s]; much slower than robots, so that views matter more than ways
    side : of the square [m] for up to ``crowd`` robots; more robots have as much area each

    Raises
    ------
    InputError : a number is out of range, or no robot can see any target.
    """
    n_robots = check_integer("n_robots", n_robots, low=1, high=MOST_ROBOTS)
    n_targets = check_integer("n_targets", n_targets, low=1)
    headings = check_integer("headings", headings, low=1)
    crowd = check_integer("crowd", crowd, low=1)
    for name, value in (("target_speed", target_speed), ("side", side)):
        if not (_is_number(value) and 0 < value < math.inf):
            raise InputError(name, "must be a finite number > 0", value)
    if not len(speeds):
        raise InputError("speeds", "must hold a speed", speeds)
    if 4 * n_robots * len(speeds) * headings * n_targets > MOST_ENTRIES:
        rule = f"must have at most {MOST_ENTRIES} entries in all information matrices with {n_robots} robots"
        raise InputError("n_targets", rule, n_targets)
    limited = _limited(sensor, _checked_view(view), reach)
    robots_seed, targets_seed = np.random.SeedSequence(check_integer("seed", seed, low=0)).spawn(2)
    robots, targets = np.random.default_rng(robots_seed), np.random.default_rng(targets_seed)
    side *= math.sqrt(max(1.0, n_robots / crowd))
    controls = tuple((speed, turn) for speed in speeds for turn in _turns(headings))
    scenario = Scenario(
        robots=tuple(_robot(robots, side, controls) for _ in range(n_robots)),
        targets=tuple(_target(targets, side, target_speed, (prior_std, process_std)) for _ in range(n_targets)),
        sensor=limited,
        alpha_s=alpha_s,
        alpha_c=alpha_c,
        communication_range=communication_range,
    )
    if not scenario.information.any():
        raise InputError("view and reach", "must let a robot see a target", f"{view} degrees, {_told(reach)}")
    return scenario


def demo_scenario() -> Scenario:
    """Six cameras that turn, six targets; two robots may be blinded and four links cut.

    The seed is the first from 0 on whose network is connected and whose targets can all be seen by some robot.
    """
    return next(scenario for seed in count() if _is_whole(scenario := _demo(seed)))


def _demo(seed: int) -> Scenario:
    return limited_view_scenario(6, 6, alpha_s=2, alpha_c=4, seed=seed, view=60, reach=40, communication_range=45)


def _is_whole(scenario: Scenario) -> bool:
    connected = scenario.graph is None or nx.is_connected(scenario.graph)
    return connected and bool(scenario.information.any(axis=(0, 2, 3)).all())


def _checked_view(view: float) -> float:
    """The view in radians."""
    if not (_is_number(view) and 0 < view <= 360):
        raise InputError("view", "must be in (0, 360] degrees", view)
    return min(math.radians(view), 2 * math.pi)


def _is_number(value: object) -> bool:
    return isinstance(value, (int, float, np.integer, np.floating)) and not isinstance(value, bool)


def _limited(sensor: str | Sensor, view: float, reach: float | None) -> Sensor:
    if isinstance(sensor, str) and sensor not in SENSORS:
        raise InputError("sensor", f"must be {', '.join(SENSORS)} or a Sensor", sensor)
    noise = SENSORS[sensor] if isinstance(sensor, str) else sensor
    if reach is not None and not (_is_number(reach) and 0 < reach < math.inf):
        raise InputError("reach", "must be a finite number > 0 [m], or None", reach)
    return noise.replace(field_of_view=view, max_range=None if reach is None else float(reach))


def _turns(headings: int) -> list[float]:
    """Turn rates [rad/s] that end in ``headings`` equally spaced directions after a period of 1 s: none, then left and
    right, ever further."""
    steps = [0, *(sign * k for k in range(1, headings // 2 + 1) for sign in (1, -1))][:headings]
    return [2 * math.pi * k / headings for k in steps]


def _robot(rng: np.random.Generator, side: float, controls: Sequence[tuple[float, float]]) -> Robot:
    x, y, heading = side * float(rng.random()), side * float(rng.random()), 2 * math.pi * float(rng.random())
    return Robot(x=x, y=y, heading=heading, controls=tuple(controls))


def _target(rng: np.random.Generator, side: float, speed: float, stds: tuple[float, float]) -> Target:
    prior_std, process_std = stds
    if not prior_std > 0:
        raise InputError("prior_std", "must be positive", prior_std)
    variance = float(prior_std) ** 2
    return Target(
        x=side * float(rng.random()),
        y=side * float(rng.random()),
        covariance=((variance, 0.0), (0.0, variance)),
        speed=speed * float(rng.random()),
        heading=2 * math.pi * float(rng.random()),
        process_std=process_std,
    )


def _told(reach: float | None) -> str:
    return "no limit" if reach is None else f"{reach} m"
