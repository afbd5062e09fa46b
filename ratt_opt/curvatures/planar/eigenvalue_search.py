"""How small one element's marginal of the max-eigenvalue criterion can be, and how large, in any dimension.

Write ``g_j(L) = w_j / lambda_min(L_j)``, so that the marginal of ``x`` is ``max_j g_j(L) - max_j g_j(L + X)``.

*From below.* Let target ``j`` be the worst once ``x`` is added, ``t = lambda_min(L_j + X_j)`` with eigenvector ``v``,
and ``delta_j = lambda_min(X_j)``. Then ``lambda_min(L_j) <= v'L_j v = t - v'X_j v <= t - delta_j``, and the marginal
is at least ``w_j / (t - delta_j) - w_j / t = w_j delta_j / (t (t - delta_j))``, which falls in ``t``. As ``j`` is the
worst target, ``t / w_j = min_i lambda_min(L_i + X_i) / w_i <= tau``, the largest such minimum over all contexts. For
any weights ``mu_c >= 0`` with sum 1, targets ``i_c`` and unit vectors ``v_c``,

    tau <= sum_c mu_c v_c' L_{i_c} v_c / w_{i_c},

which splits into one maximum a robot. A linear program finds good ones; the bound is evaluated afresh. Where
``w_j tau < lambda_min(prior information_j) + delta_j`` target ``j`` can never be the worst one.

*From above.* Let ``j`` be the worst target before ``x`` is added, ``v`` the vector of ``lambda = lambda_min(L_j)``.
Then ``lambda_min(L_j + X_j) <= lambda + v'X_j v``, so the marginal is at most ``w_j a / (lambda (lambda + a))`` with
``a = lambda_max(X_j)``, which falls in ``lambda >= lambda_min(prior information_j)``. It is also at most the value
of all that any context can reach with ``x``: ``max_j g_j(prior) - 1 / tau``.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.curvatures.attained import Attained
from ratt_opt.curvatures.separable.minorants import others_of

if TYPE_CHECKING:
    from ratt_opt._validation import FloatArray, IntArray
    from ratt_opt.setfunctions.information import InformationObjective

__all__ = ["EigenvalueEnds", "EigenvalueSearch", "eigenvalue_ends"]

ROUNDS = 12
"""Linear programs solved for the weights of ``tau``."""
CUTS = 5
"""Worst targets that get a cut a round."""
MARGIN = 1e-9
"""Relative safety margin for rounding."""


@dataclass(frozen=True, slots=True)
class EigenvalueEnds:
    """(n,) proved ``floor`` of every smallest marginal and ``ceiling`` of every largest one."""

    floor: FloatArray
    ceiling: FloatArray


class EigenvalueSearch:
    """Claim: ``lower <= smallest marginal of x over contexts <= attained.value``; see :class:`Attained`."""

    def __init__(self, f: InformationObjective, owners: IntArray, x: int, floor: float) -> None:
        others = others_of(f, owners, x)
        self.attained = Attained(f, x, others)
        self.nodes = 1
        single = f.singletons()[others.elements]
        parts = [np.flatnonzero(others.robot == i) for i in range(len(others.first))]
        best = [int(part[single[part].argmax()]) for part in parts]
        self.attained.offer(others.elements[np.array(best, dtype=np.int64)])
        self.attained.descend()
        self.lower = min(floor, self.attained.value)

    @property
    def exhausted(self) -> bool:
        """Nothing is left to refine."""
        return True

    def refine(self) -> None:
        """Nothing is left to refine."""


def eigenvalue_ends(f: InformationObjective, owners: IntArray) -> EigenvalueEnds:
    """Bounds on the marginals of every element that hold for every context."""
    tau = _tau(f, owners) * (1 + MARGIN)
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
    return EigenvalueEnds(floor, np.maximum(np.minimum(ceiling, reach) * (1 + MARGIN), f.singletons()))


def _tau(f: InformationObjective, owners: IntArray) -> FloatArray:
    """(n,) upper bounds, for each ``x``, on the largest ``min_i lambda_min(L_i) / w_i`` of sets with ``x``."""
    robots = [np.flatnonzero(owners == i) for i in np.unique(owners)]
    scores, constants, multipliers = _cuts(f, robots)
    combined = multipliers @ scores
    best = np.empty(f.n)
    total = float(multipliers @ constants)
    for own in robots:
        best[own] = combined[own].max()
        total += float(combined[own].max())
    return np.asarray(total - best + combined)


def _cuts(f: InformationObjective, robots: list[IntArray]) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Cuts ``constant + scores[e] + ...`` above the smallest eigenvalues, and weights that make them strong."""
    from scipy.optimize import linprog

    n = f.n
    shares = np.zeros((len(robots), n + 1))
    for i, own in enumerate(robots):
        shares[i, own] = 1.0
    point = shares[:, :n].T @ (1 / shares.sum(axis=1))
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
        rows = np.concatenate([-scores, np.ones((len(scores), 1))], axis=1)
        solved = linprog(
            np.append(np.zeros(n), -1.0),
            A_ub=rows,
            b_ub=constants,
            A_eq=shares,
            b_eq=np.ones(len(robots)),
            bounds=[(0.0, 1.0)] * n + [(None, None)],
        )
        if solved.x is None:
            break
        found = np.clip(-solved.ineqlin.marginals, 0.0, None)
        if found.sum() <= 0:
            break
        multipliers, point = found / found.sum(), np.clip(solved.x[:n], 0.0, 1.0)
    if len(multipliers) == 0:
        multipliers = np.full(len(scores), 1 / len(scores))
    return scores[: len(multipliers)], constants[: len(multipliers)], multipliers
