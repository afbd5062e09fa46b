"""Random scenarios of Section VI of the paper, reproducible across machines."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ratt_opt._validation import check_integer
from ratt_opt.errors import InputError
from ratt_opt.scenario.model import DEFAULT_CONTROLS, Robot, Scenario, Target
from ratt_opt.scenario.problem_record import MOST_ENTRIES, MOST_ROBOTS
from ratt_opt.scenario.sensor import Sensor

if TYPE_CHECKING:
    from collections.abc import Sequence

__all__ = ["random_scenario"]


def random_scenario(
    n_robots: int,
    n_targets: int,
    *,
    alpha_s: int,
    alpha_c: int,
    seed: int,
    side: float = 100.0,
    prior_std: float = 3.0,
    process_std: float = 0.5,
    sensor: Sensor | None = None,
    controls: Sequence[tuple[float, float]] = DEFAULT_CONTROLS,
    communication_range: float | None = None,
    target_speeds: Sequence[float] = (5 / 3, -5 / 3, 5 / 2, -5 / 2, 5.0, -5.0),
    target_turn_rates: Sequence[float] = (1 / 10, 1 / 20, 1 / 30),
) -> Scenario:
    """Draw robots and targets uniformly in a square, headings zero, as the paper's trials do.

    Robots and targets come from two child streams of ``SeedSequence(seed)``, one number after the
    other: with the same seed a larger team has the same first robots.

    Parameters
    ----------
    n_robots, n_targets : N, M >= 1
    alpha_s, alpha_c : robots that may be blinded, links that may be cut
    seed : integer >= 0
    side : side of the square [m]
    prior_std, process_std : standard deviation per axis of each target's estimate and motion noise [m]
    sensor : noise and reach; the default sensor if ``None``
    controls : (speed [m/s], turn rate [rad/s]) pairs of every robot
    communication_range : robots within this distance are linked [m]; all are if ``None``
    target_speeds, target_turn_rates : [m/s] and [rad/s], of which each target has one; the paper's by default

    Raises
    ------
    InputError : a number is out of range.

    Source: ratt.tex, Section VI.
    """
    n_robots = check_integer("n_robots", n_robots, low=1)
    if n_robots > MOST_ROBOTS:
        raise InputError("n_robots", f"must be at most {MOST_ROBOTS}", n_robots)
    n_targets = check_integer("n_targets", n_targets, low=1)
    if 4 * n_robots * len(controls) * n_targets > MOST_ENTRIES:
        rule = f"must have at most {MOST_ENTRIES} entries in all information matrices with {n_robots} robots"
        raise InputError("n_targets", rule, n_targets)
    if not (len(target_speeds) and len(target_turn_rates)):
        raise InputError("target_speeds", "and target_turn_rates must hold a number each", "none")
    for name, value in (("side", side), ("prior_std", prior_std)):
        if not value > 0:
            raise InputError(name, "must be positive", value)
    robots_seed, targets_seed = np.random.SeedSequence(check_integer("seed", seed, low=0)).spawn(2)
    robots, targets = np.random.default_rng(robots_seed), np.random.default_rng(targets_seed)
    stds, motions = (prior_std, process_std), (target_speeds, target_turn_rates)
    return Scenario(
        robots=tuple(
            Robot(x=_place(robots, side), y=_place(robots, side), controls=tuple(controls)) for _ in range(n_robots)
        ),
        targets=tuple(_target(targets, side, stds, motions) for _ in range(n_targets)),
        sensor=sensor or Sensor(),
        alpha_s=alpha_s,
        alpha_c=alpha_c,
        communication_range=communication_range,
    )


def _place(rng: np.random.Generator, side: float) -> float:
    return side * float(rng.random())


def _target(
    rng: np.random.Generator, side: float, stds: tuple[float, float], motions: tuple[Sequence[float], Sequence[float]]
) -> Target:
    (prior_std, process_std), (speeds, turn_rates) = stds, motions
    variance = prior_std**2
    return Target(
        x=_place(rng, side),
        y=_place(rng, side),
        covariance=((variance, 0.0), (0.0, variance)),
        speed=speeds[int(rng.random() * len(speeds))],
        turn_rate=turn_rates[int(rng.random() * len(turn_rates))],
        process_std=process_std,
    )
