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
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.native.library import address, checked
from ratt_opt.native.loops import GreedyRecord, loops
from ratt_opt.setfunctions.criteria.two_by_two import triples

if TYPE_CHECKING:
    from ratt_opt._validation import BoolArray, FloatArray, IntArray
    from ratt_opt.budget import Budget
    from ratt_opt.setfunctions.information import InformationObjective

__all__ = ["LazyGreedy", "LazyGreedyParams"]


@dataclass(frozen=True, slots=True, kw_only=True)
class LazyGreedyParams:
    """Numbers of lazy evaluation: when it begins, and how many candidates are looked at in one go.

    ``plain`` : criteria of single targets up to which the plain loop runs; it takes some milliseconds for as many
    ``first`` : candidates of the largest bounds that are evaluated first: a large marginal spares the others
    ``at_once`` : targets times candidates between two looks at the clock: some milliseconds
    """

    plain: int = 200_000
    first: int = 8
    at_once: int = 1_000_000


class LazyGreedy:
    """Greedy choice among the elements of some robots, with the plain algorithm's answers.

    Parameters
    ----------
    objective : with compiled loops, planar targets
    is_open : (E,) candidates; the caller closes those that are none any more
    """

    def __init__(self, objective: InformationObjective, is_open: BoolArray, params: LazyGreedyParams) -> None:
        assert objective.compiled_code is not None
        self._objective, self._criterion, self.is_open = objective, objective.compiled_code, is_open
        checked("is_open", is_open, np.bool_, (objective.n,))
        self._information = _by_rows(objective.information, 0.0)
        self._sums = _by_rows(objective.prior_information, 1.0)
        weights, width = objective.weights, self._sums.shape[-1]
        self._weights = np.append(weights, np.full(width - len(weights), weights[-1:].max(initial=0.0)))
        self._bounds = np.full(len(is_open), np.inf)
        self._gains = np.full(len(is_open), -np.inf)
        self._chosen: list[int] = []
        # Closer marginals are compared as the plain loop does: its values, rounded its way. A thousand times what
        # either rounds off.
        self._close, self._params = 1e-11 * objective.prior_magnitude, params

    def choose(self, budget: Budget) -> int | None:
        """The candidate of largest value beside those chosen, the lowest among equals; it is chosen.

        ``None`` if the budget is over before.
        """
        if not self._evaluate(budget):
            return None
        close = np.flatnonzero(self._gains >= self._gains.max() - self._close)
        pick = int(close[0]) if self._are_equal(close) else self._plainly(close)
        self._chosen.append(pick)
        self._sums = self._sums + self._information[pick]
        return pick

    def _evaluate(self, budget: Budget) -> bool:
        """Fill in the gains of all candidates that come within ``close`` of the largest; -inf for the others."""
        targets, width, covariances = self._objective.n_targets, len(self._weights), _inverse(self._sums)
        order = np.argsort(-(self._weights * covariances[3])[:targets])
        record = GreedyRecord(
            criterion=self._criterion,
            targets=targets,
            width=width,
            weights=address(self._weights),
            information=address(self._information),
            sums=address(self._sums),
            covariances=address(covariances),
            order=address(order),
            bounds=address(self._bounds),
            gains=address(self._gains),
        )
        self._gains[:] = -np.inf
        bounds = np.where(self.is_open, self._bounds, -np.inf)
        first = np.argpartition(-bounds, min(self._params.first, len(bounds)) - 1)[: self._params.first]
        first = first[np.argsort(-bounds[first], kind="stable")]
        first = first[self.is_open[first]]
        best = loops.evaluate_gains(record, address(first), len(first), self._close, -np.inf)
        bounds[first] = -np.inf
        left, size = np.flatnonzero(bounds >= best - self._close), max(self._params.at_once // width, 1)
        for start in range(0, len(left), size):
            if budget.is_over:
                return False
            some = left[start : start + size]
            best = loops.evaluate_gains(record, address(some), len(some), self._close, best)
        return True

    def _are_equal(self, elements: IntArray) -> bool:
        return len(elements) == 1 or bool((self._information[elements] == self._information[elements[0]]).all())

    def _plainly(self, elements: IntArray) -> int:
        """Choose among tied elements as the plain loop would."""
        values = self._objective.extensions(np.array(self._chosen, dtype=np.int64), elements)
        return int(elements[np.argmax(values)])


def _inverse(sums: FloatArray) -> FloatArray:
    """(4, W) inverses of (3, W) matrices, and their largest eigenvalues."""
    a, b, c = sums
    determinant, half = a * c - b * b, (a - c) / 2
    largest = ((a + c) / 2 + np.sqrt(half * half + b * b)) / determinant
    return np.stack([c / determinant, -b / determinant, a / determinant, largest])


def _by_rows(matrices: FloatArray, diagonal: float) -> FloatArray:
    """(..., M, 2, 2) as (..., 3, W): multiples of the unit matrix fill up the last of C's 8 lanes."""
    count = matrices.shape[-3]
    rows = np.zeros((*matrices.shape[:-3], 3, -(-count // 8) * 8))
    rows[..., :count] = np.swapaxes(triples(matrices), -1, -2)
    rows[..., ::2, count:] = diagonal
    return rows
