"""Sensors with a height: a camera that looks down on the ground, and one that measures in three dimensions."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, ClassVar

import numpy as np

from ratt_opt._validation import check_number
from ratt_opt._values import ByValue
from ratt_opt.errors import InputError
from ratt_opt.scenario.sensor import bearing_of
from ratt_opt.scenario.sensors.model import SensorModel

if TYPE_CHECKING:
    from ratt_opt._validation import BoolArray, FloatArray

__all__ = ["SphericalSensor", "TiltedCamera"]


@dataclass(frozen=True, eq=False, repr=False)
class TiltedCamera(ByValue, SensorModel):
    """Bearing [rad] and depression below the horizon [rad] of a target on the ground, by a camera that looks down.

    ``tilt`` : depression of its axis [rad], ``pi / 2`` straight down; ``field_of_view`` : full angle of the cone of
    sight [rad]. It sees the cone's cut with the ground: a disk below it, or an ellipse ahead, whose place and size
    depend on the height. ``std`` : standard deviation of both angles [rad]. ``height`` : above the ground [m], if the
    robot's pose has none.
    """

    tilt: float = 0.8
    field_of_view: float = 1.0
    std: float = 0.01
    height: float | None = None
    size: ClassVar[int] = 2
    angles: ClassVar[tuple[int, ...]] = (0, 1)

    def __post_init__(self) -> None:
        for name in ("std", "field_of_view"):
            if not check_number(name, getattr(self, name)) > 0:
                raise InputError(name, "must be positive", getattr(self, name))
        check_number("tilt", self.tilt, low=0.0)

    def measure(self, poses: FloatArray, points: FloatArray) -> FloatArray:
        """(..., 2)."""
        apart = np.linalg.norm(points[..., :2] - poses[..., :2], axis=-1)
        depression = np.arctan2(self._height(poses), apart)
        return np.stack(np.broadcast_arrays(bearing_of(poses, points[..., :2]), depression), axis=-1)

    def noise(self, poses: FloatArray, points: FloatArray) -> FloatArray:
        """(..., 2) [rad^2]."""
        return np.full((*np.broadcast_shapes(poses.shape[:-1], points.shape[:-1]), 2), self.std**2)

    def sees(self, poses: FloatArray, points: FloatArray) -> BoolArray:
        """Tell which points are inside the cone about its axis."""
        bearing, depression = np.moveaxis(self.measure(poses, points), -1, 0)
        off = np.cos(depression) * np.cos(self.tilt) * np.cos(bearing) + np.sin(depression) * np.sin(self.tilt)
        return np.asarray(np.arccos(np.clip(off, -1.0, 1.0)) <= self.field_of_view / 2)

    def pointed_at(self, poses: FloatArray, measured: FloatArray) -> FloatArray:
        """(..., 2) the point of the ground in that direction."""
        angle = poses[..., 2] + measured[..., 0]
        apart = self._height(poses) / np.tan(np.maximum(measured[..., 1], 1e-6))
        return np.asarray(poses[..., :2] + apart[..., None] * np.stack([np.cos(angle), np.sin(angle)], axis=-1))

    def _height(self, poses: FloatArray) -> FloatArray:
        if poses.shape[-1] > 3:
            return np.asarray(poses[..., 3])
        if self.height is None:
            raise InputError("height", "must be given by the camera or by its robot (z)", None)
        return np.full(poses.shape[:-1], self.height)


@dataclass(frozen=True, eq=False, repr=False)
class SphericalSensor(ByValue, SensorModel):
    """Range [m], bearing [rad] and elevation above the horizon [rad] of a target with a height.

    ``range_std`` [m], ``angle_std`` [rad] : standard deviations; ``max_range`` [m] or ``None``. It reads heights, so
    missions and trackers need ``MissionModel(motion="constant velocity 3d")``.
    """

    range_std: float = 1.0
    angle_std: float = 0.01
    max_range: float | None = None
    size: ClassVar[int] = 3
    angles: ClassVar[tuple[int, ...]] = (1, 2)
    reads: ClassVar[int] = 6

    def __post_init__(self) -> None:
        for name in ("range_std", "angle_std"):
            if not check_number(name, getattr(self, name)) > 0:
                raise InputError(name, "must be positive", getattr(self, name))

    def measure(self, poses: FloatArray, points: FloatArray) -> FloatArray:
        """(..., 3)."""
        flat = np.linalg.norm(points[..., :2] - poses[..., :2], axis=-1)
        above = points[..., 4] - (poses[..., 3] if poses.shape[-1] > 3 else 0.0)
        parts = (np.hypot(flat, above), bearing_of(poses, points[..., :2]), np.arctan2(above, flat))
        return np.stack(np.broadcast_arrays(*parts), axis=-1)

    def noise(self, poses: FloatArray, points: FloatArray) -> FloatArray:
        """(..., 3) [m^2], [rad^2], [rad^2]."""
        shape = np.broadcast_shapes(poses.shape[:-1], points.shape[:-1])
        stds = np.array([self.range_std, self.angle_std, self.angle_std])
        return np.broadcast_to(stds**2, (*shape, 3))

    def sees(self, poses: FloatArray, points: FloatArray) -> BoolArray:
        """Tell which points are within the range."""
        limit = np.inf if self.max_range is None else self.max_range
        return np.asarray(self.measure(poses, points)[..., 0] <= limit)

    def fault(self, measured: FloatArray) -> str | None:
        """A range is not negative."""
        return "must have a range >= 0" if measured[0] < 0 else None
