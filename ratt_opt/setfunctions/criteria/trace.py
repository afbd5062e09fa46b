"""The trace criterion (A): the mean square error."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from ratt_opt.setfunctions.criteria.two_by_two import trace_of_inverse
from ratt_opt.setfunctions.information import InformationObjective, Tangent

if TYPE_CHECKING:
    from ratt_opt._validation import FloatArray

__all__ = ["TraceObjective"]


class TraceObjective(InformationObjective):
    """``sum_j w_j [tr(prior_j) - tr(Lambda_j(S)^{-1})]``: decrease of the mean square error (A-criterion) [m^2]."""

    __slots__ = ()

    name: ClassVar[str] = "trace"
    unit: ClassVar[str] = "m²"
    compiled_code: ClassVar[int | None] = 0

    @property
    def prior_criterion(self) -> float:
        """``sum_j w_j tr(prior_j)``."""
        return float(self._baseline.sum())

    def criterion(self, posterior_information: FloatArray) -> FloatArray:
        """(..., M) weighted traces of the posterior covariances."""
        if self.dimension == 2:
            rows = posterior_information
            return self.planar_criterion(rows[..., 0, 0], rows[..., 0, 1], rows[..., 1, 1])
        covariance = np.linalg.inv(posterior_information)
        return np.asarray(self.weights * np.trace(covariance, axis1=-2, axis2=-1))

    def planar_criterion(self, a: Any, b: Any, c: Any) -> FloatArray:
        """(..., M) the same in closed form."""
        return np.asarray(self.weights * trace_of_inverse(a, b, c))

    def gradient(self, posterior_information: FloatArray) -> FloatArray:
        """``w_j Lambda_j^{-2}``: (..., M, d, d)."""
        covariance = np.linalg.inv(posterior_information)
        return np.asarray(self.weights[:, None, None] * (covariance @ covariance))

    def tangent(self, point: FloatArray, target: int | None) -> Tangent:  # noqa: ARG002  (it bounds the sum)
        """``tr(L^{-1}) >= 2 tr(Y) - tr(Y L Y)`` for *any* symmetric ``Y``: an inexact inverse costs strength only."""
        inverse = np.linalg.inv(point)
        y = (inverse + np.swapaxes(inverse, -1, -2)) / 2
        traces = np.trace(y, axis1=-2, axis2=-1)
        slope = self.weights[:, None, None] * (y @ y)
        return Tangent(slope, float((self._baseline - 2 * self.weights * traces).sum()))
