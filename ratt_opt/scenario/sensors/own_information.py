"""A sensor that states its information about a position, as weights of a range and a bearing.

``H' W H = Y`` has one solution, ``W = H^-T Y H^-1``, because range and bearing together determine the position. With
``W`` the filter takes a measurement for exactly as much as the sensor states, and plans and filter agree.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.scenario.sensor import jacobian

if TYPE_CHECKING:
    from ratt_opt._validation import FloatArray
    from ratt_opt.scenario.sensor import Sensor

__all__ = ["stated_information", "stated_weights"]


def stated_information(sensor: Sensor, poses: FloatArray, points: FloatArray) -> FloatArray:
    """(..., 2, 2) information of the measurements of ``points`` (..., 2) from ``poses`` (..., 3), pair by pair."""
    shape = np.broadcast_shapes(poses.shape[:-1], points.shape[:-1])
    here = np.broadcast_to(poses, (*shape, poses.shape[-1])).reshape(-1, poses.shape[-1])
    there = np.broadcast_to(points, (*shape, 2)).reshape(-1, 2)
    told = [sensor.information(a[None], b[None])[0, 0] for a, b in zip(here, there, strict=True)]
    return np.array(told, dtype=np.float64).reshape(*shape, 2, 2)


def stated_weights(sensor: Sensor, poses: FloatArray, points: FloatArray) -> FloatArray:
    """(..., 2, 2) the weights of range and bearing that give the stated information."""
    inverse = np.linalg.inv(jacobian(poses, points))
    return np.asarray(np.swapaxes(inverse, -1, -2) @ stated_information(sensor, poses, points) @ inverse)
