"""The max-eigenvalue criterion (E): the worst axis of the worst target."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from ratt_opt.setfunctions.criteria import maxeig_marginals
from ratt_opt.setfunctions.criteria.planar_levels import LARGEST_DIMENSION, PlanarLevels
from ratt_opt.setfunctions.criteria.two_by_two import largest_of_inverse
from ratt_opt.setfunctions.criterion_parts import Tangent
from ratt_opt.setfunctions.information import InformationObjective

if TYPE_CHECKING:
    from collections.abc import Sequence

    from ratt_opt._validation import FloatArray, IntArray
    from ratt_opt.budget import Budget

__all__ = ["MaxEigenvalueObjective"]


class MaxEigenvalueObjective(InformationObjective):
    """``max_j w_j lambda_max(prior_j) - max_j w_j lambda_max(Lambda_j(S)^{-1})``: worst axis (E-criterion) [m^2]."""

    __slots__ = ()

    name: ClassVar[str] = "maxeig"
    unit: ClassVar[str] = "m²"
    compiled_code: ClassVar[int | None] = 2

    @property
    def prior_criterion(self) -> float:
        """``max_j w_j lambda_max(prior_j)``."""
        return float(self._baseline.max())

    def criterion(self, posterior_information: FloatArray) -> FloatArray:
        """(..., M) weighted largest eigenvalues of the posterior covariances."""
        if self.dimension == 2:
            rows = posterior_information
            return MaxEigenvalueObjective.planar_criterion(self, rows[..., 0, 0], rows[..., 0, 1], rows[..., 1, 1])
        return np.asarray(self.weights / np.linalg.eigvalsh(posterior_information)[..., 0])

    def planar_criterion(self, a: Any, b: Any, c: Any) -> FloatArray:
        """(..., M) the same in closed form."""
        return np.asarray(self.weights * largest_of_inverse(a, b, c))

    def combine(self, per_target: FloatArray) -> FloatArray:
        """The worst target's: (..., M) -> (...)."""
        return np.asarray(per_target.max(axis=-1))

    def value(self, posterior_information: FloatArray) -> FloatArray:
        """Value as a concave function of the posterior information: (..., M, d, d) -> (...)."""
        return np.asarray(self._baseline.max() - self.criterion(posterior_information).max(axis=-1))

    def gradient(self, posterior_information: FloatArray) -> FloatArray:
        """``w_j lambda^2 v v'`` at the lowest-indexed worst target, zero elsewhere: (..., M, d, d)."""
        eigenvalues, vectors = np.linalg.eigh(posterior_information)
        scores = self.weights / eigenvalues[..., 0]
        worst = scores.argmax(axis=-1)[..., None]
        vector = vectors[..., 0]
        rank_one = vector[..., :, None] * vector[..., None, :]
        factor = np.where(np.arange(self.n_targets) == worst, self.weights / eigenvalues[..., 0] ** 2, 0.0)
        return np.asarray(factor[..., None, None] * rank_one)

    def tangent_targets(self, point: FloatArray, level: float, most: int) -> list[int | None]:
        """The targets whose tangent at ``point`` cuts ``level`` off, worst first; the worst one if none does."""
        values = self._baseline.max() - self.criterion(point)
        order = np.argsort(values, kind="stable")[:most].tolist()
        return [j for j in order if values[j] < level] or [order[0]]

    def tangent(self, point: FloatArray, target: int | None) -> Tangent:
        """``lambda_max(L^{-1}) >= 2t - t^2 v'Lv / v'v`` for *any* ``v`` and ``t > 0``, at one target."""
        if target is None:
            (target,) = self.tangent_targets(point, -np.inf, 1)
            assert target is not None
        eigenvalues, vectors = np.linalg.eigh(point[target])
        t, v = 1 / eigenvalues[0], vectors[:, 0]
        slope = np.zeros_like(point)
        slope[target] = self.weights[target] * t * t * np.outer(v, v) / (v @ v)
        return Tangent(slope, float(self._baseline.max() - self.weights[target] * 2 * t))

    def cut_values(self, points: FloatArray, targets: Sequence[int | None]) -> FloatArray:
        """Minus the criterion of each point's target: (K, ..., M, d, d) -> (K, ...)."""
        criterion = self.criterion(points)
        return -np.stack([row[..., target] for row, target in zip(criterion, targets, strict=True)])

    def conic_value(self, posterior: Sequence[Any]) -> Any:
        """``max_j w_j lambda_max(prior_j) - max_j w_j / lambda_min(L_j)`` in cvxpy."""
        import cvxpy as cp

        each = [w * cp.inv_pos(cp.lambda_min(L)) for w, L in zip(self.weights, posterior, strict=True)]
        return self._baseline.max() - cp.max(cp.hstack(each))

    def fenchel_point(self, point: FloatArray, target: int | None) -> list[Any]:
        """The target, ``t = lambda_max(L^{-1})`` and its direction ``v``."""
        assert target is not None
        eigenvalues, vectors = np.linalg.eigh(point[target])
        return [target, float(1 / eigenvalues[0]), vectors[:, 0].tolist()]

    @property
    def prior_eigenvalue(self) -> float:
        """``max_j w_j lambda_max(prior_j)``."""
        return float((self.weights * np.linalg.eigvalsh(self.prior)[:, -1]).max())

    @property
    def verifier_averages(self) -> bool:
        """Eigenvalues are roots of polynomials, which it bounds for planar targets only."""
        return self.dimension == 2

    def marginal_ends(self, owners: IntArray, budget: Budget) -> tuple[FloatArray, FloatArray]:
        """Bounds by how far the smallest eigenvalue of all targets can rise, see ``maxeig_marginals.py``."""
        return maxeig_marginals.marginal_ends(self, owners, budget)

    def planar_levels(self) -> PlanarLevels | None:
        """The data as levels, for targets with at most two coordinates."""
        return PlanarLevels.of(self) if self.dimension <= LARGEST_DIMENSION else None
