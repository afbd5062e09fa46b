"""Contexts of one element: their options, levels and marginals, and descent to an extreme one.

Targets are mean, even and odd parts, see :class:`~ratt_opt.setfunctions.planar_levels.PlanarLevels`.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.native.library import address, checked
from ratt_opt.native.loops import DescentRecord, loops
from ratt_opt.setfunctions.base import IMPROVEMENT

if TYPE_CHECKING:
    from ratt_opt._validation import BoolArray, FloatArray, IntArray
    from ratt_opt.budget import Budget
    from ratt_opt.setfunctions.planar_levels import PlanarLevels

__all__ = ["Options", "PlanarDescent", "along", "levels", "marginals"]


@dataclass(frozen=True, slots=True, eq=False)
class Options:
    """Options of the owners other than one element's: K options of R owners, "none" being each one's first.

    ``elements`` : (K,), -1 for none; ``owners`` : (K,) 0..R-1; ``first`` : (R,) their "none"; ``parts`` : (K, 3, M).
    """

    elements: IntArray
    owners: IntArray
    first: IntArray
    parts: FloatArray

    @classmethod
    def beside(cls, data: PlanarLevels, owners: IntArray, owner: int) -> Options:
        """Options of all owners but one."""
        groups = [np.flatnonzero(owners == i) for i in np.unique(owners) if i != owner]
        own = [np.concatenate([[-1], elements]) for elements in groups]
        elements = np.concatenate([*own, np.array([], dtype=np.int64)]).astype(np.int64)
        sizes = np.array([len(part) for part in own], dtype=np.int64)
        first = (np.cumsum(sizes) - sizes).astype(np.int64)
        parts = np.where((elements >= 0)[:, None, None], data.parts[elements], 0.0)
        return cls(elements, np.repeat(np.arange(len(own)), sizes), first, parts)

    def context(self, picks: IntArray) -> tuple[int, ...]:
        """The elements of one option (position) an owner."""
        return tuple(sorted(int(e) for e in self.elements[picks] if e >= 0))


def levels(total: FloatArray) -> FloatArray:
    """Smallest eigenvalues: (..., 3, M) -> (..., M)."""
    return np.asarray(total[..., 0, :] - np.hypot(total[..., 1, :], total[..., 2, :]))


def along(angle: FloatArray | float) -> FloatArray:
    """Coefficients of the three parts in the quadratic form at an angle: (...) -> (..., 3)."""
    angle = np.asarray(angle)
    return np.stack([np.ones_like(angle), np.cos(angle), np.sin(angle)], axis=-1)


def marginals(total: FloatArray, added: FloatArray) -> FloatArray:
    """Marginal of an element with parts ``added`` (3, M) on top of ``total`` (..., 3, M): 1/P - 1/Q >= 0."""
    before, after = _smallest(total), _smallest(total + added)
    return np.asarray((after - before) / (before * after))


def _smallest(total: FloatArray) -> FloatArray:
    """Compute ``levels(total).min(axis=-1)``, several times as fast without ``hypot``."""
    even, odd = total[..., 1, :], total[..., 2, :]
    return np.asarray((total[..., 0, :] - np.sqrt(even * even + odd * odd)).min(axis=-1))


class PlanarDescent:
    """``value`` is the marginal of an element in the context ``picks`` (R,), the smallest of those seen.

    Or the largest if ``sign`` is -1. Descent is over one and two owners at a time. ``base``, ``added`` : (3, M).
    ``rounding`` : of a marginal, in its own unit; less is no improvement
    """

    def __init__(
        self, options: Options, base: FloatArray, added: FloatArray, *, sign: float, rounding: float = 0.0
    ) -> None:
        self._options, self._base, self._added, self._sign = options, base, added, sign
        self._rounding = rounding
        self._ends = np.append(options.first, len(options.owners))
        self._total, self._picks = np.empty(base.shape), options.first.copy()
        self._record = self._for_c()
        self._starts: set[tuple[int, ...]] = set()
        self._paired: tuple[int, ...] | None = None
        self.picks = options.first.copy()
        self.value = self._best(self._sum(self.picks)[None])[1]

    def offer(self, picks: IntArray) -> None:
        """Descend from a context, one owner at a time, if it is new."""
        key = tuple(picks.tolist())
        if key not in self._starts:
            self._starts.add(key)
            self._run(picks)

    def enumerate(self, allowed: BoolArray) -> None:
        """Try every context of the allowed options."""
        own = [start + np.flatnonzero(allowed[start:end]) for start, end in pairwise(self._ends.tolist())]
        totals = self._base
        for part in own:
            totals = totals[..., None, :, :] + self._options.parts[part]
        where, value = self._best(totals)
        position = np.unravel_index(where, totals.shape[:-2])
        self._keep(np.array([part[k] for part, k in zip(own, position, strict=True)], dtype=np.int64), value)

    def pairs(self, budget: Budget) -> None:
        """Descend from the best context over two owners at a time, until it is the best of its neighbours."""
        while self._paired != tuple(self.picks.tolist()) and not budget.is_over:
            start = tuple(self.picks.tolist())
            self._run(self.picks, budget)
            self._run(self.picks)
            if not budget.is_over:
                self._paired = start

    def _run(self, picks: IntArray, budget: Budget | None = None) -> None:
        """Descend over one owner at a time, or, with a budget, over each pair of owners once as far as that lasts."""
        self._picks[:], self._total[:] = picks, self._sum(picks)
        self._record.value = self._sign * self._best(self._total[None])[1]
        if budget is None:
            while loops.descend(self._record):
                pass
        else:
            for i in range(len(picks)):
                if budget.is_over:
                    break
                loops.descend_pairs(self._record, i)
        self._keep(self._picks, self._best(self._sum(self._picks)[None])[1])

    def _for_c(self) -> DescentRecord:
        """Return the record of the descent, which has the addresses of its arrays only."""
        count, targets, owners = len(self._options.owners), self._base.shape[-1], len(self._picks)
        self._spare = np.empty((2, 3, targets))
        return DescentRecord(
            owners=owners,
            targets=targets,
            sign=self._sign,
            value=0.0,
            relative=IMPROVEMENT.relative,
            rounding=self._rounding,
            parts=address(checked("parts", self._options.parts, np.float64, (count, 3, targets))),
            ends=address(checked("first", self._ends, np.int64, (owners + 1,))),
            added=address(checked("added", self._added, np.float64, (3, targets))),
            total=address(checked("base", self._total, np.float64, (3, targets))),
            picks=address(checked("first", self._picks, np.int64, (owners,))),
            rest=address(self._spare[0]),
            one=address(self._spare[1]),
        )

    def _keep(self, picks: IntArray, value: float) -> None:
        least = max(IMPROVEMENT.relative * abs(self.value), self._rounding)  # or two contexts would take turns
        if self._sign * value < self._sign * self.value - least:
            self.picks, self.value = picks.copy(), value

    def _sum(self, picks: IntArray) -> FloatArray:
        return np.asarray(self._base + self._options.parts[picks].sum(axis=0))

    def _best(self, totals: FloatArray) -> tuple[int, float]:
        """Flat position and value of the best of some contexts (..., 3, M)."""
        found = marginals(totals, self._added).ravel()
        where = int((self._sign * found).argmin())
        return where, float(found[where])
