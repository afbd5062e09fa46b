"""The max-eigenvalue criterion (E): the worst axis of the worst target.

**Targets with one or two coordinates.** A symmetric matrix ``[[m + e, o], [o, m - e]]`` has the quadratic form
``m + e cos(a) + o sin(a)`` along the unit vector at angle ``a / 2``, hence the smallest eigenvalue ``m - hypot(e, o)``,
at ``a = atan2(-o, -e)``. Divided by the target's weight, ``lambda_min(L_j) / w_j`` is called the *level* of target
``j``: the criterion is one over the smallest level.

**With an output matrix** ``C`` the criterion is ``lambda_max(C L^{-1} C') = 1 / l(L)`` with the level
``l(L) = min_v v'Lv / |Cv|^2``: for ``z = C'u``, ``z' L^{-1} z`` is one over the least ``v'Lv`` of ``z'v = 1``, and the
largest ``z'v`` over unit vectors ``u`` is ``|Cv|``. It is attained at ``v = L^{-1} C'u``, the *axis*; without an output
level and axis are the smallest eigenvalue and its vector.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from ratt_opt.setfunctions.criteria.maxeig_marginals import MARGIN, marginal_ends
from ratt_opt.setfunctions.criteria.output_covariances import output_covariances
from ratt_opt.setfunctions.criteria.two_by_two import eigenvalues as eigenvalues_of
from ratt_opt.setfunctions.criteria.two_by_two import largest_of_inverse
from ratt_opt.setfunctions.criterion_parts import Tangent
from ratt_opt.setfunctions.information import InformationObjective, symmetric_inverse
from ratt_opt.setfunctions.planar_levels import PlanarLevels

if TYPE_CHECKING:
    from collections.abc import Sequence

    from ratt_opt._validation import FloatArray, IntArray
    from ratt_opt.budget import Budget

__all__ = ["MaxEigenvalueObjective"]


class MaxEigenvalueObjective(InformationObjective):
    """``max_j w_j lambda_max(prior_j) - max_j w_j lambda_max(Lambda_j(S)^{-1})``: worst axis (E-criterion) [m^2].

    ``output`` : the part of the state that counts, (q, d) or (M, q, d) of full row rank, or ``None`` for all of it:
    ``max_j w_j lambda_max(C_j prior_j C_j') - max_j w_j lambda_max(C_j Lambda_j(S)^{-1} C_j')``.
    """

    __slots__ = ()

    name: ClassVar[str] = "maxeig"
    unit: ClassVar[str] = "m²"
    native_kernel: ClassVar[int | None] = 2
    supports_output: ClassVar[bool] = True
    error_scale = InformationObjective.counted_size
    is_least_of_targets: ClassVar[bool] = True
    target_criterion = InformationObjective.criterion_of_one

    @property
    def prior_criterion(self) -> float:
        """``max_j w_j lambda_max(C_j prior_j C_j')``."""
        return float(self._baseline.max())

    def criterion(self, posterior_information: FloatArray) -> FloatArray:
        """(..., M) weighted largest eigenvalues of the posterior covariances of what counts."""
        if self.output is not None:
            return np.asarray(self.weights * _largest(output_covariances(posterior_information, self.output)))
        if self.dimension == 2:
            rows = posterior_information
            return np.asarray(self.weights * largest_of_inverse(rows[..., 0, 0], rows[..., 0, 1], rows[..., 1, 1]))
        return np.asarray(self.weights / np.linalg.eigvalsh(posterior_information)[..., 0])

    def combine(self, per_target: FloatArray) -> FloatArray:
        """The worst target's: (..., M) -> (...)."""
        return np.asarray(per_target.max(axis=-1))

    def value(self, posterior_information: FloatArray) -> FloatArray:
        """Value as a concave function of the posterior information: (..., M, d, d) -> (...)."""
        return np.asarray(self._baseline.max() - self.criterion(posterior_information).max(axis=-1))

    def weakest_axes(self, matrices: FloatArray, targets: slice = slice(None)) -> tuple[FloatArray, FloatArray]:
        """Level and axis of each matrix: ``min_v v'Lv / |Cv|^2`` (..., K) and its ``v`` (..., K, d) with ``|Cv| = 1``.

        ``matrices`` : (..., K, d, d) positive definite, of K ``targets``
        """
        if self.output is None:
            eigenvalues, vectors = np.linalg.eigh(matrices)
            return eigenvalues[..., 0], vectors[..., 0]
        output = self.output[targets]
        columns = symmetric_inverse(matrices) @ np.swapaxes(output, -1, -2)
        eigenvalues, vectors = np.linalg.eigh(output @ columns)
        axes = columns @ vectors[..., -1:]
        axes = (axes / np.linalg.norm(output @ axes, axis=-2, keepdims=True))[..., 0]
        return 1 / eigenvalues[..., -1], axes

    def gradient(self, posterior_information: FloatArray) -> FloatArray:
        """``w_j v v' / l^2`` of level and axis at the lowest-indexed worst target, zero elsewhere: (..., M, d, d)."""
        levels, axes = self.weakest_axes(posterior_information)
        scores = self.weights / levels
        worst = scores.argmax(axis=-1)[..., None]
        rank_one = axes[..., :, None] * axes[..., None, :]
        factor = np.where(np.arange(self.n_targets) == worst, self.weights / levels**2, 0.0)
        return np.asarray(factor[..., None, None] * rank_one)

    def tangent_targets(self, point: FloatArray, level: float, most: int) -> list[int | None]:
        """The targets whose tangent at ``point`` cuts ``level`` off, worst first; the worst one if none does."""
        values = self._baseline.max() - self.criterion(point)
        order = np.argsort(values, kind="stable")[:most].tolist()
        return [j for j in order if values[j] < level] or [order[0]]

    def tangent(self, point: FloatArray, target: int | None) -> Tangent:
        """``lambda_max(C L^{-1} C') >= 2t - t^2 v'Lv / |Cv|^2`` for *any* ``v`` and ``t > 0``, at one target."""
        if target is None:
            (target,) = self.tangent_targets(point, -np.inf, 1)
            assert target is not None
        t, v = self._axis(point, target)
        slope = np.zeros_like(point)
        slope[target] = self.weights[target] * t * t * np.outer(v, v) / self._square(target, v)
        return Tangent(slope, float(self._baseline.max() - self.weights[target] * 2 * t))

    def cut_values(self, points: FloatArray, targets: Sequence[int | None]) -> FloatArray:
        """Minus the criterion of each point's target: (K, ..., M, d, d) -> (K, ...)."""
        criterion = self.criterion(points)
        return -np.stack([row[..., target] for row, target in zip(criterion, targets, strict=True)])

    def conic_value(self, posterior: Sequence[Any]) -> Any:
        """``max_j w_j lambda_max(prior_j) - max_j w_j / lambda_min(L_j)`` in cvxpy, for whole states."""
        if self.output is not None:
            return super().conic_value(posterior)
        import cvxpy as cp

        each = [w * cp.inv_pos(cp.lambda_min(L)) for w, L in zip(self.weights, posterior, strict=True)]
        return self._baseline.max() - cp.max(cp.hstack(each))

    def fenchel_point(self, point: FloatArray, target: int | None) -> list[Any]:
        """The target, ``t = lambda_max(C L^{-1} C')`` and its direction ``v``."""
        assert target is not None
        t, v = self._axis(point, target)
        return [target, t, v.tolist()]

    def _axis(self, point: FloatArray, target: int) -> tuple[float, FloatArray]:
        """``t`` and ``v`` (d,) of one target."""
        levels, axes = self.weakest_axes(point[target : target + 1], slice(target, target + 1))
        return float(1 / levels[0]), axes[0]

    def _square(self, target: int, v: FloatArray) -> float:
        """``|Cv|^2`` of one target."""
        counted = v if self.output is None else self.output[target] @ v
        return float(counted @ counted)

    @property
    def prior_eigenvalue(self) -> float:
        """``max_j w_j lambda_max(C_j prior_j C_j')``."""
        return float((self.weights * np.linalg.eigvalsh(self.counted(self.prior))[:, -1]).max())

    @property
    def verifier_averages(self) -> bool:
        """Eigenvalues are roots of polynomials, which it bounds for whole states of planar targets only."""
        return self.output is None and self.dimension == 2

    def marginal_ends(self, owners: IntArray, budget: Budget) -> tuple[FloatArray, FloatArray]:
        """Bounds by how far the lowest level of all targets can rise."""
        return marginal_ends(self, owners, budget)

    def least_levels(self) -> FloatArray:
        """(n, M) ``l(X)`` of each element's information, from below; with an output 0 if that is singular."""
        eigenvalues = np.linalg.eigvalsh(self.information)
        slack = MARGIN * eigenvalues[..., -1]
        if self.output is None:
            return np.clip(eigenvalues[..., 0] * (1 - MARGIN) - slack, 0.0, None)
        regular = eigenvalues[..., 0] > 2 * slack
        eye = np.eye(self.dimension)
        lowered = np.where(regular[..., None, None], self.information - slack[..., None, None] * eye, eye)
        return np.asarray(np.where(regular, self.weights / self.criterion(lowered) * (1 - MARGIN), 0.0))

    def largest_marginals(self) -> FloatArray:
        """(n, M) by how far one target's own level can rise."""
        return np.asarray(self.largest_alone() * (1 + MARGIN) + self.rounding)

    def largest_alone(self) -> FloatArray:
        """(n, M) no marginal of an element exceeds this if target ``j`` is the worst before it is added."""
        if self.output is None:
            a, level = np.linalg.eigvalsh(self.information)[..., -1].clip(0.0), self.weights / self._baseline
            return np.asarray(self.weights * a / (level * (level + a)))
        root = np.linalg.cholesky(self.prior)
        q = np.linalg.eigvalsh(np.swapaxes(root, -1, -2) @ self.information @ root)[..., -1].clip(0.0)
        return np.asarray(self._baseline * q / (1 + q))

    def planar_levels(self) -> PlanarLevels | None:
        """The data as levels, for whole states with at most two coordinates."""
        if self.output is not None or self.dimension > 2:
            return None
        return PlanarLevels.of(self.prior_information, self.information, self.weights, self.rounding)


def _largest(matrices: FloatArray) -> FloatArray:
    """(...,) largest eigenvalues of symmetric (..., q, q) matrices."""
    if matrices.shape[-1] == 1:
        return matrices[..., 0, 0]
    if matrices.shape[-1] == 2:
        return np.asarray(eigenvalues_of(matrices[..., 0, 0], matrices[..., 0, 1], matrices[..., 1, 1])[1])
    return np.asarray(np.linalg.eigvalsh(matrices)[..., -1])
