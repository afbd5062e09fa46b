"""What a robot's sensor measures of a target's position: a base class to subclass, and four sensors."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Iterable
from dataclasses import dataclass
from typing import TYPE_CHECKING, ClassVar

import numpy as np

from ratt_opt._validation import readonly
from ratt_opt._values import ByValue
from ratt_opt.errors import InputError
from ratt_opt.scenario.sensor import Sensor, jacobian, measure, wrap_angle

if TYPE_CHECKING:
    from collections.abc import Sequence

    from ratt_opt._validation import BoolArray, FloatArray, IntArray
    from ratt_opt.scenario.model import Scenario

__all__ = [
    "BearingOnly",
    "PositionSensor",
    "RangeBearing",
    "RangeOnly",
    "SensorModel",
    "robots_by_sensor",
    "sensors_of",
]


class SensorModel(ABC):
    """Measurements (..., k) of points (..., 2) [m] from poses (..., 3) x [m], y [m], heading [rad].

    A sensor of your own subclasses this: what it measures, its first and second derivatives by the point, its noise
    and its reach. Components are independent; those named in ``angles`` wrap around.
    """

    size: ClassVar[int]
    """Numbers k in one measurement."""
    angles: ClassVar[tuple[int, ...]] = ()
    """Components that are angles [rad]."""

    @abstractmethod
    def measure(self, poses: FloatArray, points: FloatArray) -> FloatArray:
        """(..., k) without noise."""

    @abstractmethod
    def jacobian(self, poses: FloatArray, points: FloatArray) -> FloatArray:
        """(..., k, 2) derivative by the point."""

    @abstractmethod
    def hessian(self, poses: FloatArray, points: FloatArray) -> FloatArray:
        """(..., k, 2, 2) second derivative by the point."""

    @abstractmethod
    def noise(self, poses: FloatArray, points: FloatArray) -> FloatArray:
        """(..., k) positive variances of the components."""

    def sees(self, poses: FloatArray, points: FloatArray) -> BoolArray:
        """(...) whether a point is in reach; everything is unless a subclass says otherwise."""
        return np.ones(np.broadcast_shapes(poses.shape[:-1], points.shape[:-1]), dtype=np.bool_)

    def surprise(self, measured: FloatArray, expected: FloatArray) -> FloatArray:
        """(..., k) ``measured - expected``, angles the short way round."""
        difference = measured - expected
        for component in self.angles:
            difference[..., component] = wrap_angle(difference[..., component])
        return difference

    def noise_covariance(
        self, poses: FloatArray, points: FloatArray, covariance: FloatArray | None = None
    ) -> FloatArray:
        """(..., k, k) covariance of the measurement about its linearisation at ``points``.

        With the points' ``covariance`` (..., 2, 2), the second-order term ``tr(H_a P H_b P) / 2`` of Gaussian points
        is added: the part of the error that the linearisation leaves. It is known when a plan is made.

        Source: Bar-Shalom, Li, Kirubarajan, Estimation with Applications (2001), section 10.3.2.
        """
        noise = self.noise(poses, points)[..., None] * np.eye(self.size)
        if covariance is None:
            return noise
        bent = self.hessian(poses, points) @ covariance[..., None, :, :]
        return np.asarray(noise + np.einsum("...aij,...bji->...ab", bent, bent) / 2)

    def information(self, poses: FloatArray, points: FloatArray, covariance: FloatArray | None = None) -> FloatArray:
        """(K, M, 2, 2) information ``H' R^-1 H`` of one measurement from each of K poses of each of M points."""
        here, there = poses[:, None], points[None]
        weights = np.linalg.inv(self.noise_covariance(here, there, covariance))
        slope = self.jacobian(here, there)
        information = np.swapaxes(slope, -1, -2) @ weights @ slope
        information = (information + np.swapaxes(information, -1, -2)) / 2
        return np.asarray(information * self.sees(here, there)[..., None, None])


@dataclass(frozen=True, eq=False, repr=False)
class RangeBearing(ByValue, SensorModel):
    """Range [m] and bearing [rad] with the noise and reach of a scenario's ``sensor``."""

    sensor: Sensor
    size: ClassVar[int] = 2
    angles: ClassVar[tuple[int, ...]] = (1,)

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
        return np.stack(self.sensor.noise_variances(measured[..., 0], measured[..., 1]), axis=-1)

    def sees(self, poses: FloatArray, points: FloatArray) -> BoolArray:
        """Within the range and the field of view."""
        measured = measure(poses, points)
        return self.sensor.sees(measured[..., 0], measured[..., 1])

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

    def sees(self, poses: FloatArray, points: FloatArray) -> BoolArray:
        """Within the range."""
        apart = np.linalg.norm(points - poses[..., :2], axis=-1)
        return np.asarray(apart <= (np.inf if self.max_range is None else self.max_range))


def sensors_of(
    scenario: Scenario, sensor: SensorModel | Sequence[SensorModel] | None = None
) -> tuple[SensorModel, ...]:
    """Every robot's sensor: the given one, the given ones robot by robot, or the scenario's range and bearing.

    Raises
    ------
    InputError : ``sensor`` is none of these.
    """
    if sensor is None:
        return tuple(RangeBearing(robot.sensor or scenario.sensor) for robot in scenario.robots)
    several = tuple(sensor) if isinstance(sensor, Iterable) else ()
    given = (sensor,) * scenario.n_robots if isinstance(sensor, SensorModel) else several
    if len(given) != scenario.n_robots or not all(isinstance(one, SensorModel) for one in given):
        rule = f"must be a SensorModel, or one for each of {scenario.n_robots} robots"
        raise InputError("sensor", rule, type(sensor).__name__)
    return given


def robots_by_sensor(sensors: Sequence[SensorModel]) -> tuple[tuple[SensorModel, IntArray], ...]:
    """Every different sensor with the robots that have one equal to it, both in the order of the robots."""
    different: list[tuple[SensorModel, list[int]]] = []
    for i, sensor in enumerate(sensors):
        robots = next((robots for known, robots in different if known == sensor), None)
        if robots is None:
            different.append((sensor, [i]))
        else:
            robots.append(i)
    return tuple((sensor, readonly(np.array(robots))) for sensor, robots in different)
