"""The position itself as a measurement."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, ClassVar

import numpy as np

from ratt_opt._values import ByValue
from ratt_opt.errors import InputError
from ratt_opt.scenario.sensors.model import SensorModel

if TYPE_CHECKING:
    from ratt_opt._validation import BoolArray, FloatArray

__all__ = ["PositionSensor"]


@dataclass(frozen=True, eq=False, repr=False)
class PositionSensor(ByValue, SensorModel):
    """The position x, y [m] itself, with standard deviation ``std`` per axis [m]; ``max_range`` [m] or ``None``."""

    std: float = 1.0
    max_range: float | None = None
    size: ClassVar[int] = 2

    def __post_init__(self) -> None:
        if not self.std > 0:
            raise InputError("std", "must be positive", self.std)

    def measure(self, poses: FloatArray, points: FloatArray) -> FloatArray:
        """(..., 2)."""
        return np.asarray(points + 0.0 * poses[..., :2])

    def jacobian(self, poses: FloatArray, points: FloatArray) -> FloatArray:
        """(..., 2, 2) identities."""
        return np.broadcast_to(np.eye(2), (*np.broadcast_shapes(poses.shape[:-1], points.shape[:-1]), 2, 2))

    def hessian(self, poses: FloatArray, points: FloatArray) -> FloatArray:
        """(..., 2, 2, 2) zeros."""
        return np.zeros((*np.broadcast_shapes(poses.shape[:-1], points.shape[:-1]), 2, 2, 2))

    def noise(self, poses: FloatArray, points: FloatArray) -> FloatArray:
        """(..., 2) [m^2]."""
        return np.full((*np.broadcast_shapes(poses.shape[:-1], points.shape[:-1]), 2), self.std**2)

    def pointed_at(self, poses: FloatArray, measured: FloatArray) -> FloatArray:  # noqa: ARG002
        """(..., 2) what was measured."""
        return measured

    def sees(self, poses: FloatArray, points: FloatArray) -> BoolArray:
        """Tell which points are within the range."""
        apart = np.linalg.norm(points - poses[..., :2], axis=-1)
        return np.asarray(apart <= (np.inf if self.max_range is None else self.max_range))
