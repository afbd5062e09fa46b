"""Certified brackets of the marginals of information criteria over domains too large to enumerate.

*Smallest marginals* of trace and log-det: branch and bound with separable minorants, always on the element whose
ratio of smallest to largest marginal is the least certain, until the ratio that decides the curvature is known within
the gap, or a budget is spent (:mod:`ratt_opt.curvatures.separable.context_search`).

*Largest marginals*, from above. ``(P^{-1} + I)^{-1}`` is concave in ``P`` (parallel sum), so the trace marginal is
convex in ``P`` and largest at an extreme point of ``0 <= P <= P0``: at ``P0`` (no context), or at a rank-one
``P = w w'`` with ``w' P0^{-1} w = 1``, where it is ``|w|^2 q / (1 + q)`` with ``q = w' I w``, at most
``lambda_max(P0) q_max / (1 + q_max)``, ``q_max = lambda_max(P0^{1/2} I P0^{1/2})``. An isotropic prior makes the first
the larger. The log-det marginal is largest without context.

The max-eigenvalue criterion has its own bounds, see :mod:`ratt_opt.curvatures.planar.eigenvalue_search`.
"""

from __future__ import annotations

import time
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.curvatures.attained import Attained
from ratt_opt.curvatures.marginals import Marginals
from ratt_opt.curvatures.planar.eigenvalue_search import EigenvalueSearch, eigenvalue_ends
from ratt_opt.curvatures.planar.planar import LARGEST_DIMENSION
from ratt_opt.curvatures.planar.planar_marginals import PlanarBrackets
from ratt_opt.curvatures.separable.context_search import ContextSearch
from ratt_opt.curvatures.separable.minorants import others_of
from ratt_opt.setfunctions.criteria.logdet import LogDetObjective
from ratt_opt.setfunctions.criteria.maxeig import MaxEigenvalueObjective
from ratt_opt.setfunctions.criteria.trace import TraceObjective
from ratt_opt.stopping import Stop

if TYPE_CHECKING:
    from ratt_opt._validation import FloatArray, IntArray
    from ratt_opt.setfunctions.information import InformationObjective

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
    if isinstance(f, MaxEigenvalueObjective) and f.dimension <= LARGEST_DIMENSION:
        brackets = PlanarBrackets(f, owners, budget, against_own=against_own)
        stop = brackets.run()
        return BracketedMarginals(marginals=brackets.marginals(), stop=stop, nodes=brackets.nodes)
    single = f.singletons()
    if isinstance(f, MaxEigenvalueObjective):
        ends = eigenvalue_ends(f, owners)
        largest, floor = ends.ceiling, ends.floor
    else:
        largest, floor = _largest(f, single), np.zeros(f.n)
    nothing: tuple[tuple[int, ...], ...] = ((),) * f.n
    seen, contexts = (single, nothing) if against_own else _seen_largest(f, owners, single, largest)
    search = _Searches(f, owners, _Denominators(single if against_own else largest, seen), floor, budget)
    stop = search.run()
    lower, upper, smallest = search.ends()
    found = Marginals(lower, upper, seen, np.maximum(largest, seen), smallest, contexts)
    return BracketedMarginals(marginals=found, stop=stop, nodes=search.nodes)


def _seen_largest(
    f: InformationObjective, owners: IntArray, single: FloatArray, largest: FloatArray
) -> tuple[FloatArray, tuple[tuple[int, ...], ...]]:
    """Attained ends of the largest marginals: the value alone where that is known to be it, else a search."""
    seen = single.copy()
    contexts: list[tuple[int, ...]] = [()] * f.n
    for x in np.flatnonzero(largest > single * (1 + 1e-6)).tolist():
        attained = Attained(f, x, others_of(f, owners, x), largest=True)
        attained.descend()
        seen[x], contexts[x] = attained.value, attained.context
    return seen, tuple(contexts)


@dataclass(frozen=True, slots=True)
class _Denominators:
    """(n,) proved upper bounds and attained values of what the smallest marginals are compared with."""

    most: FloatArray
    seen: FloatArray


class _Searches:
    """One search an element; the least certain ratio is refined first."""

    def __init__(
        self, f: InformationObjective, owners: IntArray, compared: _Denominators, floor: FloatArray, budget: Budget
    ) -> None:
        self.f, self.owners, self.budget = f, owners, budget
        self.most, self.seen, self.floor = compared.most, compared.seen, floor
        self.searches: list[ContextSearch | EigenvalueSearch] = []

    @property
    def nodes(self) -> int:
        """Parts bounded so far."""
        return sum(search.nodes for search in self.searches)

    def _search(self, x: int) -> ContextSearch | EigenvalueSearch:
        if isinstance(self.f, MaxEigenvalueObjective):
            return EigenvalueSearch(self.f, self.owners, x, float(self.floor[x]))
        return ContextSearch(self.f, self.owners, x)

    def run(self) -> Stop:
        """Search until the deciding ratio is known or the budget is spent."""
        try:
            for x in range(self.f.n):
                self.searches.append(self._search(x))
                if stop := self.budget.spent(self.nodes):
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
        lower, upper = self.floor.copy(), self.f.singletons()
        contexts: list[tuple[int, ...]] = [()] * self.f.n
        for x, search in enumerate(self.searches):
            lower[x], upper[x], contexts[x] = max(search.lower, 0.0), search.attained.value, search.attained.context
        return np.minimum(lower, upper), upper, tuple(contexts)


def _largest(f: InformationObjective, single: FloatArray) -> FloatArray:
    """(n,) upper bounds on the largest marginals."""
    if isinstance(f, LogDetObjective):
        return single * (1 + MARGIN)
    assert isinstance(f, TraceObjective)
    values, vectors = np.linalg.eigh(f.prior)
    root = (vectors * np.sqrt(values)[:, None, :]) @ np.swapaxes(vectors, -1, -2)
    q = np.linalg.eigvalsh(root @ f.information @ root)[..., -1]
    rank_one = f.weights * values[:, -1] * q / (1 + q)
    alone = f.criterion(f.prior_information) - f.criterion(f.prior_information + f.information)
    return np.asarray(np.maximum(alone, rank_one).sum(axis=-1) * (1 + MARGIN))
