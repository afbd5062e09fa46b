"""The log-det criterion (D): the volume of the error ellipsoids.

**Its marginals.** ``logdet(L + X) - logdet L`` is convex in ``L``: its second derivative along ``D`` is
``tr(P D P D) - tr(B D B D)`` with ``P = L^{-1}`` and ``B = (L + X)^{-1} <= P``, and ``tr(ADAD) >= tr(BDBD)`` whenever
``A >= B >= 0``. So a tangent at any ``L0`` bounds it; its slope ``(L0 + X)^{-1} - P0`` is negative semidefinite, so
more information only lowers it.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from ratt_opt.setfunctions.criteria.two_by_two import determinant, logdet_gradient
from ratt_opt.setfunctions.criterion_parts import VALUE_ROUNDING, SeparableMinorant, Tangent, TargetTangents
from ratt_opt.setfunctions.information import InformationObjective, packed, symmetric_inverse

if TYPE_CHECKING:
    from collections.abc import Sequence

    from ratt_opt._validation import FloatArray
    from ratt_opt.setfunctions.criterion_parts import OtherElements

__all__ = ["LogDetObjective"]


class LogDetObjective(InformationObjective):
    """``sum_j w_j [logdet(Lambda_j(S)) - logdet(prior_j^{-1})]``: decrease of the log volume (D-criterion) [nat]."""

    __slots__ = ()

    name: ClassVar[str] = "logdet"
    unit: ClassVar[str] = "nat"
    is_submodular: ClassVar[bool] = True
    native_kernel: ClassVar[int | None] = 1
    target_criterion = InformationObjective.criterion_of_one

    @property
    def rounding(self) -> float:
        """Bound on the rounding of values: that of the prior's log-determinants, and one error for every logarithm."""
        return VALUE_ROUNDING * (self.prior_magnitude + float(self.weights.sum())) + self.inverse_rounding(self.weights)

    def error_scale(self, size: FloatArray) -> FloatArray:
        """(..., M) the weighted dimension."""
        return np.broadcast_to(self.weights * self.dimension, size.shape)

    def criterion(self, posterior_information: FloatArray) -> FloatArray:
        """(..., M) weighted log-determinants of the posterior covariances."""
        if self.dimension == 2:
            rows = posterior_information
            return np.asarray(-self.weights * np.log(determinant(rows[..., 0, 0], rows[..., 0, 1], rows[..., 1, 1])))
        return np.asarray(-self.weights * np.linalg.slogdet(posterior_information)[1])

    def planar_gradient(self, a: Any, b: Any, c: Any) -> FloatArray:
        """``Lambda^{-1}`` by its entries, the off-diagonal one twice: (..., 3)."""
        return np.stack(logdet_gradient(a, b, c), axis=-1)

    def gradient(self, posterior_information: FloatArray) -> FloatArray:
        """``w_j Lambda_j^{-1}``: (..., M, d, d)."""
        return np.asarray(self.weights[:, None, None] * np.linalg.inv(posterior_information))

    def tangent(self, point: FloatArray, target: int | None) -> Tangent:  # noqa: ARG002  (it bounds the sum)
        """``logdet L <= tr(Y L) - logdet Y - d`` for *any* ``Y > 0``: an inexact inverse costs strength only."""
        y = symmetric_inverse(point)
        # The criterion is -w logdet(Lambda), hence value = sum_j baseline_j + w_j logdet(Lambda_j).
        logdets = np.linalg.slogdet(y)[1] + self.dimension
        return Tangent(self.weights[:, None, None] * y, float((self._baseline - self.weights * logdets).sum()))

    def target_tangents(self, point: FloatArray) -> TargetTangents:
        """Return the tangent by target, with ``Y = R R'`` for a triangular ``R``, whose determinant is a product."""
        root = np.linalg.cholesky(symmetric_inverse(point))
        weights, turned = self.weights[:, None, None], np.swapaxes(root, -1, -2)
        logarithms = 2 * np.log(np.diagonal(root, axis1=-2, axis2=-1))
        return TargetTangents(
            slope=weights * (root @ turned),
            size=weights * (abs(root) @ abs(turned)),
            offset=self._baseline - self.weights * (logarithms.sum(axis=-1) + self.dimension),
            scale=abs(self._baseline) + self.weights * (abs(logarithms).sum(axis=-1) + self.dimension),
        )

    def marginals_beyond(self, base: FloatArray, information: FloatArray) -> FloatArray:
        """Gains diminish: those at the base itself."""
        return np.asarray(self.criterion(base)[:, None] - self.criterion(base[:, None] + information))

    def conic_value(self, posterior: Sequence[Any]) -> Any:
        """``sum_j w_j [logdet(prior_j) + log_det(L_j)]`` in cvxpy."""
        import cvxpy as cp

        return self._baseline.sum() + sum(w * cp.log_det(L) for w, L in zip(self.weights, posterior, strict=True))

    def fenchel_point(self, point: FloatArray, target: int | None) -> list[Any]:  # noqa: ARG002  (it bounds the sum)
        """``Y = L^{-1}`` of every target, packed."""
        return packed(symmetric_inverse(point))

    def marginal_minorant(self, added: FloatArray, others: OtherElements, share: FloatArray) -> SeparableMinorant:
        """The tangent at the relaxed context: exact there."""
        posterior = self.prior_information + others.mixed(share)
        both = posterior + added
        value = float((self.weights * (np.linalg.slogdet(both)[1] - np.linalg.slogdet(posterior)[1])).sum())
        slope = self.weights[:, None, None] * (np.linalg.inv(posterior) - np.linalg.inv(both))
        constant = value + float((slope * (posterior - self.prior_information)).sum())
        return SeparableMinorant(constant, np.maximum(others.scores(slope), 0.0), np.zeros(len(others.first)))
