"""The smallest, or the largest, marginal of one element that was seen, and the context it was seen in."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from ratt_opt._validation import IntArray
    from ratt_opt.budget import Budget
    from ratt_opt.setfunctions.information import InformationObjective
    from ratt_opt.setfunctions.minorants import Choices

__all__ = ["BestContext"]

SWEEPS = 3
"""MEASURED"""


class BestContext:
    """``value`` is the marginal of ``x`` in ``context``, the smallest (or ``largest``) of those offered."""

    def __init__(self, f: InformationObjective, x: int, others: Choices, *, largest: bool = False) -> None:
        self._f, self._x, self._others = f, x, others
        self._sign = -1.0 if largest else 1.0
        self.value = self._sign * np.inf
        self.context: tuple[int, ...] = ()
        self._tried: set[tuple[int, ...]] = set()
        self.offer(np.empty(0, dtype=np.int64))

    def descend(self, budget: Budget) -> None:
        """Change one owner's choice at a time, from the best context so far."""
        others = self._others
        groups = [others.elements[others.owners == i] for i in range(len(others.first))]
        for _ in range(SWEEPS):
            before = self.value
            for own in groups:
                if budget.is_over:
                    return
                rest = np.array([e for e in self.context if e not in own], dtype=np.int64)
                self._keep(np.concatenate([np.tile(rest, (len(own), 1)), own[:, None]], axis=1))
                self._keep(rest[None])
            if self.value == before:
                return

    def offer(self, context: IntArray) -> None:
        """Evaluate a context, if it is new."""
        key = tuple(context.tolist())
        if key not in self._tried:
            self._tried.add(key)
            self._keep(context[None])

    def _keep(self, contexts: IntArray) -> None:
        """Evaluate contexts (K, size) and keep the best."""
        f = self._f
        posterior = f.prior_information + f.information[contexts].sum(axis=1)
        marginals = f.value(posterior + f.information[self._x]) - f.value(posterior)
        k = int((self._sign * marginals).argmin())
        if self._sign * marginals[k] < self._sign * self.value:
            self.value, self.context = float(marginals[k]), tuple(contexts[k].tolist())
