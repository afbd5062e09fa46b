"""The scenario's own sensor in missions: range and bearing, or one of them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, ClassVar

import numpy as np

from ratt_opt._values import ByValue
from ratt_opt.errors import InputError
from ratt_opt.scenario.own_sensors import states_information
from ratt_opt.scenario.sensor import Sensor, jacobian, measure, variances_of
from ratt_opt.scenario.sensors.model import SensorModel
from ratt_opt.scenario.sensors.own_information import stated_information, stated_weights

if TYPE_CHECKING:
    from ratt_opt._validation import BoolArray, FloatArray

__all__ = ["BearingOnly", "RangeBearing", "RangeOnly"]


@dataclass(frozen=True, eq=False, repr=False)
class RangeBearing(ByValue, SensorModel):
    """Range [m] and bearing [rad] with the noise and reach of a scenario's ``sensor``.

    If the sensor's class has an ``information`` of its own, measurements count for exactly that much.
    """

    sensor: Sensor
    size: ClassVar[int] = 2
    angles: ClassVar[tuple[int, ...]] = (1,)

    def __post_init__(self) -> None:
        if self.size == 1 and states_information(self.sensor):
            rule = "must not state its own information, which is that of a range and a bearing together"
            raise InputError("sensor", rule, type(self.sensor).__name__)

    def measure(self, poses: FloatArray, points: FloatArray) -> FloatArray:
        """(..., 2)."""
        return measure(poses, points)

    def jacobian(self, poses: FloatArray, points: FloatArray) -> FloatArray:
        """(..., 2, 2)."""
        return jacobian(poses, points)

    def hessian(self, poses: FloatArray, points: FloatArray) -> FloatArray:
        """(..., 2, 2, 2)."""
        delta = points - poses[..., :2]
        squared = (delta**2).sum(axis=-1)[..., None, None]
        dx, dy = delta[..., 0], delta[..., 1]
        bend = np.stack([np.stack([dy * dy, -dx * dy], -1), np.stack([-dx * dy, dx * dx], -1)], -2)
        turn = np.stack([np.stack([2 * dx * dy, dy**2 - dx**2], -1), np.stack([dy**2 - dx**2, -2 * dx * dy], -1)], -2)
        return np.stack([bend / squared**1.5, turn / squared**2], axis=-3)

    def noise(self, poses: FloatArray, points: FloatArray) -> FloatArray:
        """(..., 2) [m^2], [rad^2]."""
        measured = measure(poses, points)
        return np.stack(variances_of(self.sensor, measured[..., 0], measured[..., 1]), axis=-1)

    def weights(
        self,
        poses: FloatArray,
        points: FloatArray,
        added: FloatArray | None = None,
        measured: FloatArray | None = None,
    ) -> FloatArray:
        """(..., 2, 2); of a sensor that states its information, what that says."""
        if not states_information(self.sensor):
            return super().weights(poses, points, added)
        told = stated_weights(self.sensor, poses, points)
        if measured is not None:  # a sighting shows that the target is in reach, if not where it was expected
            silent = ~told.any(axis=(-1, -2))
            there = RangeBearing.pointed_at(self, poses, measured)
            assert there is not None
            told[silent] = stated_weights(self.sensor, poses[silent], there[silent])
        return told if added is None else np.asarray(told @ np.linalg.inv(np.eye(2) + added @ told))

    def disturbance(self, poses: FloatArray, points: FloatArray, luck: FloatArray) -> FloatArray:
        """(..., 2); of a sensor that states its information, with the covariance that it implies."""
        if not states_information(self.sensor):
            return super().disturbance(poses, points, luck)
        values, vectors = np.linalg.eigh(self.weights(poses, points))
        is_measured = values > 1e-12 * values[..., -1:]  # below it is what rounding leaves of no information
        scale = np.where(is_measured, 1 / np.sqrt(np.maximum(values, np.finfo(float).tiny)), 0.0)
        along = np.swapaxes(vectors, -1, -2) @ luck[..., None]  # the symmetric root: vectors have no sign of their own
        return np.asarray((vectors @ (scale[..., None] * along))[..., 0])

    def pose_jacobian(self, poses: FloatArray, points: FloatArray) -> FloatArray:
        """(..., 2, 3 or 4)."""
        slope = jacobian(poses, points)
        beside = np.zeros((2, poses.shape[-1] - 2))
        beside[1, 0] = -1.0  # the bearing turns with the heading; a height changes nothing
        return np.concatenate([-slope, np.broadcast_to(beside, (*slope.shape[:-1], beside.shape[1]))], axis=-1)

    def pointed_at(self, poses: FloatArray, measured: FloatArray) -> FloatArray | None:
        """(..., 2) at the measured range and bearing."""
        angle = poses[..., 2] + measured[..., 1]
        return np.asarray(poses[..., :2] + measured[..., :1] * np.stack([np.cos(angle), np.sin(angle)], axis=-1))

    def fault(self, measured: FloatArray) -> str | None:
        """A range is not negative."""
        return "must have a range >= 0" if measured[0] < 0 else None

    def sees(self, poses: FloatArray, points: FloatArray) -> BoolArray:
        """Tell which points are within the range and the field of view, with information about them."""
        measured = measure(poses, points)
        seen = self.sensor.sees(measured[..., 0], measured[..., 1])
        if not states_information(self.sensor):
            return seen
        return np.asarray(seen & stated_information(self.sensor, poses, points).any(axis=(-1, -2)))

    def information(self, poses: FloatArray, points: FloatArray, covariance: FloatArray | None = None) -> FloatArray:
        """(K, M, 2, 2); without a covariance to the last digit what a scenario's problem holds."""
        if covariance is None:
            return self.sensor.information(poses, points)
        return super().information(poses, points, covariance)


