"""How robots and targets move in one sampling period."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from ratt_opt._validation import FloatArray

__all__ = ["move_robots", "predict_targets"]


def move_robots(poses: FloatArray, controls: FloatArray, period: float) -> FloatArray:
    """Unicycle poses after one period.

    The position moves along the heading held *before* the turn, as the paper has it: within one
    step the turn rate changes the heading only, hence only what a field of view or a
    bearing-dependent noise lets the robot measure.

    Parameters
    ----------
    poses : (..., 3) x [m], y [m], heading [rad]
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
    )
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
