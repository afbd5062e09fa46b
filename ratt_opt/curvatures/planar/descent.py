"""Contexts with a small, or a large, marginal of the max-eigenvalue criterion: descent over one and two owners."""

from __future__ import annotations

from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.curvatures.planar.options import marginals

if TYPE_CHECKING:
    from collections.abc import Callable

    from ratt_opt._validation import BoolArray, FloatArray, IntArray
    from ratt_opt.budget import Budget
    from ratt_opt.curvatures.planar.options import Options

__all__ = ["PlanarDescent"]


class PlanarDescent:
    """``value`` is the marginal of an element in the context ``picks`` (R,), the best of those seen.

    The best is the smallest, or the largest where ``sign`` is -1. ``base`` and ``added`` : (3, M).
    """

    def __init__(self, options: Options, base: FloatArray, added: FloatArray, *, sign: float) -> None:
        self._options, self._base, self._added, self._sign = options, base, added, sign
        self._ends = np.append(options.first, len(options.owners))
        self._starts: set[tuple[int, ...]] = set()
        self._paired: tuple[int, ...] | None = None
        self.picks = options.first.copy()
        self.value = self._best(self._total(self.picks)[None])[1]

    def offer(self, picks: IntArray) -> None:
        """Descend from a context, one owner at a time, if it is new."""
        key = tuple(picks.tolist())
        if key in self._starts:
            return
        self._starts.add(key)
        self._descend(picks)

    def enumerate(self, allowed: BoolArray) -> None:
        """Try every context of the allowed options."""
        own = [start + np.flatnonzero(allowed[start:end]) for start, end in pairwise(self._ends.tolist())]
        totals = self._base
        for part in own:
            totals = totals[..., None, :, :] + self._parts(part)
        where, value = self._best(totals)
        if self._better(value, self.value):
            position = np.unravel_index(where, totals.shape[:-2])
            self._keep(np.array([part[k] for part, k in zip(own, position, strict=True)], dtype=np.int64), value)

    def pairs(self, budget: Budget) -> None:
        """Descend from the best context over two owners at a time, until it is the best of its neighbours."""
        from ratt_opt.curvatures.planar.compiled import descend_pairs

        while self._paired != tuple(self.picks.tolist()) and not budget.is_over:
            self._paired = tuple(self.picks.tolist())
            self._run(descend_pairs, self.picks)
            self._descend(self.picks)

    def _descend(self, picks: IntArray) -> None:
        from ratt_opt.curvatures.planar.compiled import descend

        self._run(descend, picks)

    def _run(self, compiled: Callable[..., None], picks: IntArray) -> None:
        picks = picks.copy()
        compiled(self._options.parts, self._ends, self._total(picks), self._added, self._sign, picks)
        self._keep(picks, self._best(self._total(picks)[None])[1])

    def _keep(self, picks: IntArray, value: float) -> None:
        if self._better(value, self.value):
            self.picks, self.value = picks.copy(), value

    def _better(self, value: float, than: float) -> bool:
        # A relative improvement: rounding must not make two contexts take turns.
        return self._sign * value < self._sign * than - 1e-12 * abs(than)

    def _parts(self, picks: IntArray | np.int64) -> FloatArray:
        return self._options.parts[picks]

    def _total(self, picks: IntArray) -> FloatArray:
        return np.asarray(self._base + self._parts(picks).sum(axis=0))

    def _best(self, totals: FloatArray) -> tuple[int, float]:
        """Flat position and value of the best of some contexts (..., 3, M)."""
        found = marginals(totals, self._added).ravel()
        where = int((self._sign * found).argmin())
        return where, float(found[where])