class _OneComponent(RangeBearing):
    """One component of a range-and-bearing sensor."""

    size: ClassVar[int] = 1
    component: ClassVar[slice]

    def measure(self, poses: FloatArray, points: FloatArray) -> FloatArray:
        """(..., 1)."""
        return super().measure(poses, points)[..., self.component]

    def jacobian(self, poses: FloatArray, points: FloatArray) -> FloatArray:
        """(..., 1, 2)."""
        return super().jacobian(poses, points)[..., self.component, :]

    def hessian(self, poses: FloatArray, points: FloatArray) -> FloatArray:
        """(..., 1, 2, 2)."""
        return super().hessian(poses, points)[..., self.component, :, :]

    def noise(self, poses: FloatArray, points: FloatArray) -> FloatArray:
        """(..., 1)."""
        return super().noise(poses, points)[..., self.component]

    def pose_jacobian(self, poses: FloatArray, points: FloatArray) -> FloatArray:
        """(..., 1, 3 or 4)."""
        return super().pose_jacobian(poses, points)[..., self.component, :]

    def pointed_at(self, poses: FloatArray, measured: FloatArray) -> None:  # noqa: ARG002
        """One component alone names no point."""
        return

    def information(self, poses: FloatArray, points: FloatArray, covariance: FloatArray | None = None) -> FloatArray:
        """(K, M, 2, 2) of rank one."""
        return SensorModel.information(self, poses, points, covariance)


class RangeOnly(_OneComponent):
    """The range [m] of a scenario's ``sensor``."""

    angles: ClassVar[tuple[int, ...]] = ()
    component: ClassVar[slice] = slice(0, 1)


class BearingOnly(_OneComponent):
    """The bearing [rad] of a scenario's ``sensor``."""

    angles: ClassVar[tuple[int, ...]] = (0,)
    component: ClassVar[slice] = slice(1, 2)

    def fault(self, measured: FloatArray) -> None:  # noqa: ARG002
        """Any bearing is possible."""
        return
