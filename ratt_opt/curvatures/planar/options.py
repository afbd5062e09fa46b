"""What the contexts of one element consist of, and the levels and marginals they lead to.

Targets are mean, even and odd parts, see :class:`~ratt_opt.setfunctions.criteria.planar_levels.PlanarLevels`.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from ratt_opt._validation import FloatArray, IntArray
    from ratt_opt.setfunctions.criteria.planar_levels import PlanarLevels

__all__ = ["Options", "along", "levels", "marginals"]


@dataclass(frozen=True, slots=True, eq=False)
class Options:
    """What the owners other than one element's may add: K options of R owners, "none" being each one's first.

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
    """As ``levels(total).min(axis=-1)``; several times as fast without ``hypot``."""
    even, odd = total[..., 1, :], total[..., 2, :]
    return np.asarray((total[..., 0, :] - np.sqrt(even * even + odd * odd)).min(axis=-1))
