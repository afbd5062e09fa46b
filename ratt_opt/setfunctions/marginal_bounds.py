"""Certified brackets of the marginals of information criteria over domains too large to enumerate.

*Smallest marginals* of trace and log-det: branch and bound with separable minorants, always on the element whose
ratio of smallest to largest marginal is the least certain, until the ratio that decides the curvature is known within
the gap, or a budget is spent (:mod:`ratt_opt.setfunctions.context_search`).

*Largest marginals*, from above. ``(P^{-1} + I)^{-1}`` is concave in ``P`` (parallel sum), so the trace marginal is
convex in ``P`` and largest at an extreme point of ``0 <= P <= P0``: at ``P0`` (no context), or at a rank-one
``P = w w'`` with ``w' P0^{-1} w = 1``, where it is ``|w|^2 q / (1 + q)`` with ``q = w' I w``, at most
``lambda_max(P0) q_max / (1 + q_max)``, ``q_max = lambda_max(P0^{1/2} I P0^{1/2})``. An isotropic prior makes the first
the larger. The log-det marginal is largest without context. The max-eigenvalue marginal is at most the value of all
elements together, and at least 0.
"""

from __future__ import annotations

import time
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.setfunctions.context_search import ContextSearch
from ratt_opt.setfunctions.eigenvalue_search import EigenvalueSearch
from ratt_opt.setfunctions.information import (
    InformationObjective,
    LogDetObjective,
    MaxEigenvalueObjective,
    TraceObjective,
)
from ratt_opt.setfunctions.marginals import Marginals
from ratt_opt.stopping import Stop

if TYPE_CHECKING:
    from ratt_opt._validation import FloatArray, IntArray

__all__ = ["Budget", "bracket_marginals"]

MARGIN = 1e-11
"""Relative safety margin for rounding on the largest marginals."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Budget:
    """When to stop: ``(1 - lower) / (1 - upper) <= 1 + gap``, ``seconds``, or ``nodes`` parts bounded."""

    gap: float
    seconds: float | None
    nodes: int | None
    began: float = field(default_factory=time.monotonic)

    def spent(self, nodes: int) -> Stop | None:
        """Why to stop now, if at all."""
        if self.nodes is not None and nodes >= self.nodes:
            return Stop.NODES
        if self.seconds is not None and time.monotonic() - self.began >= self.seconds:
            return Stop.TIME
        return None


@dataclass(frozen=True, slots=True, kw_only=True)
class BracketedMarginals:
    """Marginals known within brackets, why the search for them stopped, and the parts it bounded."""

    marginals: Marginals
    stop: Stop
    nodes: int


def bracket_marginals(
    f: InformationObjective, owners: IntArray, budget: Budget, *, against_own: bool
) -> BracketedMarginals:
    """Bracket the smallest and largest marginal of every element over sets with at most one element per owner.

    ``against_own`` : the ratio that matters is to ``f({x})`` (curvature), not to the largest marginal.
    """
    single = f.singletons()
    largest = _largest(f, single)
    search = _Searches(f, owners, single if against_own else largest, single, budget)
    stop = search.run()
    lower, upper, contexts = search.ends()
    nothing: tuple[tuple[int, ...], ...] = ((),) * f.n
    found = Marginals(lower, upper, single, largest, contexts, nothing)
    return BracketedMarginals(marginals=found, stop=stop, nodes=search.nodes)


class _Searches:
    """One search an element; the least certain ratio is refined first."""

    def __init__(
        self, f: InformationObjective, owners: IntArray, most: FloatArray, seen: FloatArray, budget: Budget
    ) -> None:
        self.f, self.owners, self.budget = f, owners, budget
        self.most, self.seen = most, seen
        self.searches: list[ContextSearch | EigenvalueSearch] = []
        self._search = EigenvalueSearch if isinstance(f, MaxEigenvalueObjective) else ContextSearch

    @property
    def nodes(self) -> int:
        """Parts bounded so far."""
        return sum(search.nodes for search in self.searches)

    def run(self) -> Stop:
        """Search until the deciding ratio is known or the budget is spent."""
        try:
            for x in range(self.f.n):
                self.searches.append(self._search(self.f, self.owners, x))
                if stop := self.budget.spent(0):
                    return stop
            while True:
                lower, upper, _ = self.ends()
                safe = np.where(self.most > 0, lower / np.where(self.most > 0, self.most, 1.0), np.inf)
                shown = np.where(self.seen > 0, upper / np.where(self.seen > 0, self.seen, 1.0), np.inf)
                order = [int(x) for x in np.argsort(safe, kind="stable") if not self.searches[x].exhausted]
                target = float(shown.min(initial=np.inf)) / (1 + self.budget.gap)
                weak = [x for x in order if safe[x] < target]
                if not weak:
                    return Stop.GAP if order else Stop.CLOSED
                if stop := self.budget.spent(self.nodes):
                    return stop
                self.searches[weak[0]].refine()
        except KeyboardInterrupt:
            return Stop.INTERRUPTED

    def ends(self) -> tuple[FloatArray, FloatArray, tuple[tuple[int, ...], ...]]:
        """Lower and upper ends of the smallest marginals and contexts; of no search yet: 0 and the value alone."""
        lower, upper = np.zeros(self.f.n), self.f.singletons()
        contexts: list[tuple[int, ...]] = [()] * self.f.n
        for x, search in enumerate(self.searches):
            lower[x], upper[x], contexts[x] = max(search.lower, 0.0), search.attained.value, search.attained.context
        return np.minimum(lower, upper), upper, tuple(contexts)


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
