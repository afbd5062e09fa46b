"""Range-and-bearing sensor: measurement, Jacobian, noise and information."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Annotated, Literal

import numpy as np
from pydantic import BeforeValidator, Field

from ratt_opt.errors import InputError
from ratt_opt.scenario.record import NonNegative, Positive, Record, plain

if TYPE_CHECKING:
    from ratt_opt._validation import BoolArray, FloatArray

__all__ = ["Sensor", "bearing_of", "jacobian", "measure", "variances_of", "wrap_angle"]


class Sensor(Record):
    """Noise and reach of a range-and-bearing sensor.

    With ``law = "variance"`` (the paper's), the *variances* are
    ``range_noise + range_noise_slope * r`` [m^2] and ``bearing_noise + bearing_noise_slope * |bearing|`` [rad^2].
    With ``law = "std"`` (real sensors), the same expressions give *standard deviations* [m], [rad].
    The constant terms keep the noise positive at range 0 and bearing 0; the paper's law would vanish there.

    The paper gives no coefficients. The defaults make one robot at the mean distance in the
    100 m square (52 m) about halve the uncertainty of a default target along its line of sight, so
    that the first and the thirtieth robot both matter; much smaller noise saturates the trace.

    ``max_range`` [m] and ``field_of_view`` (full angle about the heading [rad]) limit what is seen:
    a target outside gives no information. ``None`` means no limit.
    """

    law: Literal["variance", "std"] = "variance"
    range_noise: Positive = 0.5
    range_noise_slope: NonNegative = 0.2
    bearing_noise: Positive = 0.002
    bearing_noise_slope: NonNegative = 0.008
    max_range: Positive | None = None
    field_of_view: Annotated[float, Field(strict=True, gt=0, le=2 * math.pi), BeforeValidator(plain)] | None = None

    def noise_variances(self, distance: FloatArray, bearing: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Variances of the range [m^2] and bearing [rad^2] errors: two arrays of the same shape as the arguments."""
        of_range = self.range_noise + self.range_noise_slope * distance
        of_bearing = self.bearing_noise + self.bearing_noise_slope * np.abs(bearing)
        return (of_range, of_bearing) if self.law == "variance" else (of_range**2, of_bearing**2)

    def sees(self, distance: FloatArray, bearing: FloatArray) -> BoolArray:
        """Tell whether a target at this range and bearing is inside the reach."""
        seen = np.ones(np.shape(distance), dtype=np.bool_)
        if self.max_range is not None:
            seen &= distance <= self.max_range
        if self.field_of_view is not None:
            seen &= np.abs(bearing) <= self.field_of_view / 2
        return seen

    def information(self, poses: FloatArray, targets: FloatArray) -> FloatArray:
        """Information ``H^T R^{-1} H`` of one measurement from each pose of each target.

        Parameters
        ----------
        poses : (K, 3) x [m], y [m], heading [rad]
        targets : (M, 2) positions [m], none on top of a pose

        Returns
        -------
        (K, M, 2, 2) symmetric positive semidefinite [1/m^2]; zero outside the reach
        """
        measured = measure(poses[:, None], targets[None])
        distance, bearing = measured[..., 0], measured[..., 1]
        variance_r, variance_b = variances_of(self, distance, bearing)
        along, across = np.moveaxis(jacobian(poses[:, None], targets[None]), -2, 0)
        seen = self.sees(distance, bearing)
        weight_r, weight_b = np.where(seen, 1 / variance_r, 0.0), np.where(seen, 1 / variance_b, 0.0)
        return np.asarray(
            weight_r[..., None, None] * along[..., :, None] * along[..., None, :]
            + weight_b[..., None, None] * across[..., :, None] * across[..., None, :]
        )


def variances_of(sensor: Sensor, distance: FloatArray, bearing: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return a sensor's two variances, each of the shape of ``distance``; a class of one's own may return anything.

    InputError : they are not two, or of another shape.
    """
    found, shape = sensor.noise_variances(distance, bearing), np.shape(distance)
    name = f"noise_variances of {type(sensor).__name__}"
    rule = f"must be two arrays of shape {shape}, of range [m^2] and bearing [rad^2]"
    given = f"one array of shape {found.shape}" if isinstance(found, np.ndarray) else type(found).__name__
    is_array = isinstance(found, np.ndarray) and found.shape == (2, *shape)
    if not is_array and not (isinstance(found, (tuple, list)) and len(found) == 2):
        raise InputError(name, rule, given)
    try:
        of_range, of_bearing = (np.broadcast_to(np.asarray(part, dtype=np.float64), shape) for part in found)
    except (TypeError, ValueError):
        raise InputError(name, rule, [np.shape(part) for part in found]) from None
    return of_range, of_bearing


def wrap_angle(angle: FloatArray) -> FloatArray:
    """Wrap an angle to ``(-pi, pi]`` [rad]."""
    wrapped = np.pi - np.mod(np.pi - angle, 2 * np.pi)
    # Just above pi the remainder rounds to 2 pi, which would give the excluded end.
    return np.where(wrapped <= -np.pi, np.pi, wrapped)


def bearing_of(poses: FloatArray, targets: FloatArray) -> FloatArray:
    """Bearing of targets (..., 2) from poses (..., 3) in ``(-pi, pi]`` [rad], positive to the left."""
    delta = targets - poses[..., :2]
    return wrap_angle(np.arctan2(delta[..., 1], delta[..., 0]) - poses[..., 2])


def measure(poses: FloatArray, targets: FloatArray) -> FloatArray:
    """Noise-free range [m] and bearing [rad]: (..., 2). Source: ratt.tex, Section VI c)."""
    delta = targets - poses[..., :2]
    distance = np.hypot(delta[..., 0], delta[..., 1])
    return np.stack(np.broadcast_arrays(distance, bearing_of(poses, targets)), axis=-1)


def jacobian(poses: FloatArray, targets: FloatArray) -> FloatArray:
    """Derivative of :func:`measure` by the target's position: (..., 2, 2), rows range and bearing.

    The paper prints two more zero columns, which would need a four-dimensional target state;
    its targets have two, and so has this Jacobian.

    Source: ratt.tex, Section VI c).
    """
    delta = targets - poses[..., :2]
    squared = (delta**2).sum(axis=-1)
    distance = np.sqrt(squared)
    dx, dy = delta[..., 0], delta[..., 1]
    along = np.stack([dx / distance, dy / distance], axis=-1)
    across = np.stack([-dy / squared, dx / squared], axis=-1)
    return np.stack([along, across], axis=-2)
