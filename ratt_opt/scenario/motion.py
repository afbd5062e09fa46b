"""Motion of robots and targets in one sampling period."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from ratt_opt._validation import FloatArray

__all__ = ["fly_robots", "move_robots", "predict_targets", "white_acceleration"]


def move_robots(poses: FloatArray, controls: FloatArray, period: float) -> FloatArray:
    """Unicycle poses after one period.

    The position moves along the heading held *before* the turn, as the paper has it: within one
    step the turn rate changes the heading only, hence only what a field of view or a
    bearing-dependent noise lets the robot measure.

    Parameters
    ----------
    poses : (..., 3 or 4) x [m], y [m], heading [rad], height [m], which stays
    controls : (..., 2) speed [m/s], turn rate [rad/s]
    period : sampling period [s]

    Source: ratt.tex, Section VI a).
    """
    heading = poses[..., 2]
    step = period * controls[..., 0]
    moved = (
        poses[..., 0] + step * np.cos(heading),
        poses[..., 1] + step * np.sin(heading),
        heading + period * controls[..., 1],
        *np.moveaxis(poses[..., 3:], -1, 0),
    )
    return np.stack(np.broadcast_arrays(*moved), axis=-1)


def fly_robots(poses: FloatArray, controls: FloatArray, period: float) -> FloatArray:
    """Holonomic poses after one period: a robot moves in any direction of its own frame, whatever its heading.

    The velocity is turned with the heading in the middle of the step. A height changes if poses and controls have one.

    Parameters
    ----------
    poses : (..., 3 or 4) x [m], y [m], heading [rad], height [m]
    controls : (..., 2 to 4) velocity forward and to the left [m/s], turn rate [rad/s], climb rate [m/s]
    period : sampling period [s]
    """
    forward, left, turn, climb = (
        controls[..., k] if k < controls.shape[-1] else np.zeros(controls.shape[:-1]) for k in range(4)
    )
    middle = poses[..., 2] + period * turn / 2
    cosine, sine = np.cos(middle), np.sin(middle)
    moved = [
        poses[..., 0] + period * (forward * cosine - left * sine),
        poses[..., 1] + period * (forward * sine + left * cosine),
        poses[..., 2] + period * turn,
    ]
    if poses.shape[-1] > 3:
        moved.append(poses[..., 3] + period * climb)
    return np.stack(np.broadcast_arrays(*moved), axis=-1)


def predict_targets(positions: FloatArray, motions: FloatArray, period: float) -> FloatArray:
    """Predicted means after one period: ``y + period * speed * (cos a, sin a)`` with ``a = heading + period * turn``.

    The paper's "circular" motion is this with heading 0 and period 1 s; it has no heading state, so
    here the heading is a known parameter of the target. The motion does not depend on the
    position, so the covariance prediction is ``P + Q``.

    Parameters
    ----------
    positions : (M, 2) estimated positions [m]
    motions : (M, 3) speed [m/s], turn rate [rad/s], heading [rad]
    period : sampling period [s]

    Source: ratt.tex, Section VI b).
    """
    speed, turn, heading = motions.T
    angle = heading + period * turn
    return np.asarray(positions + (period * speed)[:, None] * np.stack([np.cos(angle), np.sin(angle)], axis=-1))


def white_acceleration(density: FloatArray, period: float) -> FloatArray:
    """(M, 4, 4) covariance of x, y, velocity after one period of white acceleration of these densities (M,) [m^2/s^3].

    Source: Bar-Shalom, Li, Kirubarajan, Estimation with Applications (2001), section 6.2.2.
    """
    shape = np.array([[period**3 / 3, period**2 / 2], [period**2 / 2, period]])
    return np.asarray(density[:, None, None] * np.kron(shape, np.eye(2)))
