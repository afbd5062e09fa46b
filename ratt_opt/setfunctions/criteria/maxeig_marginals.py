"""How small one element's marginal of the max-eigenvalue criterion can be, and how large, in any dimension.

Write ``g_j(L) = w_j / lambda_min(L_j)``, so that the marginal of ``x`` is ``max_j g_j(L) - max_j g_j(L + X)``.

*From below.* Let target ``j`` be the worst once ``x`` is added, ``t = lambda_min(L_j + X_j)`` with eigenvector ``v``,
and ``delta_j = lambda_min(X_j)``. Then ``lambda_min(L_j) <= v'L_j v = t - v'X_j v <= t - delta_j``, and the marginal
is at least ``w_j / (t - delta_j) - w_j / t = w_j delta_j / (t (t - delta_j))``, which falls in ``t``. As ``j`` is the
worst target, ``t / w_j = min_i lambda_min(L_i + X_i) / w_i <= tau``, the largest such minimum over all contexts. For
any weights ``mu_c >= 0`` with sum 1, targets ``i_c`` and unit vectors ``v_c``,

    tau <= sum_c mu_c v_c' L_{i_c} v_c / w_{i_c},

which splits into one maximum an owner. A linear program finds good ones; the bound is evaluated afresh. Where
``w_j tau < lambda_min(prior information_j) + delta_j`` target ``j`` can never be the worst one.

*From above.* Let ``j`` be the worst target before ``x`` is added, ``v`` the vector of ``lambda = lambda_min(L_j)``.
Then ``lambda_min(L_j + X_j) <= lambda + v'X_j v``, so the marginal is at most ``w_j a / (lambda (lambda + a))`` with
``a = lambda_max(X_j)``, which falls in ``lambda >= lambda_min(prior information_j)``. It is also at most the value
of all that any context can reach with ``x``: ``max_j g_j(prior) - 1 / tau``.
"""

from __future__ import annotations

from math import inf
from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.highs import LinearProgram, rows_of

if TYPE_CHECKING:
    from ratt_opt._validation import FloatArray, IntArray
    from ratt_opt.budget import Budget
    from ratt_opt.setfunctions.information import InformationObjective

__all__ = ["marginal_ends"]

ROUNDS = 12
"""Linear programs solved for the weights of ``tau``."""
CUTS = 5
"""Worst targets that get a cut a round."""
MARGIN = 1e-9
"""Relative safety margin for rounding."""


def marginal_ends(f: InformationObjective, owners: IntArray, budget: Budget) -> tuple[FloatArray, FloatArray]:
    """(n,) proved lower bounds on the smallest and upper bounds on the largest marginals over every context."""
    tau = _tau(f, owners, budget) * (1 + MARGIN)
    eigenvalues = np.linalg.eigvalsh(f.information)
    least = np.clip(eigenvalues[..., 0] * (1 - MARGIN) - MARGIN * eigenvalues[..., -1], 0.0, None)
    most = np.clip(eigenvalues[..., -1], 0.0, None)
    start = np.linalg.eigvalsh(f.prior_information)[:, 0]
    t = tau[:, None] * f.weights
    possible = t >= (start + least) * (1 - MARGIN)
    gain = f.weights * least / np.where(possible, t * (t - least), 1.0)
    floor = np.where(possible, gain, np.inf).min(axis=1) * (1 - MARGIN)
    ceiling = (f.weights * most / (start * (start + most))).max(axis=1)
    reach = f.criterion(f.prior_information).max() - 1 / tau
    return floor, np.maximum(np.minimum(ceiling, reach) * (1 + MARGIN), f.singletons())


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
