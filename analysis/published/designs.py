"""Choose s of n rows for the largest log-determinant: greedy with exchanges, and the bound of the concave relaxation.

The bound: ``F(x) = logdet(C + sum of x_i a_i a_i')`` is concave. For every x in the polytope of ``0 <= x <= 1`` and
``sum x = s`` no choice has more than ``F(x)`` and the s largest gradients less ``gradient . x``, whatever x the
search of Frank and Wolfe ends with.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from ratt_opt._validation import FloatArray, IntArray

__all__ = ["Design", "best_design", "entropy_design"]

TINY = 1e-9
"""Mass [1] too small to be moved: a step of it would go on for ever."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Design:
    """Log-determinant of a choice [nats], and the bound that no choice passes."""

    lower: float
    upper: float
    chosen: tuple[int, ...]


def entropy_design(covariance: FloatArray, s: int, *, rounds: int = 3000) -> Design:
    """Maximum-entropy sampling: s places of the largest ``logdet C[S, S]``.

    The bound is that of the places taken, or of the places left: ``logdet C[S, S] = logdet C + logdet D[R, R]`` with
    ``D`` the inverse and ``R`` the rest. The least one counts.
    """
    n = len(covariance)
    taken = _shifted(covariance, s, rounds)
    chosen = list(taken.chosen)
    upper, whole = taken.upper, float(np.linalg.slogdet(covariance)[1])
    if s < n:
        inverse: FloatArray = np.linalg.inv(covariance).astype(np.float64)
        upper = min(upper, whole + _shifted(inverse, n - s, rounds).upper + 1e-9 * (1 + abs(whole)))
    exact = float(np.linalg.slogdet(covariance[np.ix_(chosen, chosen)])[1])
    return Design(lower=exact, upper=upper, chosen=taken.chosen)


def _shifted(covariance: FloatArray, s: int, rounds: int) -> Design:
    """Bound by the log-det criterion of this library.

    With the least eigenvalue m of C and ``C - m I = G G'``: ``logdet C[S, S] = s log m + logdet(I + sum g g' / m)``.
    The shift is a little below m, so that rounding keeps ``C - m I`` semidefinite.
    """
    values, vectors = np.linalg.eigh((covariance + covariance.T) / 2)
    least = float(values[0]) * (1 - 1e-9)
    rows = vectors * np.sqrt(np.maximum(values - least, 0.0)) / np.sqrt(least)
    found = best_design(np.eye(len(values)), rows, s, rounds=rounds)
    shift = s * float(np.log(least))
    return Design(lower=found.lower + shift, upper=found.upper + shift, chosen=found.chosen)


def best_design(start: FloatArray, rows: FloatArray, s: int, *, rounds: int = 3000) -> Design:
    """Choose s of the rows (n, d) beside the information ``start`` (d, d), positive definite."""
    chosen = _exchanged(start, rows, _greedy(start, rows, s))
    value = float(np.linalg.slogdet(start + rows[chosen].T @ rows[chosen])[1])
    return Design(lower=value, upper=_bound(start, rows, s, chosen, rounds), chosen=tuple(sorted(map(int, chosen))))


def _greedy(start: FloatArray, rows: FloatArray, s: int) -> IntArray:
    """Rows in the order of their marginal gains ``log(1 + a' L^-1 a)``."""
    inverse, chosen = np.linalg.inv(start), np.zeros(0, dtype=np.int64)
    for _ in range(s):
        gains = np.einsum("ij,jk,ik->i", rows, inverse, rows)
        gains[chosen] = -np.inf
        pick = int(gains.argmax())
        step = inverse @ rows[pick]
        inverse = inverse - np.outer(step, step) / (1.0 + float(rows[pick] @ step))
        chosen = np.append(chosen, pick)
    return chosen


def _exchanged(start: FloatArray, rows: FloatArray, chosen: IntArray) -> IntArray:
    """Exchange one chosen row for another as long as the determinant grows.

    Without row a and with row b it is multiplied by ``(1 - a'Pa)(1 + b'Pb) + (a'Pb)^2``, P the inverse.
    """
    current = chosen.copy()
    while True:
        inverse = np.linalg.inv(start + rows[current].T @ rows[current])
        products = rows @ inverse @ rows[current].T
        own = np.einsum("ij,jk,ik->i", rows, inverse, rows)
        factor = (1.0 - own[current]) * (1.0 + own[:, None]) + products**2
        factor[current] = 0.0
        into, out = np.unravel_index(int(factor.argmax()), factor.shape)
        if factor[into, out] <= 1.0 + 1e-10:
            return current
        current[out] = into


def _bound(start: FloatArray, rows: FloatArray, s: int, chosen: IntArray, rounds: int) -> float:
    """Least bound over the points of a search that moves mass from the least to the largest gradient."""
    x = np.full(len(rows), s / len(rows))
    x[chosen] = 0.5 * (1 + s / len(rows))
    x *= s / x.sum()
    x = np.minimum(x, 1.0)
    x += (s - x.sum()) * (1 - x) / max((1 - x).sum(), 1e-12)
    best = np.inf
    for _ in range(rounds):
        information = start + (rows * x[:, None]).T @ rows
        inverse = np.linalg.inv(information)
        gradient = np.einsum("ij,jk,ik->i", rows, inverse, rows)
        value = float(np.linalg.slogdet(information)[1])
        gap = float(np.sort(gradient)[-s:].sum() - gradient @ x)
        best = min(best, value + gap + 1e-9 * (1 + abs(value)))
        if gap < 1e-6:
            break
        into = int(np.where(x < 1 - TINY, gradient, -np.inf).argmax())
        out = int(np.where(x > TINY, gradient, np.inf).argmin())
        cross = float(rows[into] @ inverse @ rows[out])
        # det grows by 1 + t (g_in - g_out) - t^2 (g_in g_out - cross^2).
        curve = gradient[into] * gradient[out] - cross**2
        longest = min(1 - x[into], x[out])
        step = longest if curve <= 0 else min(longest, (gradient[into] - gradient[out]) / (2 * curve))
        x[into], x[out] = x[into] + step, x[out] - step
    return best
