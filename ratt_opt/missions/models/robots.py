"""How robots execute a control: the paper's way, or turning while they drive."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.errors import InputError
from ratt_opt.scenario.motion import move_robots

if TYPE_CHECKING:
    from collections.abc import Callable

    from ratt_opt._validation import FloatArray

    RobotMotion = Callable[[FloatArray, FloatArray, float], FloatArray]

__all__ = ["ROBOT_MOTIONS", "move_on_arcs", "robot_motion"]


def move_on_arcs(poses: FloatArray, controls: FloatArray, period: float) -> FloatArray:
    """Unicycle poses after one period of driving on an arc: the heading turns during the step.

    Parameters
    ----------
    poses : (..., 3) x [m], y [m], heading [rad]
    controls : (..., 2) speed [m/s], turn rate [rad/s]
    period : sampling period [s]

    Source: Thrun, Burgard, Fox, Probabilistic Robotics (2005), eq. 5.9; the chord of the arc is written with
    ``sin(a) / a``, which has no singularity at turn rate 0.
    """
    half = period * controls[..., 1] / 2
    chord = period * controls[..., 0] * np.sinc(half / np.pi)
    moved = (
        poses[..., 0] + chord * np.cos(poses[..., 2] + half),
        poses[..., 1] + chord * np.sin(poses[..., 2] + half),
        poses[..., 2] + 2 * half,
    )
    return np.stack(np.broadcast_arrays(*moved), axis=-1)


ROBOT_MOTIONS: dict[str, RobotMotion] = {"paper": move_robots, "arc": move_on_arcs}
"""``"paper"`` moves along the heading held before the turn."""


def robot_motion(name: str) -> RobotMotion:
    """The motion of that name. InputError : there is none."""
    if name not in ROBOT_MOTIONS:
        raise InputError("robot_motion", f"must be {' or '.join(ROBOT_MOTIONS)}", name)
    return ROBOT_MOTIONS[name]
