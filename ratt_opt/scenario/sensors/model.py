"""Base class of sensors: a subclass states the measurement of a target by a robot."""

from __future__ import annotations

from abc import ABC, abstractmethod
from typing import TYPE_CHECKING, ClassVar

import numpy as np

from ratt_opt.scenario.sensor import wrap_angle

if TYPE_CHECKING:
    from collections.abc import Callable

    from ratt_opt._validation import BoolArray, FloatArray

__all__ = ["SensorModel"]


class SensorModel(ABC):
    """Measurements (..., k) of points (..., r) from poses (..., 3 or 4) x [m], y [m], heading [rad], height [m].

    A sensor of your own subclasses this and says how many numbers it measures (``size``), which (``measure``) and how
    noisy they are (``noise``); with limits to what it sees also ``sees``. Derivatives by the point are central
    differences unless you give them. Components are independent; those named in ``angles`` wrap around.

    ``points`` are the first ``reads`` numbers of the targets' states: x, y [m] of most sensors; with ``reads = 4`` also
    the velocity in x and y [m/s], for range rates and the like; with ``reads = 6`` also height [m] and climb [m/s].

    It can stand in every place of a sensor: ``Robot(sensor=)``, ``Scenario(sensor=)``, ``MissionModel(sensor=)``. Make
    it a frozen dataclass, so that equal ones are equal; :func:`register_sensor` or an entry point gives it a name in
    files.
    """

    size: ClassVar[int]
    """Numbers k in one measurement."""
    angles: ClassVar[tuple[int, ...]] = ()
    """Components that are angles [rad]."""
    reads: ClassVar[int] = 2
    """Numbers r of a target's state that the measurement depends on: 2, 4 or 6."""

    @abstractmethod
    def measure(self, poses: FloatArray, points: FloatArray) -> FloatArray:
        """(..., k) without noise."""

    def jacobian(self, poses: FloatArray, points: FloatArray) -> FloatArray:
        """(..., k, r) derivative by the point; central differences, to some ten digits, unless a subclass knows it."""
        step = 6e-6  # the cube root of a rounding, at which central differences err by about 1e-10
        return _slopes(lambda x: self.measure(poses, x), points, step, self.surprise)

    def hessian(self, poses: FloatArray, points: FloatArray) -> FloatArray:
        """(..., k, r, r) second derivative by the point; differences of :meth:`jacobian`, to some four digits."""
        step = 1e-3  # wider, which makes second derivatives of differences good to 1e-6
        return _slopes(lambda x: self.jacobian(poses, x), points, step, np.subtract)

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

        With the points' ``covariance`` (..., r, r), the second-order term ``tr(H_a P H_b P) / 2`` of Gaussian points
        is added: the part of the error that the linearisation leaves. It is known when a plan is made.

        Source: Bar-Shalom, Li, Kirubarajan, Estimation with Applications (2001), section 10.3.2.
        """
        noise = self.noise(poses, points)[..., None] * np.eye(self.size)
        return noise if covariance is None else noise + self.bending(poses, points, covariance)

    def bending(self, poses: FloatArray, points: FloatArray, covariance: FloatArray) -> FloatArray:
        """(..., k, k) the second-order term for points of this ``covariance`` (..., r, r)."""
        bent = self.hessian(poses, points) @ covariance[..., None, :, :]
        return np.asarray(np.einsum("...aij,...bji->...ab", bent, bent) / 2)

    def weights(
        self,
        poses: FloatArray,
        points: FloatArray,
        added: FloatArray | None = None,
        measured: FloatArray | None = None,  # noqa: ARG002  (for sensors whose reach decides it)
    ) -> FloatArray:
        """(..., k, k) inverse covariance of a measurement whose noise has ``added`` (..., k, k) on top.

        ``measured`` : (..., k) the numbers, if there are some already.
        """
        noise = self.noise_covariance(poses, points)
        return np.asarray(np.linalg.inv(noise if added is None else noise + added))

    def disturbance(self, poses: FloatArray, points: FloatArray, luck: FloatArray) -> FloatArray:
        """(..., k) simulated noise from standard normal numbers ``luck`` (..., k)."""
        return np.asarray(np.sqrt(self.noise(poses, points)) * luck)

    def pose_jacobian(self, poses: FloatArray, points: FloatArray) -> FloatArray:
        """(..., k, 3 or 4) derivative by the pose, by central differences unless a subclass knows better."""
        columns, width = [], 1e-5  # [m], [rad]: errors of 1e-10 of the curvature, and 1e-11 of rounding
        for step in width * np.eye(poses.shape[-1]):
            ends = [self.measure(poses + sign * step, points) for sign in (1, -1)]
            columns.append(self.surprise(*ends) / (2 * width))
        return np.stack(columns, axis=-1)

    def pointed_at(self, poses: FloatArray, measured: FloatArray) -> FloatArray | None:  # noqa: ARG002
        """(..., 2) the point that a measurement (..., k) names, or ``None`` if it names none."""
        return None

    def fault(self, measured: FloatArray) -> str | None:  # noqa: ARG002
        """The rule that a measurement (k,) breaks, or ``None``: what this sensor can never report."""
        return None

    def information(self, poses: FloatArray, points: FloatArray, covariance: FloatArray | None = None) -> FloatArray:
        """(K, M, r, r) information ``H' R^-1 H`` of one measurement from each of K poses of each of M points."""
        here, there = poses[:, None], points[None]
        weights = self.weights(here, there, None if covariance is None else self.bending(here, there, covariance))
        slope = self.jacobian(here, there)
        information = np.swapaxes(slope, -1, -2) @ weights @ slope
        information = (information + np.swapaxes(information, -1, -2)) / 2
        return np.asarray(information * self.sees(here, there)[..., None, None])


def _slopes(
    f: Callable[[FloatArray], FloatArray],
    points: FloatArray,
    step: float,
    difference: Callable[[FloatArray, FloatArray], FloatArray],
) -> FloatArray:
    """Central differences of ``f`` (..., k) by points (..., r): (..., k, r)."""
    steps = step * np.maximum(1.0, np.abs(points).max(axis=-1, keepdims=True))
    columns = []
    for axis in np.eye(points.shape[-1]):
        ends = [f(points + sign * steps * axis) for sign in (1, -1)]
        change = difference(*ends)
        columns.append(change / (2 * steps.reshape(steps.shape[:-1] + (1,) * (change.ndim - steps.ndim + 1))))
    return np.stack(columns, axis=-1)
