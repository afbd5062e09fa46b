"""Contexts with a small, or a large, marginal of the max-eigenvalue criterion: descent over one and two robots."""

from __future__ import annotations

from itertools import combinations
from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.setfunctions.planar import marginals

if TYPE_CHECKING:
    from ratt_opt._validation import BoolArray, FloatArray, IntArray
    from ratt_opt.setfunctions.planar import Options

__all__ = ["PlanarDescent"]


class PlanarDescent:
    """``value`` is the marginal of an element in the context ``picks`` (R,), the best of those seen.

    The best is the smallest, or the largest where ``sign`` is -1. ``base`` and ``added`` : (3, M).
    """

    def __init__(self, options: Options, base: FloatArray, added: FloatArray, *, sign: float) -> None:
        self._options, self._base, self._added, self._sign = options, base, added, sign
        sizes = np.diff(np.append(options.first, len(options.robot)))
        self._own = [np.arange(start, start + size) for start, size in zip(options.first, sizes, strict=True)]
        self._starts: set[tuple[int, ...]] = set()
        self._paired: tuple[int, ...] | None = None
        self.picks = options.first.copy()
        self.value = self._best(self._total(self.picks)[None])[1]

    def offer(self, picks: IntArray) -> None:
        """Descend from a context, one robot at a time, if it is new."""
        key = tuple(picks.tolist())
        if key in self._starts:
            return
        self._starts.add(key)
        value = self._best(self._total(picks)[None])[1]
        self._keep(picks, value)
        self._descend(picks.copy(), value)

    def enumerate(self, allowed: BoolArray) -> None:
        """Try every context of the allowed options."""
        own = [part[allowed[part]] for part in self._own]
        totals = self._base
        for part in own:
            totals = totals[..., None, :, :] + self._parts(part)
        where, value = self._best(totals)
        if self._better(value, self.value):
            position = np.unravel_index(where, totals.shape[:-2])
            self._keep(np.array([part[k] for part, k in zip(own, position, strict=True)], dtype=np.int64), value)

    def pairs(self) -> None:
        """Descend from the best context over two robots at a time, until it is the best of its neighbours."""
        while self._paired != tuple(self.picks.tolist()):
            self._paired = tuple(self.picks.tolist())
            for i, j in combinations(range(len(self._own)), 2):
                rest = self._total(self.picks) - self._parts(self.picks[i]) - self._parts(self.picks[j])
                both = self._parts(self._own[i])[:, None] + self._parts(self._own[j])[None]
                where, value = self._best(rest + both)
                if self._better(value, self.value):
                    a, b = np.unravel_index(where, both.shape[:2])
                    moved = self.picks.copy()
                    moved[[i, j]] = self._own[i][a], self._own[j][b]
                    self._keep(moved, value)
            self._descend(self.picks.copy(), self.value)

    def _descend(self, picks: IntArray, value: float) -> None:
        total = self._total(picks)
        improved = True
        while improved:
            improved = False
            for i, own in enumerate(self._own):
                rest = total - self._parts(picks[i])
                where, found = self._best(rest + self._parts(own))
                if self._better(found, value):
                    picks[i], value, improved = own[where], found, True
                    total = rest + self._parts(picks[i])
        self._keep(picks, value)

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
