"""Beliefs of a group of robots about the targets: Gaussian, predicted by their motion, updated in information form."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Protocol

import numpy as np

from ratt_opt._validation import FloatArray, check_finite, readonly
from ratt_opt._values import ByValue, ReprMixin
from ratt_opt.errors import InputError
from ratt_opt.setfunctions.information import symmetric_inverse

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

__all__ = ["Belief", "Innovation", "Motion"]


class Motion(Protocol):
    """Motion of states (..., M, d) over a period; ``time`` is that of the state given [s]."""

    def predict(self, states: FloatArray, period: float, time: float) -> FloatArray:
        """(..., M, d) states one period later, without noise."""

    def transition(self, states: FloatArray, period: float) -> FloatArray:
        """(..., M, d, d) derivative of :meth:`predict` by the state."""

    def noise(self, period: float) -> FloatArray:
        """(M, d, d) covariance of the motion noise of one period."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Innovation:
    """Sum of the normalised innovations squared of a group's measurements, and how many numbers that were."""

    squared: float = 0.0
    count: int = 0


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class Belief(ByValue, ReprMixin):
    """``mean`` (M, d) and ``covariance`` (M, d, d) of the targets' states, which begin with x, y [m]."""

    mean: FloatArray
    covariance: FloatArray

    @classmethod
    def of(cls, mean: ArrayLike, covariance: ArrayLike) -> Belief:
        """The belief with these moments.

        Raises
        ------
        InputError : a shape is wrong, a number not finite, or a covariance not positive definite.
        """
        means, covariances = check_finite("mean", mean, ndim=2), check_finite("covariance", covariance, ndim=3)
        expected = (*means.shape, means.shape[1])
        if covariances.shape != expected:
            raise InputError(
                "covariance", f"must have shape {expected} to match the mean", f"shape {covariances.shape}"
            )
        covariances = (covariances + np.swapaxes(covariances, -1, -2)) / 2
        for j, values in enumerate(np.linalg.eigvalsh(covariances)):
            if not values[0] > np.finfo(np.float64).eps * abs(values[-1]):
                raise InputError(
                    f"covariance[{j}]", "must be positive definite", f"smallest eigenvalue {values[0]:.6g}"
                )
        return cls(readonly(means), readonly(covariances))

    @property
    def positions(self) -> FloatArray:
        """(M, 2) estimated positions [m]."""
        return self.mean[:, :2]

    @property
    def position_covariance(self) -> FloatArray:
        """(M, 2, 2) [m^2]."""
        return self.covariance[:, :2, :2]

    @property
    def trace(self) -> float:
        """Sum over the targets of the traces of their positions' covariances [m^2]."""
        return float(np.trace(self.position_covariance, axis1=1, axis2=2).sum())

    def nees(self, truth: FloatArray) -> FloatArray:
        """(M,) normalised estimation error squared of each target, for true states (M, d); expected: d."""
        error = self.mean - truth
        return np.asarray(np.einsum("mi,mij,mj->m", error, symmetric_inverse(self.covariance), error))

    def predicted(self, motion: Motion, period: float, time: float) -> Belief:
        """One period later: ``F P F' + Q`` at the mean's motion."""
        step = motion.transition(self.mean, period)
        moved = step @ self.covariance @ np.swapaxes(step, -1, -2)
        covariance = (moved + np.swapaxes(moved, -1, -2)) / 2 + motion.noise(period)
        return Belief(readonly(motion.predict(self.mean, period, time)), readonly(covariance))

    def updated(self, information: FloatArray, vector: FloatArray) -> Belief:
        """Update by measurements: ``information`` (M, d, d) = sum of H'R^-1 H, ``vector`` (M, d) = sum of H'R^-1 z.

        ``z`` is a measurement as linear in the state: the surprise plus ``H`` times the state it was linearised at.
        Sums of both may be taken in any order and at any time: that is the Kalman filter's update.
        """
        posterior = symmetric_inverse(symmetric_inverse(self.covariance) + information)
        surprise = vector - (information @ self.mean[..., None])[..., 0]
        mean = self.mean + (posterior @ surprise[..., None])[..., 0]
        return Belief(readonly(mean), readonly(posterior))
