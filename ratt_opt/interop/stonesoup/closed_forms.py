"""Stone Soup's own radars and its passive camera in closed form, for many poses and targets at once.

Equal to what the objects' measurement models, detectability tests and numerical Jacobians give, a hundred times faster.
With ``u`` the target's place in the sensor's axes, ``r = |(u_x, u_y)|`` and ``s = |u|``:

- bearing ``atan2(u_y, u_x)``, gradient ``(-u_y, u_x, 0) / r^2``;
- range ``r`` in the plane, gradient ``(u_x, u_y, 0) / r``, and ``s`` in space, gradient ``u / s``;
- elevation ``asin(u_z / s)``, gradient ``(-u_x u_z / r, -u_y u_z / r, r) / s^2``.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from stonesoup.sensor.passive import PassiveElevationBearing
from stonesoup.sensor.radar.radar import (
    RadarBearing,
    RadarBearingRange,
    RadarElevationBearingRange,
    RadarRotatingBearing,
    RadarRotatingBearingRange,
    RadarRotatingElevationBearingRange,
)

from ratt_opt.errors import InputError

if TYPE_CHECKING:
    from ratt_opt._validation import BoolArray, FloatArray

__all__ = ["information", "is_recognised", "linearised", "mapping_of"]

BEARING, ELEVATION_BEARING = ("bearing",), ("elevation", "bearing")
BEARING_RANGE, ELEVATION_BEARING_RANGE = ("bearing", "range"), ("elevation", "bearing", "range")
MEASURES: dict[type[Any], tuple[str, ...]] = {
    RadarBearing: BEARING,
    RadarRotatingBearing: BEARING,
    RadarBearingRange: BEARING_RANGE,
    RadarRotatingBearingRange: BEARING_RANGE,
    RadarElevationBearingRange: ELEVATION_BEARING_RANGE,
    RadarRotatingElevationBearingRange: ELEVATION_BEARING_RANGE,
    PassiveElevationBearing: ELEVATION_BEARING,
}
"""Quantities that each measures, in its noise's order. Subclasses may see otherwise, so only these count."""


def is_recognised(sensor: Any) -> bool:
    """Tell whether :func:`information` knows it: one of these classes exactly, without obstacles."""
    return type(sensor) in MEASURES and not getattr(sensor, "obstacles", None)


def information(sensor: Any, places: FloatArray, angles: FloatArray, means: FloatArray) -> FloatArray:
    """(..., M, D, D) information about targets at ``means`` (M, D); 0 for those that it does not detect.

    Parameters
    ----------
    places : (..., 2 or 3) where the sensor is; angles : (..., 3) roll, pitch and yaw of its axes [rad]

    Raises
    ------
    InputError : its noise covariance is singular.
    """
    _, matrix = linearised(sensor, places, angles, means)
    try:
        weight = np.linalg.inv(np.asarray(sensor.noise_covar, dtype=float))
    except np.linalg.LinAlgError:
        raise InputError(f"noise_covar of {type(sensor).__name__}", "must be invertible", sensor.noise_covar) from None
    told = np.swapaxes(matrix, -1, -2) @ weight @ matrix
    mapping = mapping_of(sensor)
    found = np.zeros((*told.shape[:-2], means.shape[1], means.shape[1]))
    found[..., np.array(mapping)[:, None], mapping] = told
    return found


def mapping_of(sensor: Any) -> list[int]:
    """The coordinates of a state on which its measurements depend."""
    mapping = list(sensor.mapping if isinstance(sensor, PassiveElevationBearing) else sensor.position_mapping)
    return mapping if "elevation" in MEASURES[type(sensor)] else mapping[:2]


def linearised(sensor: Any, places: FloatArray, angles: FloatArray, means: FloatArray) -> tuple[BoolArray, FloatArray]:
    """(..., M) which targets it detects; (..., M, q, p) the Jacobian of its measurements in those coordinates."""
    measures, mapping = MEASURES[type(sensor)], mapping_of(sensor)
    rotation = _rotations(angles)[..., : len(mapping)]
    u = np.einsum("...ij,...mj->...mi", rotation, means[:, mapping] - places[..., None, : len(mapping)])
    flat, far = np.hypot(u[..., 0], u[..., 1]), np.linalg.norm(u, axis=-1)
    distance = far if "elevation" in measures else flat
    with np.errstate(divide="ignore", invalid="ignore"):
        rows = {
            "bearing": np.stack([-u[..., 1], u[..., 0], 0 * flat], axis=-1) / flat[..., None] ** 2,
            "range": u * [1.0, 1.0, float("elevation" in measures)] / distance[..., None],
            "elevation": np.stack([-u[..., 0] * u[..., 2] / flat, -u[..., 1] * u[..., 2] / flat, flat], axis=-1)
            / far[..., None] ** 2,
        }
        matrix = np.stack([rows[name] for name in measures], axis=-2) @ rotation[..., None, :, :]
    # A target right at the sensor, or above it, has no bearing: nothing can be said of such a measurement.
    seen = _detects(sensor, u, flat, distance) & (flat > 0)
    return seen, np.where(seen[..., None, None], matrix, 0.0)


def _detects(sensor: Any, u: FloatArray, flat: FloatArray, distance: FloatArray) -> BoolArray:
    seen = distance <= getattr(sensor, "max_range", np.inf)
    view = getattr(sensor, "fov_angle", None)
    if view is not None:
        seen &= np.abs(np.arctan2(u[..., 1], u[..., 0])) <= float(view) / 2
    extent = getattr(sensor, "vertical_extent", None)
    if extent is not None:
        seen &= np.abs(np.arctan2(u[..., 2], flat)) <= float(extent) / 2
    return np.asarray(seen)


def _rotations(angles: FloatArray) -> FloatArray:
    """(..., 3, 3) ``rotx(-roll) roty(pitch) rotz(-yaw)``, as Stone Soup's ``build_rotation_matrix``."""
    (a, b, c), (sa, sb, sc) = (np.moveaxis(f(angles), -1, 0) for f in (np.cos, np.sin))
    zero, one = np.zeros_like(a), np.ones_like(a)

    def matrix(*rows: tuple[FloatArray, FloatArray, FloatArray]) -> FloatArray:
        return np.stack([np.stack(row, axis=-1) for row in rows], axis=-2)

    roll = matrix((one, zero, zero), (zero, a, sa), (zero, -sa, a))
    pitch = matrix((b, zero, sb), (zero, one, zero), (-sb, zero, b))
    yaw = matrix((c, sc, zero), (-sc, c, zero), (zero, zero, one))
    return roll @ pitch @ yaw
