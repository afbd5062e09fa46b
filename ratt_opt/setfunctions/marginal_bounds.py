"""Certified brackets of the marginals of information criteria over domains too large to enumerate.

Let ``x`` have information ``I = sum_k a_k u_k u_k'`` (orthonormal ``u_k``) about one target, and let the context
have posterior information ``L``, covariance ``P = L^{-1}``, prior ``P0``.

*Smallest marginal, from below.* Adding the rank-one terms one after the other, with
``s_k = u_k' P u_k >= 1 / (u_k' L u_k)`` (Cauchy-Schwarz) and ``u_k' P^2 u_k >= s_k^2``, and since earlier terms do not
change ``u_k' L u_k`` of the later ones:

    trace:   marginal >= sum_k h_k(u_k' L u_k),  h_k(y) = 1/y - 1/(y + a_k)
    log-det: marginal >= sum_k h_k(u_k' L u_k),  h_k(y) = log(1 + a_k / y)

(pinching in the eigenbasis of ``I``). Each ``h_k`` is convex and ``u_k' L u_k`` is linear in the context, so a
tangent at any relaxed context bounds all contexts, and its minimum splits into one per other robot. The tangent point
is improved by conditional-gradient steps.

*Largest marginal, from above.* ``(P^{-1} + I)^{-1}`` is concave in ``P`` (parallel sum), so the trace marginal is
convex in ``P`` and largest at an extreme point of ``0 <= P <= P0``: at ``P0`` (no context), or at a rank-one
``P = w w'`` with ``w' P0^{-1} w = 1``, where it is ``|w|^2 q / (1 + q)`` with ``q = w' I w``, at most
``lambda_max(P0) q_max / (1 + q_max)``, ``q_max = lambda_max(P0^{1/2} I P0^{1/2})``. An isotropic prior makes the first
the larger. The log-det marginal is largest without context. The max-eigenvalue marginal is at most the value of all
elements together, and at least 0.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.setfunctions.information import InformationObjective, LogDetObjective, TraceObjective
from ratt_opt.setfunctions.marginals import Marginals

if TYPE_CHECKING:
    from ratt_opt._validation import FloatArray, IntArray

__all__ = ["bracket_marginals"]

STEPS = 24
SWEEPS = 2
MARGIN = 1e-11
"""Relative safety margin for rounding on every bound."""


def bracket_marginals(f: InformationObjective, owners: IntArray) -> Marginals:
    """Bracket the smallest and largest marginal of every element over sets with at most one element per owner."""
    single = f.singletons()
    nothing: tuple[tuple[int, ...], ...] = ((),) * f.n
    lower = np.zeros(f.n)
    upper = np.empty(f.n)
    contexts: list[tuple[int, ...]] = []
    smooth = isinstance(f, (TraceObjective, LogDetObjective))
    for x in range(f.n):
        search = _ContextSearch(f, owners, x, single)
        if smooth:
            lower[x] = search.minorant()
        upper[x], context = search.attained()
        contexts.append(context)
    largest_upper = _largest(f, single)
    return Marginals(np.minimum(lower, upper), upper, single, largest_upper, tuple(contexts), nothing)


def _largest(f: InformationObjective, single: FloatArray) -> FloatArray:
    """(n,) upper bounds on the largest marginals."""
    if isinstance(f, LogDetObjective):
        return single * (1 + MARGIN)
    if not isinstance(f, TraceObjective):
        # The worst target's criterion cannot fall below that of all elements together.
        return np.full(f.n, f(range(f.n)) * (1 + MARGIN))
    values, vectors = np.linalg.eigh(f.prior)
    root = (vectors * np.sqrt(values)[:, None, :]) @ np.swapaxes(vectors, -1, -2)
    q = np.linalg.eigvalsh(root @ f.information @ root)[..., -1]
    rank_one = f.weights * values[:, -1] * q / (1 + q)
    alone = f.criterion(f.prior_information) - f.criterion(f.prior_information + f.information)
    return np.asarray(np.maximum(alone, rank_one).sum(axis=-1) * (1 + MARGIN))


class _ContextSearch:
    """Contexts of one element: what the others may contribute, and how small the marginal gets."""

    def __init__(self, f: InformationObjective, owners: IntArray, x: int, single: FloatArray) -> None:
        self.f, self.x = f, x
        self.others = [np.flatnonzero(owners == i) for i in np.unique(owners) if i != owners[x]]
        self._found: list[tuple[int, ...]] = [tuple(int(own[single[own].argmax()]) for own in self.others)]

    def minorant(self) -> float:
        """Lower bound on the marginal over all contexts, by tangents of the pinched minorant."""
        f = self.f
        a, u = np.linalg.eigh(f.information[self.x])
        a = np.clip(a, 0.0, None)
        # y[e', j, k] = u_jk' I_e'j u_jk : what each other element adds to u_k' L u_k.
        y = np.einsum("jak,ejab,jbk->ejk", u, f.information, u, optimize=True)
        start = np.einsum("jak,jab,jbk->jk", u, f.prior_information, u)
        point = start.copy()
        best = 0.0
        for step in range(STEPS):
            value, slope = _minorant_terms(f, point, a)
            gain = np.einsum("jk,ejk->e", slope, y)
            picks = tuple(int(own[gain[own].argmin()]) for own in self.others)
            vertex = start + y[list(picks)].sum(axis=0)
            bound = value + float((slope * (vertex - point)).sum())
            best = max(best, bound - MARGIN * (abs(value) + abs(bound)))
            self._found.append(picks)
            point = point + 2 / (step + 2) * (vertex - point)
        return best

    def attained(self) -> tuple[float, tuple[int, ...]]:
        """The smallest marginal found, and its context: the search's contexts, then coordinate descent."""
        contexts = list(dict.fromkeys([(), *self._found]))
        values = [self._marginal(np.array(c, dtype=np.int64)[None])[0] for c in contexts]
        best = int(np.argmin(values))
        value, context = float(values[best]), list(contexts[best])
        if not context:
            return value, ()
        for _ in range(SWEEPS):
            before = value
            for i, own in enumerate(self.others):
                trials = np.tile(np.array(context), (len(own), 1))
                trials[:, i] = own
                marginals = self._marginal(trials)
                k = int(marginals.argmin())
                if marginals[k] < value:
                    value, context[i] = float(marginals[k]), int(own[k])
            if value >= before:
                break
        return value, tuple(context)

    def _marginal(self, contexts: IntArray) -> FloatArray:
        f = self.f
        posterior = f.prior_information + f.information[contexts].sum(axis=1)
        return f.value(posterior + f.information[self.x]) - f.value(posterior)


def _minorant_terms(f: InformationObjective, y: FloatArray, a: FloatArray) -> tuple[float, FloatArray]:
    """Value and slope (M, d) of the pinched minorant at ``y = u_k' L u_k`` (M, d)."""
    w = f.weights[:, None]
    if isinstance(f, TraceObjective):
        value = w * a / (y * (y + a))
        slope = -w * a * (2 * y + a) / (y * (y + a)) ** 2
    else:
        value = w * np.log1p(a / y)
        slope = -w * a / (y * (y + a))
    return float(value.sum()), slope
