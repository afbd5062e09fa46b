"""The greedy algorithm's next element without evaluating every candidate, for planar targets.

A candidate whose marginal cannot reach the best one's is not evaluated. What bounds its marginal is kept from the
last time it was: information only grows, so covariances only shrink.

- Log-det: marginals shrink with them (submodularity).
- Trace: the marginal ``g(X) = tr(X - (X^{-1} + I)^{-1}) = tr(X (X + I^{-1})^{-1} X)`` is convex in the covariance,
  and later covariances lie in ``{0 <= X <= P}``. A convex function is largest at an extreme point: 0, ``P``, or
  ``x x'`` with ``x = P^{1/2} v``, ``|v| = 1``; there it is ``|x|^2 s / (1 + s)`` with ``s = x' I x``; there
  ``|x|^2 <= lambda_max(P)`` and ``s <= mu = tr(P I)``. So no later marginal exceeds
  ``max(g(P), lambda_max(P) mu / (1 + mu))``, target by target.
- Max-eigenvalue: no bound is kept; targets are looked at worst first, and a candidate is left as soon as one of them
  stays worse than with the best candidate.

Imported only if many elements are to choose from: compiling takes seconds, once per machine (cached).
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from ratt_opt.running.compiling import numba
from ratt_opt.setfunctions.criteria.maxeig import MaxEigenvalueObjective
from ratt_opt.setfunctions.criteria.trace import TraceObjective
from ratt_opt.setfunctions.criteria.two_by_two import triples

if TYPE_CHECKING:
    from ratt_opt._validation import BoolArray, IntArray
    from ratt_opt.setfunctions.information import InformationObjective

__all__ = ["LazyGreedy"]

TRACE, WORST_AXIS = TraceObjective.compiled_code, MaxEigenvalueObjective.compiled_code
FIRST = 8
"""Candidates of the largest bounds that are evaluated first: a large marginal spares the others."""
CLOSE = 1e-11
"""Marginals that differ by less, relative to the criterion before any measurement, are compared as the plain loop
does: its values, rounded its way. It is a thousand times what either rounds off."""


class LazyGreedy:
    """Greedy choice among the elements of some robots, with the plain algorithm's answers.

    Parameters
    ----------
    objective : with compiled loops, planar targets
    is_open : (E,) candidates
    """

    def __init__(self, objective: InformationObjective, is_open: BoolArray) -> None:
        self._objective, self._is_open = objective, is_open
        # Targets last: compiled loops over them become vector instructions.
        self._information = np.ascontiguousarray(triples(objective.information).swapaxes(-1, -2))
        self._sums = np.ascontiguousarray(triples(objective.prior_information).T)
        self._bounds = np.full(len(is_open), np.inf)
        self._marginals = np.full(len(is_open), -np.inf)
        self._chosen: list[int] = []
        self._close = CLOSE * objective.prior_magnitude

    def choose(self) -> int:
        """The candidate of largest value beside those chosen, the lowest among equals; it is chosen."""
        objective = self._objective
        data = objective.compiled_code, np.array(objective.weights), self._information, self._sums
        _evaluate(data, self._is_open, self._close, (self._bounds, self._marginals))
        marginals = np.where(self._is_open, self._marginals, -np.inf)
        close = np.flatnonzero(marginals >= marginals.max() - self._close)
        pick = int(close[0]) if self._are_equal(close) else self._plainly(close)
        self._chosen.append(pick)
        self._sums = self._sums + self._information[pick]
        return pick

    def _are_equal(self, elements: IntArray) -> bool:
        return len(elements) == 1 or bool((self._information[elements] == self._information[elements[0]]).all())

    def _plainly(self, elements: IntArray) -> int:
        """As the plain loop would compare them."""
        values = self._objective.extensions(np.array(self._chosen, dtype=np.int64), elements)
        return int(elements[np.argmax(values)])


@numba.njit(cache=True)
def _evaluate(data: Any, is_open: Any, close: float, known: Any) -> None:
    """Fill in the marginals of all candidates that come within ``close`` of the largest; -inf for those that do not."""
    code, weights, information, sums = data
    bounds, marginals = known
    now = (sums, *_prepare(weights, sums))
    best, later = -np.inf, np.where(is_open, bounds, -np.inf)
    marginals[:] = -np.inf
    for _ in range(FIRST):
        e = int(np.argmax(later))
        if later[e] >= best - close:
            later[e] = -np.inf
            marginals[e], bounds[e] = _marginal(code, weights, information[e], now, best - close)
            best = max(best, marginals[e])
    for e in range(len(is_open)):
        if is_open[e] and later[e] >= best - close and later[e] > -np.inf:
            marginals[e], bounds[e] = _marginal(code, weights, information[e], now, best - close)
            best = max(best, marginals[e])


@numba.njit(cache=True)
def _prepare(weights: Any, sums: Any) -> Any:
    """(4, M) covariances as triples with their largest eigenvalue; targets, those of the largest weighted one first."""
    covariances = np.empty((4, sums.shape[1]))
    for j in range(sums.shape[1]):
        a, b, c = sums[0, j], sums[1, j], sums[2, j]
        determinant, half = a * c - b * b, (a - c) / 2
        covariances[0, j], covariances[1, j], covariances[2, j] = c / determinant, -b / determinant, a / determinant
        covariances[3, j] = ((a + c) / 2 + np.sqrt(half * half + b * b)) / determinant
    return covariances, np.argsort(-weights * covariances[3])


@numba.njit(cache=True)
def _marginal(code: int, weights: Any, added: Any, now: Any, enough: float) -> Any:
    """The marginal of an element and what bounds its later ones; may stop with ``-inf`` once it is below ``enough``."""
    sums, covariances, order = now
    if code == TRACE:
        rows = (sums[0], sums[1], sums[2]), (added[0], added[1], added[2])
        covariance = covariances[0], covariances[1], covariances[2], covariances[3]
        return _trace_marginal(weights, rows[1], rows[0], covariance)
    marginal, worst = 0.0, -np.inf
    current = weights[order[0]] * covariances[3, order[0]]
    for j in order:
        a, b, c = sums[0, j] + added[0, j], sums[1, j] + added[1, j], sums[2, j] + added[2, j]
        determinant = a * c - b * b
        if code == WORST_AXIS:
            if weights[j] * covariances[3, j] <= worst:
                break
            half = (a - c) / 2
            worst = max(worst, weights[j] * ((a + c) / 2 + np.sqrt(half * half + b * b)) / determinant)
            if current - worst < enough:
                return -np.inf, np.inf
        else:
            p, q, r = covariances[0, j], covariances[1, j], covariances[2, j]
            marginal += weights[j] * np.log(determinant * (p * r - q * q))
    if code == WORST_AXIS:
        return current - worst, np.inf
    return marginal, marginal


@numba.njit(cache=True, fastmath={"reassoc", "contract", "nsz", "nnan"})
def _trace_marginal(weights: Any, added: Any, sums: Any, covariances: Any) -> Any:
    """The marginal, and what no later one exceeds; in a form that the compiler turns into vector instructions."""
    marginal, bound = 0.0, 0.0
    (x, y, z), (u, v, t), (p, q, r, largest) = sums, added, covariances
    for j in range(len(weights)):
        a, b, c = x[j] + u[j], y[j] + v[j], z[j] + t[j]
        determinant, mu = a * c - b * b, p[j] * u[j] + 2 * q[j] * v[j] + r[j] * t[j]
        share = 1 / (determinant * (1 + mu))  # one division for both
        gain, later = p[j] + r[j] - (a + c) * (1 + mu) * share, largest[j] * mu * determinant * share
        marginal += weights[j] * gain
        bound += weights[j] * (gain if gain > later else later)
    return marginal, bound
