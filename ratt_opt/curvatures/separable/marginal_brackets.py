"""Brackets of the marginals of every element of an information criterion.

Every element has the criterion's own bounds at once (``marginal_ends``); each is then searched for its smallest one.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.curvatures.marginals import MarginalBrackets
from ratt_opt.curvatures.separable.context_search import BestContext, ContextSearch, FloorSearch
from ratt_opt.setfunctions.criteria.two_by_two import determinant, eigenvalues
from ratt_opt.setfunctions.criterion_parts import OtherElements

if TYPE_CHECKING:
    from collections.abc import Sized

    from ratt_opt._validation import BoolArray, FloatArray, IntArray
    from ratt_opt.budget import Stop
    from ratt_opt.setfunctions.information import InformationObjective

__all__ = ["SeparableBrackets", "other_elements"]


class SeparableBrackets(MarginalBrackets):
    """One search an element, over contexts of at most one element of each other owner."""

    def _prepare(self) -> None:
        self._choices: dict[int, OtherElements] = {}
        self._searches: list[ContextSearch | FloorSearch] = []
        self._largest: dict[int, BestContext] = {}
        self._on_top: dict[int, tuple[int, ...]] = {}
        self._branches = self._f.overrides("marginal_minorant")
        self.rests_on = "separable minorants" if self._branches else "bounds for all contexts"

    def _begin(self) -> Stop | None:
        floor, ceiling = self._f.marginal_ends(self._owners, self._budget)
        self._attain_on_top()
        self.least = np.minimum(floor, self.seen_least)
        if not self._against_own:
            self.most = np.maximum(ceiling, self._single)
            # Attained ends of the largest marginals, where the value alone is not known to be it.
            slightly = 1 + 1e-6  # a bound that exceeds the value alone by no more is that value and its margin
            for x in np.flatnonzero(self.most > self.seen_most * slightly).tolist():
                if self._is_over(self._largest):
                    break
                self._largest[x] = BestContext(self._f, x, self._beside(x), largest=True)
                self._largest[x].descend(self._budget)
                self.seen_most[x] = self._largest[x].value
                self.most[x] = max(self.most[x], self.seen_most[x])
        for x in range(self._f.n):
            if self._is_over(self._searches):
                return self._budget.stop()
            others, attained = self._beside(x), BestContext(self._f, x, self._beside(x))
            if self._branches:
                search: ContextSearch | FloorSearch = ContextSearch(
                    self._f, x, others, attained, budget=self._budget, params=self._params.separable
                )
            else:
                search = FloorSearch(attained, others, self._single, float(self.least[x]), self._budget)
            self._searches.append(search)
            self._budget.nodes += search.nodes
            self._record(x)
        return None

    def _attain_on_top(self) -> None:
        """Attain a small marginal of every element at once: on top of the strongest elements of all other owners."""
        f, owners = self._f, self._owners
        groups = [np.flatnonzero(owners == i) for i in np.unique(owners)]
        best = np.array([own[self._single[own].argmax()] for own in groups], dtype=np.int64)
        nothing = np.zeros((1, *f.prior_information.shape))
        below = np.cumsum(np.concatenate([nothing, f.information[best[:-1]]]), axis=0)
        above = np.cumsum(np.concatenate([nothing, f.information[best[:0:-1]]]), axis=0)[::-1]
        others = (f.prior_information + below + above)[owners]
        marginals = f.value(others + f.information) - f.value(others)
        contexts = [tuple(np.delete(best, i).tolist()) for i in range(len(best))]
        self._on_top = {x: contexts[owners[x]] for x in np.flatnonzero(marginals < self._single).tolist()}
        self.seen_least = np.minimum(self._single, marginals)

    def _is_over(self, searched: Sized) -> bool:
        """Test whether to stop before the next element; one that is quick to evaluate is searched in any case."""
        is_quick = self._f.n * self._f.n_targets <= self._params.separable.at_once
        return self._budget.stop() is not None and (len(searched) > 0 or not is_quick)

    def _beside(self, x: int) -> OtherElements:
        owner = int(self._owners[x])
        if owner not in self._choices:
            self._choices[owner] = other_elements(self._f, self._owners, owner)
        return self._choices[owner]

    def _refine(self, x: int, target: float) -> None:  # noqa: ARG002  (a minorant has no aim)
        search = self._searches[x]
        before = search.nodes
        search.refine()
        self._budget.nodes += search.nodes - before
        self._record(x)

    def _record(self, x: int) -> None:
        search = self._searches[x]
        if search.attained.value <= self.seen_least[x]:
            self.seen_least[x] = search.attained.value
            self._on_top.pop(x, None)
        self.least[x] = min(max(search.lower, 0.0), self.seen_least[x])
        self._done[x] = search.exhausted

    def _attaining(self) -> tuple[list[tuple[int, ...]], list[tuple[int, ...]]]:
        smallest: list[tuple[int, ...]] = [()] * self._f.n
        largest = smallest.copy()
        for x, context in self._on_top.items():
            smallest[x] = context
        for x, search in enumerate(self._searches):
            self._record(x)
            if x not in self._on_top:
                smallest[x] = search.attained.context
        for x, attained in self._largest.items():
            largest[x] = attained.context
        return smallest, largest


def _inverses(information: FloatArray) -> tuple[BoolArray, FloatArray]:
    """Find the regular matrices (..., d, d) and their inverses; the others get zero.

    Those of a condition beyond 1e6 count as singular: their inverse is not trusted to the nine digits of ``MARGIN``.
    """
    worst = 1e6
    inverse = np.zeros_like(information)
    if information.shape[-1] == 2:
        a, b, c = information[..., 0, 0], information[..., 0, 1], information[..., 1, 1]
        low, high = eigenvalues(a, b, c)
        regular = low * worst > high
        scale = np.divide(1.0, determinant(a, b, c), out=np.zeros_like(a), where=regular)
        inverse[..., 0, 0], inverse[..., 1, 1] = c * scale, a * scale
        inverse[..., 0, 1] = inverse[..., 1, 0] = -b * scale
        return regular, inverse
    values = np.linalg.eigvalsh(information)
    regular = values[..., 0] * worst > values[..., -1]
    inverse[regular] = np.linalg.inv(information[regular])
    return regular, inverse


def other_elements(f: InformationObjective, owners: IntArray, owner: int) -> OtherElements:
    """The elements of the other owners, owner by owner."""
    groups = [np.flatnonzero(owners == i) for i in np.unique(owners) if i != owner]
    elements = np.concatenate([*groups, np.array([], dtype=np.int64)])
    sizes = np.array([len(own) for own in groups], dtype=np.int64)
    information = f.information[elements]
    regular, inverse = _inverses(information)
    return OtherElements(
        elements=elements,
        owners=np.repeat(np.arange(len(sizes)), sizes),
        first=np.cumsum(sizes) - sizes,
        information=information,
        inverse=inverse,
        regular=regular,
    )
