"""Marginals of the max-eigenvalue criterion, bounded from both sides.

**Its smallest marginals.** Write ``g_j(L) = w_j / lambda_min(L_j)``, so that the marginal of ``x`` is
``max_j g_j(L) - max_j g_j(L + X)``. Let target ``j`` be the worst once ``x`` is added, ``t = lambda_min(L_j + X_j)``
with eigenvector ``v``, and ``delta_j = lambda_min(X_j)``. Then ``lambda_min(L_j) <= v'L_j v = t - v'X_j v <= t -
delta_j``, and the marginal is at least ``w_j / (t - delta_j) - w_j / t = w_j delta_j / (t (t - delta_j))``, which falls
in ``t``. As ``j`` is the worst target, ``t / w_j = min_i lambda_min(L_i + X_i) / w_i <= tau``, the largest such minimum
over all contexts. For any weights ``mu_c >= 0`` with sum 1, targets ``i_c`` and unit vectors ``v_c``,

    tau <= sum_c mu_c v_c' L_{i_c} v_c / w_{i_c},

which splits into one maximum an owner. A linear program finds good ones; the bound is evaluated afresh. If
``w_j tau < lambda_min(prior information_j) + delta_j`` target ``j`` can never be the worst one.

**Its largest marginals.** Let ``j`` be the worst target before ``x`` is added, ``v`` the vector of
``lambda = lambda_min(L_j)``. Then ``lambda_min(L_j + X_j) <= lambda + v'X_j v``, so the marginal is at most
``w_j a / (lambda (lambda + a))`` with ``a = lambda_max(X_j)``, which falls in ``lambda >= lambda_min(prior
information_j)``. It is also at most the value of all that any context can reach with ``x``:
``max_j g_j(prior) - 1 / tau``.

**With an output matrix** (``maxeig.py``) levels ``l`` stand in the place of ``lambda_min`` and ``|Cv|`` in that of
``|v|``. Levels are minima of linear functions, so concave, and ``l(L + X) >= l(L) + l(X)``: all of the above holds but
for ``a``. As ``L_j >= P0^{-1}``, ``v'X_j v`` is at most ``q v'L_j v`` with ``q`` the largest eigenvalue of
``P0^{1/2} X_j P0^{1/2}``, hence ``a = q lambda``.
"""

from __future__ import annotations

from math import inf
from typing import TYPE_CHECKING, Protocol

import numpy as np

from ratt_opt.highs import LinearProgram, rows_of

if TYPE_CHECKING:
    from ratt_opt._validation import FloatArray, IntArray
    from ratt_opt.budget import Budget

__all__ = ["MARGIN", "marginal_ends"]

MARGIN = 1e-9
"""Relative safety margin for rounding."""


class Levels(Protocol):
    """Parts of a criterion whose value is one over its lowest level (``maxeig.py``)."""

    @property
    def n(self) -> int:
        """Number of elements."""

    weights: FloatArray
    information: FloatArray
    prior_information: FloatArray

    def criterion(self, posterior_information: FloatArray) -> FloatArray:
        """(..., M) of (..., M, d, d)."""

    def singletons(self) -> FloatArray:
        """(n,) values of each element alone."""

    def weakest_axes(self, matrices: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Level and axis of each matrix."""

    def least_levels(self) -> FloatArray:
        """(n, M) levels of each element's information, from below."""

    def largest_alone(self) -> FloatArray:
        """(n, M) no marginal of an element exceeds this if target ``j`` is the worst before it is added."""


def marginal_ends(f: Levels, owners: IntArray, budget: Budget) -> tuple[FloatArray, FloatArray]:
    """(n,) bounds below the smallest and above the largest marginals, over sets with at most one element an owner."""
    tau = _tau(f, owners, budget) * (1 + MARGIN)
    before = f.criterion(f.prior_information)
    least, t = f.least_levels(), tau[:, None] * f.weights
    possible = t >= (f.weights / before + least) * (1 - MARGIN)
    gain = f.weights * least / np.where(possible, t * (t - least), 1.0)
    floor = np.where(possible, gain, np.inf).min(axis=1) * (1 - MARGIN)
    reach = before.max() - 1 / tau
    ceiling = np.minimum(f.largest_alone().max(axis=1), reach) * (1 + MARGIN)
    return floor, np.maximum(ceiling, f.singletons())


def _tau(f: Levels, owners: IntArray, budget: Budget) -> FloatArray:
    """(n,) upper bounds, for each ``x``, on the largest ``min_i l(L_i) / w_i`` of sets with ``x``, one an owner."""
    groups = [np.flatnonzero(owners == i) for i in np.unique(owners)]
    scores, constants, multipliers = _cuts(f, groups, budget)
    combined = multipliers @ scores
    best = np.empty(f.n)
    total = float(multipliers @ constants)
    for own in groups:
        best[own] = combined[own].max()
        total += float(combined[own].max())
    return np.asarray(total - best + combined)


def _cuts(
    f: Levels, groups: list[IntArray], budget: Budget, rounds: int = 12, targets: int = 5
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Cuts ``constant + scores[e] + ...`` above the levels, and weights that make them strong.

    ``rounds`` : linear programs for the weights of ``tau``; 3, 6, 12, 24 leave it 2.9, 0.5, 0.02, 0 % above the last,
        in time that doubles
    ``targets`` : worst ones that get a cut in a round; with 2 instead of 5 ``tau`` is 1 % higher, in the same time
    """
    n = f.n
    one_each = rows_of([(own.tolist(), [1.0] * len(own)) for own in groups], 1.0, 1.0)
    program = LinearProgram([*[0.0] * n, -1.0], [*[0.0] * n, -inf], [*[1.0] * n, inf], rows=one_each)
    point = np.concatenate([np.full(len(own), 1 / len(own)) for own in groups])[np.argsort(np.concatenate(groups))]
    scores, constants = np.empty((0, n)), np.empty(0)
    multipliers = np.empty(0)
    for _ in range(rounds):
        posterior = f.prior_information + np.tensordot(point, f.information, axes=1)
        least, axes = f.weakest_axes(posterior)
        worst = np.argsort(least / f.weights, kind="stable")[:targets]
        v = axes[worst]
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
