"""The max-eigenvalue criterion (E): the worst axis of the worst target.

**Targets with one or two coordinates.** A symmetric matrix ``[[m + e, o], [o, m - e]]`` has the quadratic form
``m + e cos(a) + o sin(a)`` along the unit vector at angle ``a / 2``, hence the smallest eigenvalue ``m - hypot(e, o)``,
at ``a = atan2(-o, -e)``. Divided by the target's weight, ``lambda_min(L_j) / w_j`` is called the *level* of target
``j``: the criterion is one over the smallest level.

**Its smallest marginals.** Write ``g_j(L) = w_j / lambda_min(L_j)``, so that the marginal of ``x`` is
``max_j g_j(L) - max_j g_j(L + X)``. Let target ``j`` be the worst once ``x`` is added, ``t = lambda_min(L_j + X_j)``
with eigenvector ``v``, and ``delta_j = lambda_min(X_j)``. Then ``lambda_min(L_j) <= v'L_j v = t - v'X_j v <= t -
delta_j``, and the marginal is at least ``w_j / (t - delta_j) - w_j / t = w_j delta_j / (t (t - delta_j))``, which falls
in ``t``. As ``j`` is the worst target, ``t / w_j = min_i lambda_min(L_i + X_i) / w_i <= tau``, the largest such minimum
over all contexts. For any weights ``mu_c >= 0`` with sum 1, targets ``i_c`` and unit vectors ``v_c``,

    tau <= sum_c mu_c v_c' L_{i_c} v_c / w_{i_c},

which splits into one maximum an owner. A linear program finds good ones; the bound is evaluated afresh. Where
``w_j tau < lambda_min(prior information_j) + delta_j`` target ``j`` can never be the worst one.

**Its largest marginals.** Let ``j`` be the worst target before ``x`` is added, ``v`` the vector of
``lambda = lambda_min(L_j)``. Then ``lambda_min(L_j + X_j) <= lambda + v'X_j v``, so the marginal is at most
``w_j a / (lambda (lambda + a))`` with ``a = lambda_max(X_j)``, which falls in ``lambda >= lambda_min(prior
information_j)``. It is also at most the value of all that any context can reach with ``x``:
``max_j g_j(prior) - 1 / tau``.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import inf
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from ratt_opt.highs import LinearProgram, rows_of
from ratt_opt.setfunctions.criteria.two_by_two import largest_of_inverse
from ratt_opt.setfunctions.criterion_parts import Tangent
from ratt_opt.setfunctions.information import InformationObjective

if TYPE_CHECKING:
    from collections.abc import Sequence

    from ratt_opt._validation import FloatArray, IntArray
    from ratt_opt.budget import Budget

__all__ = ["MaxEigenvalueObjective", "PlanarLevels"]

ROUNDS = 12
"""Linear programs for the weights of ``tau``: 3, 6, 12, 24 leave it 2.9, 0.5, 0.02, 0 % above the last, in time that
doubles (48 elements of 8 owners, 6 targets in three coordinates)."""
CUTS = 5
"""Worst targets that get a cut a round: with 2 instead of 5 ``tau`` is 1 % higher, in the same time."""
MARGIN = 1e-9
"""Relative safety margin for rounding."""


@dataclass(frozen=True, slots=True, eq=False)
class PlanarLevels:
    """``parts`` (n, 3, M) of each element and ``prior`` (3, M): mean, even and odd part about each target.

    Both are divided by ``scale``, a power of two, so that squares neither overflow nor vanish.
    """

    parts: FloatArray
    prior: FloatArray
    scale: float

    @classmethod
    def of(cls, f: InformationObjective) -> PlanarLevels:
        """Return the parts of a criterion whose targets have at most two coordinates."""
        weights = f.weights[:, None, None]
        prior = _parts(f.prior_information / weights)
        scale = float(2.0 ** np.round(np.log2(prior[0].max())))
        return cls(_parts(f.information / weights) / scale, prior / scale, scale)


def _parts(matrices: FloatArray) -> FloatArray:
    """(..., M, d, d) -> (..., 3, M)."""
    if matrices.shape[-1] == 1:
        mean = matrices[..., 0, 0]
        return np.stack([mean, np.zeros_like(mean), np.zeros_like(mean)], axis=-2)
    first, last = matrices[..., 0, 0], matrices[..., 1, 1]
    return np.stack([(first + last) / 2, (first - last) / 2, matrices[..., 0, 1]], axis=-2)


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
        """Bounds by how far the smallest eigenvalue of all targets can rise."""
        tau = _tau(self, owners, budget) * (1 + MARGIN)
        eigenvalues = np.linalg.eigvalsh(self.information)
        least = np.clip(eigenvalues[..., 0] * (1 - MARGIN) - MARGIN * eigenvalues[..., -1], 0.0, None)
        most = np.clip(eigenvalues[..., -1], 0.0, None)
        start = np.linalg.eigvalsh(self.prior_information)[:, 0]
        t = tau[:, None] * self.weights
        possible = t >= (start + least) * (1 - MARGIN)
        gain = self.weights * least / np.where(possible, t * (t - least), 1.0)
        floor = np.where(possible, gain, np.inf).min(axis=1) * (1 - MARGIN)
        ceiling = (self.weights * most / (start * (start + most))).max(axis=1)
        reach = self.criterion(self.prior_information).max() - 1 / tau
        return floor, np.maximum(np.minimum(ceiling, reach) * (1 + MARGIN), self.singletons())

    def planar_levels(self) -> PlanarLevels | None:
        """The data as levels, for targets with at most two coordinates."""
        return PlanarLevels.of(self) if self.dimension <= 2 else None


def _tau(f: InformationObjective, owners: IntArray, budget: Budget) -> FloatArray:
    """(n,) upper bounds, for each ``x``, on the largest ``min_i lambda_min(L_i) / w_i`` of sets with ``x``."""
    groups = [np.flatnonzero(owners == i) for i in np.unique(owners)]
    scores, constants, multipliers = _cuts(f, groups, budget)
    combined = multipliers @ scores
    best = np.empty(f.n)
    total = float(multipliers @ constants)
    for own in groups:
        best[own] = combined[own].max()
        total += float(combined[own].max())
    return np.asarray(total - best + combined)


def _cuts(f: InformationObjective, groups: list[IntArray], budget: Budget) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Cuts ``constant + scores[e] + ...`` above the smallest eigenvalues, and weights that make them strong."""
    n = f.n
    one_each = rows_of([(own.tolist(), [1.0] * len(own)) for own in groups], 1.0, 1.0)
    program = LinearProgram([*[0.0] * n, -1.0], [*[0.0] * n, -inf], [*[1.0] * n, inf], rows=one_each)
    point = np.concatenate([np.full(len(own), 1 / len(own)) for own in groups])[np.argsort(np.concatenate(groups))]
    scores, constants = np.empty((0, n)), np.empty(0)
    multipliers = np.empty(0)
    for _ in range(ROUNDS):
        posterior = f.prior_information + np.tensordot(point, f.information, axes=1)
        values, vectors = np.linalg.eigh(posterior)
        worst = np.argsort(values[:, 0] / f.weights, kind="stable")[:CUTS]
        v = vectors[worst, :, 0]
        quadratic = np.einsum("ca,ecab,cb->ce", v, f.information[:, worst], v) / f.weights[worst, None]
        start = np.einsum("ca,cab,cb->c", v, f.prior_information[worst], v) / f.weights[worst]
        scores, constants = np.concatenate([scores, quadratic]), np.concatenate([constants, start])
        program.add_rows(rows_of([(range(n + 1), [*-row, 1.0]) for row in quadratic], -inf, start))
        claim = program.solve()
        found = np.clip(-np.nan_to_num(claim.duals[len(groups) :]), 0.0, None)
        if len(claim.x) != n + 1 or len(found) != len(scores) or found.sum() <= 0:
            break
        multipliers, point = found / found.sum(), np.clip(claim.x[:n], 0.0, 1.0)
        if budget.is_over:
            break
    if len(multipliers) == 0:
        multipliers = np.full(len(scores), 1 / len(scores))
    return scores[: len(multipliers)], constants[: len(multipliers)], multipliers
