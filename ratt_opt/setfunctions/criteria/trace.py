"""The trace criterion (A): the mean square error.

**Its smallest marginals.** ``m(P) = tr P - tr (P^{-1} + X)^{-1}`` is convex in ``P`` (the parallel sum is concave), so
``m(P) >= m(P0) + <G, P - P0>`` with ``G = 1 - (1 + X P0)^{-1} (1 + P0 X)^{-1}``. Split ``G = G+ - sum_k g_k n_k n_k'``
into its parts of each sign.

- ``<G+, L^{-1}> >= 2 <G+, Y> - <Y G+ Y, L>`` for any symmetric ``Y``, since ``L^{-1} >= 2Y - Y L Y``; linear in ``L``.
- ``n' L^{-1} n <= w_0' prior w_0 + sum_i w_i' I_i^{-1} w_i`` for any ``w`` with ``w_0 + sum_i w_i = n`` (the inverse
  of a sum is the smallest such sum: parallel resistors), with equality for the harmonic shares used here. The share of
  an owner that is absent, or whose information is singular, falls to the prior; by convexity of the square,
  ``|w_0 + sum_absent w_i|^2 <= |w_0|^2 / t_0 + sum_absent |w_i|^2 / t_i`` in the prior's norm, ``t_0 + sum t_i = 1``.

An inexact ``P0``, ``Y`` or ``w`` costs strength, never validity.

**With an output matrix** ``C`` (``W = C'C``) the criterion is ``tr(C L^{-1} C') = tr(W L^{-1})``. The parallel sum is
concave as a matrix, so ``m`` stays convex in ``P``, with ``G = W - (1 + X P0)^{-1} W (1 + P0 X)^{-1}``; and
``(L^{-1} C' - Y)' L (L^{-1} C' - Y) >= 0`` gives ``tr(C L^{-1} C') >= 2 tr(C Y) - tr(Y' L Y)`` for any ``Y`` (d, q).

**Its largest marginals.** ``m`` is convex in ``P``, hence largest at an extreme point ``P0^{1/2} V V' P0^{1/2}`` of
``0 <= P <= P0``, ``V`` with orthonormal columns: at ``P0`` (no context), or at one of lower rank ``k``; there it is
``tr(B'B S (1 + S)^{-1})`` with ``B = P0^{1/2} V`` and ``S = B' I B``, at most ``lambda_max(P0)`` times the sum of
``q / (1 + q)`` over the ``d - 1`` largest eigenvalues ``q`` of ``P0^{1/2} I P0^{1/2}`` (Poincare separation). An
isotropic prior makes the first the larger.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from ratt_opt.setfunctions.criteria.output_covariances import output_traces
from ratt_opt.setfunctions.criteria.two_by_two import congruent, eigenvalues, trace_gradient, trace_of_inverse
from ratt_opt.setfunctions.criterion_parts import SeparableMinorant, Tangent, TargetTangents
from ratt_opt.setfunctions.information import InformationObjective, packed, symmetric_inverse

if TYPE_CHECKING:
    from collections.abc import Sequence

    from ratt_opt._validation import FloatArray, IntArray
    from ratt_opt.budget import Budget
    from ratt_opt.setfunctions.criterion_parts import OtherElements

__all__ = ["TraceObjective"]


class TraceObjective(InformationObjective):
    """``sum_j w_j [tr(prior_j) - tr(Lambda_j(S)^{-1})]``: decrease of the mean square error (A-criterion) [m^2].

    ``output`` : the part of the state that counts, (q, d) or (M, q, d) of full row rank, or ``None`` for all of it:
    ``sum_j w_j [tr(C_j prior_j C_j') - tr(C_j Lambda_j(S)^{-1} C_j')]``.
    """

    __slots__ = ()

    name: ClassVar[str] = "trace"
    unit: ClassVar[str] = "m²"
    native_kernel: ClassVar[int | None] = 0
    supports_output: ClassVar[bool] = True
    error_scale = InformationObjective.counted_size
    target_criterion = InformationObjective.criterion_of_one

    @property
    def prior_criterion(self) -> float:
        """``sum_j w_j tr(C_j prior_j C_j')``."""
        return float(self._baseline.sum())

    def criterion(self, posterior_information: FloatArray) -> FloatArray:
        """(..., M) weighted traces of the posterior covariances of what counts."""
        if self.output is not None:
            return np.asarray(self.weights * output_traces(posterior_information, self.output))
        if self.dimension == 2:
            rows = posterior_information
            return np.asarray(self.weights * trace_of_inverse(rows[..., 0, 0], rows[..., 0, 1], rows[..., 1, 1]))
        if self.dimension == 1:
            return np.asarray(self.weights / posterior_information[..., 0, 0])
        covariance = np.linalg.inv(posterior_information)
        return np.asarray(self.weights * np.trace(covariance, axis1=-2, axis2=-1))

    def planar_gradient(self, a: Any, b: Any, c: Any) -> FloatArray:
        """``Lambda^{-2}`` by its entries, the off-diagonal one twice: (..., 3)."""
        return np.stack(trace_gradient(a, b, c), axis=-1)

    def gradient(self, posterior_information: FloatArray) -> FloatArray:
        """``w_j Y_j Y_j'`` with ``Y_j = Lambda_j^{-1} C_j'``: (..., M, d, d)."""
        y = self._fenchel(posterior_information)
        return np.asarray(self.weights[:, None, None] * (y @ np.swapaxes(y, -1, -2)))

    def tangent(self, point: FloatArray, target: int | None) -> Tangent:  # noqa: ARG002  (it bounds the sum)
        """``tr(C L^{-1} C') >= 2 tr(C Y) - tr(Y' L Y)`` for *any* ``Y``: an inexact inverse costs strength only."""
        value = 2 * self.weights * self._traces(self._fenchel(point))
        return Tangent(self.gradient(point), float((self._baseline - value).sum()))

    def target_tangents(self, point: FloatArray) -> TargetTangents:
        """Return the tangent target by target."""
        y, weights = self._fenchel(point), self.weights[:, None, None]
        values, turned = 2 * self.weights * self._traces(y), np.swapaxes(y, -1, -2)
        return TargetTangents(
            slope=weights * (y @ turned),
            size=weights * (abs(y) @ abs(turned)),
            offset=self._baseline - values,
            scale=abs(self._baseline) + 2 * self.weights * self._traces(abs(y), absolute=True),
        )

    def _fenchel(self, point: FloatArray) -> FloatArray:
        """(..., M, d, q) ``L^{-1} C'``."""
        inverse = symmetric_inverse(point)
        return inverse if self.output is None else np.asarray(inverse @ np.swapaxes(self.output, -1, -2))

    def _traces(self, y: FloatArray, *, absolute: bool = False) -> FloatArray:
        """(M,) ``tr(C_j Y_j)`` of (M, d, q) matrices, or with the sizes of the entries of ``C_j``."""
        if self.output is None:
            return np.asarray(np.trace(y, axis1=-2, axis2=-1))
        return np.asarray(np.einsum("mqd,mdq->m", abs(self.output) if absolute else self.output, y))

    def marginals_beyond(self, base: FloatArray, information: FloatArray) -> FloatArray:
        """Bound marginals beyond the base by those at the base, or at a point of lower rank below its covariance."""
        covariance = symmetric_inverse(base)
        values, vectors = np.linalg.eigh(covariance)
        root = (vectors * np.sqrt(np.maximum(values, 0.0))[..., None, :]) @ np.swapaxes(vectors, -1, -2)
        q = np.linalg.eigvalsh(root[:, None] @ information @ root[:, None])[..., 1:].clip(0.0)
        alone = self.criterion(base)[:, None] - self.criterion(base[:, None] + information)
        return self._larger_of(alone, q, self._largest_counted(covariance)[:, None])

    def largest_marginals(self) -> FloatArray:
        """(n, M) the larger of both kinds of extreme points."""
        values, vectors = np.linalg.eigh(self.prior)
        root = (vectors * np.sqrt(values)[:, None, :]) @ np.swapaxes(vectors, -1, -2)
        q = _upper_eigenvalues(root, self.information).clip(0.0)
        alone = self.criterion(self.prior_information) - self.criterion(self.prior_information + self.information)
        return self._larger_of(alone, q, self._largest_counted(self.prior))

    def _largest_counted(self, covariance: FloatArray) -> FloatArray:
        """(..., M) largest eigenvalue of the covariance of what counts."""
        return np.asarray(np.linalg.eigvalsh(self.counted(covariance))[..., -1])

    def _larger_of(self, alone: FloatArray, q: FloatArray, largest: FloatArray) -> FloatArray:
        """(..., M) the larger marginal: of ``alone``, and of lower rank by ``q`` (..., M, d - 1) and ``largest``."""
        lower_rank = self.weights * largest * (q / (1 + q)).sum(axis=-1)
        margin = 1e-11  # for rounding
        return np.asarray(np.maximum(alone, lower_rank) * (1 + margin))

    def conic_value(self, posterior: Sequence[Any]) -> Any:
        """``sum_j w_j [tr(C prior_j C') - sum_q c_q' L_j^{-1} c_q]`` in cvxpy."""
        import cvxpy as cp

        parts = zip(self.weights, self._outputs, posterior, strict=True)
        return self._baseline.sum() - sum(w * sum(cp.matrix_frac(row, L) for row in C) for w, C, L in parts)

    def fenchel_point(self, point: FloatArray, target: int | None) -> list[Any]:  # noqa: ARG002  (it bounds the sum)
        """``Y = L^{-1} C'`` of every target: packed if the whole state counts, else row by row."""
        y = self._fenchel(point)
        rows: list[Any] = packed(y) if self.output is None else y.reshape(len(point), -1).tolist()
        return rows

    def marginal_ends(self, owners: IntArray, budget: Budget) -> tuple[FloatArray, FloatArray]:  # noqa: ARG002
        """0, and the larger of both kinds of extreme points."""
        return np.zeros(self.n), np.asarray(self.largest_marginals().sum(axis=-1))

    @property
    def _outputs(self) -> FloatArray:
        """(M, q, d) ``C``; the identity if the whole state counts."""
        return np.broadcast_to(np.eye(self.dimension), self.prior.shape) if self.output is None else self.output

    def marginal_minorant(self, added: FloatArray, others: OtherElements, share: FloatArray) -> SeparableMinorant:
        """The tangent in ``P`` at the relaxed context, its rising part made linear, its falling part by owners."""
        posterior = self.prior_information + others.mixed(share)
        covariance, after = symmetric_inverse(posterior), symmetric_inverse(posterior + added)
        # (1 + P X)^{-1} = (L + X)^{-1} L, hence G = W - L B W B L with B = (L + X)^{-1}.
        shrunk, square = after @ posterior, np.swapaxes(self._outputs, -1, -2) @ self._outputs
        slope = square - np.swapaxes(shrunk, -1, -2) @ square @ shrunk
        value = _pairs(square, covariance - after)
        gains, axes = np.linalg.eigh(slope)
        rising = (axes * np.clip(gains, 0.0, None)[:, None, :]) @ np.swapaxes(axes, -1, -2)
        falling = np.clip(-gains, 0.0, None) * self.weights[:, None]
        tangent = self.weights[:, None, None] * (covariance @ rising @ covariance)
        constant = (self.weights * (value - _pairs(slope, covariance) + 2 * _pairs(rising, covariance))).sum()
        constant -= float((tangent * self.prior_information).sum())
        score = others.scores(tangent)
        if not falling.any():
            return SeparableMinorant(float(constant), score, np.zeros(len(others.first)))
        upper = self._inverse_majorant(others, share, axes, falling)
        return SeparableMinorant(float(constant) - upper.constant, score + upper.score, upper.absent)

    def _inverse_majorant(
        self,
        others: OtherElements,
        share: FloatArray,
        axes: FloatArray,
        strength: FloatArray,
        prior_share: float = 0.25,
    ) -> SeparableMinorant:
        """``sum_jk strength[j, k] n_jk' L^{-1} n_jk <= constant + sum of scores``, ``n_jk`` the columns of ``axes``.

        ``prior_share`` : ``t_0`` above; the owners share the rest. It trades contexts without an owner against full
        ones; from 0.1 to 0.6 the brackets of 10 robots do not move in the fourth digit, with stretched priors either
        """
        weighted = share[:, None] * others.regular
        mass = np.add.reduceat(weighted, others.first, axis=0)
        mean_inverse = np.add.reduceat(weighted[..., None, None] * others.inverse, others.first, axis=0)
        usable = mass > 0
        harmonic = np.zeros_like(mean_inverse)
        harmonic[usable] = mass[usable][:, None, None] * np.linalg.inv(mean_inverse[usable])
        potential = np.linalg.inv(self.prior_information + harmonic.sum(axis=0)) @ axes
        flow = harmonic @ potential  # (R, M, d, d): w_i of each axis, in columns
        rest = axes - flow.sum(axis=0)  # w_0, so that the shares add up exactly as computed
        cost = np.einsum("rmak,mab,rmbk,mk->rm", flow, self.prior, flow, strength, optimize=True)
        # t_i in proportion to the root of the cost makes the sum of the reserves smallest.
        root = np.sqrt(np.maximum(cost, 0.0))
        reserve = root * root.sum(axis=0) / (1 - prior_share)
        outer = np.einsum("rmak,mk,rmbk->rmab", flow, strength, flow, optimize=True)
        own = (others.inverse * outer[others.owners]).sum(axis=(-1, -2))
        kept = np.where(others.regular, np.minimum(own, reserve[others.owners]), reserve[others.owners]).sum(axis=-1)
        constant = float(np.einsum("mak,mab,mbk,mk->", rest, self.prior, rest, strength)) / prior_share
        return SeparableMinorant(constant, kept, reserve.sum(axis=-1))


def _upper_eigenvalues(root: FloatArray, matrices: FloatArray) -> FloatArray:
    """All but the smallest eigenvalue of ``root @ matrices @ root``: (M, d, d), (E, M, d, d) -> (E, M, d - 1)."""
    if matrices.shape[-1] != 2:
        return np.asarray(np.linalg.eigvalsh(root @ matrices @ root)[..., 1:])
    entries = [matrices[..., i, j] for i, j in ((0, 0), (0, 1), (1, 1))]
    return np.asarray(eigenvalues(*congruent((root[:, 0, 0], root[:, 0, 1], root[:, 1, 1]), *entries))[1][..., None])


def _pairs(first: FloatArray, second: FloatArray) -> FloatArray:
    """(M,) inner products."""
    return np.asarray((first * second).sum(axis=(-1, -2)))
