"""Radars that see how fast a target comes nearer, in the plane."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, ClassVar

import numpy as np

from ratt_opt._validation import check_number
from ratt_opt._values import ByValue
from ratt_opt.errors import InputError
from ratt_opt.scenario.sensor import bearing_of, jacobian, measure
from ratt_opt.scenario.sensors.model import SensorModel

if TYPE_CHECKING:
    from ratt_opt._validation import BoolArray, FloatArray

__all__ = ["DopplerRadar"]


@dataclass(frozen=True, eq=False, repr=False)
class DopplerRadar(ByValue, SensorModel):
    """Range [m], bearing [rad] and range rate [m/s] over ground (the radar's own motion is taken out).

    ``range_std`` [m], ``bearing_std`` [rad], ``rate_std`` [m/s] : standard deviations; ``max_range`` [m] and
    ``field_of_view`` (full angle [rad]) : reach, ``None`` for no limit. It reads velocities, so missions and trackers
    need a motion that estimates them, such as ``MissionModel(motion="constant velocity")``.
    """

    range_std: float = 1.0
    bearing_std: float = 0.02
    rate_std: float = 0.2
    max_range: float | None = None
    field_of_view: float | None = None
    size: ClassVar[int] = 3
    angles: ClassVar[tuple[int, ...]] = (1,)
    reads: ClassVar[int] = 4

    def __post_init__(self) -> None:
        for name in ("range_std", "bearing_std", "rate_std"):
            if not check_number(name, getattr(self, name)) > 0:
                raise InputError(name, "must be positive", getattr(self, name))

    def measure(self, poses: FloatArray, points: FloatArray) -> FloatArray:
        """(..., 3)."""
        apart = points[..., :2] - poses[..., :2]
        rate = (apart * points[..., 2:4]).sum(axis=-1) / np.linalg.norm(apart, axis=-1)
        return np.concatenate([measure(poses, points[..., :2]), rate[..., None]], axis=-1)

    def jacobian(self, poses: FloatArray, points: FloatArray) -> FloatArray:
        """(..., 3, 4)."""
        apart = points[..., :2] - poses[..., :2]
        velocity = np.broadcast_to(points[..., 2:4], apart.shape)
        distance = np.linalg.norm(apart, axis=-1, keepdims=True)
        along = apart / distance
        across = (velocity - (velocity * along).sum(axis=-1, keepdims=True) * along) / distance
        slope = np.zeros((*apart.shape[:-1], 3, 4))
        slope[..., :2, :2] = jacobian(poses, points[..., :2])
        slope[..., 2, :2], slope[..., 2, 2:] = across, along
        return slope

    def noise(self, poses: FloatArray, points: FloatArray) -> FloatArray:
        """(..., 3) [m^2], [rad^2], [m^2/s^2]."""
        shape = np.broadcast_shapes(poses.shape[:-1], points.shape[:-1])
        stds = np.array([self.range_std, self.bearing_std, self.rate_std])
        return np.broadcast_to(stds**2, (*shape, 3))

    def sees(self, poses: FloatArray, points: FloatArray) -> BoolArray:
        """Tell which points are within the range and the field of view."""
        apart = np.linalg.norm(points[..., :2] - poses[..., :2], axis=-1)
        seen = apart <= (np.inf if self.max_range is None else self.max_range)
        if self.field_of_view is not None:
            seen = seen & (np.abs(bearing_of(poses, points[..., :2])) <= self.field_of_view / 2)
        return np.asarray(seen)

    def pointed_at(self, poses: FloatArray, measured: FloatArray) -> FloatArray:
        """(..., 2) at the measured range and bearing."""
        angle = poses[..., 2] + measured[..., 1]
        return np.asarray(poses[..., :2] + measured[..., :1] * np.stack([np.cos(angle), np.sin(angle)], axis=-1))

    def fault(self, measured: FloatArray) -> str | None:
        """A range is not negative."""
        return "must have a range >= 0" if measured[0] < 0 else None
