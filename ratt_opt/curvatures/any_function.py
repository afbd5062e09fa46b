"""Bounds on the marginals of any set function, however large its domain and slow its values.

Ends that hold: what theory says of the function (submodular, or a bound on its total curvature), monotonicity
otherwise. Ends that are attained: the empty context, then contexts drawn at random.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.budget import OutOfBudget
from ratt_opt.curvatures.marginals import Marginals, MeasuredMarginals, check_monotone
from ratt_opt.setfunctions.metered import Metered

if TYPE_CHECKING:
    from ratt_opt._validation import FloatArray, IntArray
    from ratt_opt.budget import Budget, Stop
    from ratt_opt.curvatures.domains import Domain

__all__ = ["any_marginals"]


def any_marginals(domain: Domain, budget: Budget, stop: Stop, contexts: int) -> MeasuredMarginals:
    """Brackets of the marginals; relies on a non-decreasing function. ``stop`` : if the budget ends nothing.

    ``contexts`` : random sets of the domain from which every element's context is taken, if time allows

    InputError : a context shows that the function falls.
    """
    known = _Seen(domain, budget)
    try:
        known.bound()
        known.draw(contexts)
    except OutOfBudget as out:
        stop = out.stop
    except KeyboardInterrupt:
        stop = budget.interrupt()
    marginals = known.marginals()
    check_monotone(domain, marginals)
    return MeasuredMarginals(marginals=marginals, how=f"{known.rests_on} and drawn contexts", stop=stop, nodes=0)


class _Seen:
    """Ends so far of every element; raises ``OutOfBudget`` if the budget forbids a value that is needed."""

    def __init__(self, domain: Domain, budget: Budget) -> None:
        self.domain, self.f, n = domain, Metered(domain.restricted, budget), domain.restricted.n
        self.rests_on = "monotonicity (relied on)"
        self.least, self.most = np.zeros(n), np.full(n, np.inf)
        self.seen_least, self.seen_most = np.full(n, np.inf), np.zeros(n)
        self.contexts: tuple[list[tuple[int, ...]], list[tuple[int, ...]]] = ([()] * n, [()] * n)

    def bound(self) -> None:
        """Ends that hold in every context."""
        f, n = self.f, self.f.n
        nothing, whole = f([]), f(range(n))
        self.most = np.full(n, whole - nothing)  # no marginal exceeds the rise from nothing to everything
        single = f.singletons() - nothing
        self._note(np.arange(n), single, np.array([], dtype=np.int64))
        kept = 1.0 - f.most_total_curvature
        if self.domain.is_submodular:
            self.rests_on = "submodular by theory: values alone, marginals on top of all elements"
            self.most = single
            top = whole - f.evaluate(~np.eye(n, dtype=np.bool_))
            self.least = np.clip(top, 0.0, single)
        elif kept > 0:
            self.rests_on = "the function's own word on its total curvature"
            self.least, self.most = kept * single, np.minimum(self.most, single / kept)

    def draw(self, contexts: int) -> None:
        """Marginals beside random sets of the domain, the first as large as it allows."""
        rng, groups = np.random.default_rng(0), self.domain.groups
        for k in range(contexts):
            density = 1.0 if k == 0 else rng.random()
            chosen = {i: int(rng.choice(own)) for i, own in enumerate(groups) if rng.random() <= density}
            for i, own in enumerate(groups):
                context = np.array(sorted(e for j, e in chosen.items() if j != i), dtype=np.int64)
                self._note(own, self.f.extensions(context, own) - self.f(context), context)

    def _note(self, elements: IntArray, marginals: FloatArray, context: IntArray) -> None:
        for x, marginal in zip(elements.tolist(), marginals.tolist(), strict=True):
            if marginal < self.seen_least[x]:
                self.seen_least[x], self.contexts[0][x] = marginal, tuple(context.tolist())
            if marginal > self.seen_most[x]:
                self.seen_most[x], self.contexts[1][x] = marginal, tuple(context.tolist())

    def marginals(self) -> Marginals:
        """The ends, those that hold never inside those that are attained."""
        least, most = np.minimum(self.least, self.seen_least), np.maximum(self.most, self.seen_most)
        return Marginals(least, self.seen_least, self.seen_most, most, *map(tuple, self.contexts))
