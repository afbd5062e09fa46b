"""Covers found so far, in arrays that grow: compiled loops read them and add to them."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from ratt_opt.solvers.maxmin.covers.tables import Covers

if TYPE_CHECKING:
    from ratt_opt._validation import BoolArray, FloatArray
    from ratt_opt.solvers.maxmin.covers.choices import Choices

__all__ = ["CoverPool"]

FIRST_ROOM, GROWTH = 256, 2
MOST_VIOLATED = 8
NEGLIGIBLE = 1e-6


class CoverPool:
    """Covers over the elements of one problem."""

    def __init__(self, choices: Choices) -> None:
        self._choices = choices
        self._known: dict[tuple[int, bytes], int] = {}
        self._counted = 0
        self._dense = np.zeros((0, choices.elements.count))
        self.covers = Covers(choices, FIRST_ROOM, 1)

    def __len__(self) -> int:
        return int(self.covers.record.size)

    def grow(self, groups: int = 0) -> None:
        """Make room for twice the covers, or for partitions into that many groups."""
        old = self.covers
        room = old.room * (1 if groups > old.groups else GROWTH)
        self.covers = Covers(self._choices, room, max(groups, old.groups))
        self.covers.record.size = old.record.size
        for new, was in zip(self.covers.arrays, old.arrays, strict=True):
            new[tuple(map(slice, was.shape))] = was

    def add(self, partition: int, left_out: BoolArray, sums: list[FloatArray], level: float) -> int:
        """Add a cover unless it is known; its number. ``left_out`` : (E,)"""
        masks = self._masks(left_out)
        self._count()
        key = partition, masks.tobytes()
        if (known := self._known.get(key)) is not None:
            if level < self.covers.level[known]:
                self.covers.level[known], self.covers.sums[known, : len(sums)] = level, sums
            return known
        if len(self) == self.covers.room or len(sums) > self.covers.groups:
            self.grow(len(sums))
        k = len(self)
        self.covers.left_out[k], self.covers.partition[k], self.covers.level[k] = masks, partition, level
        self.covers.sums[k, : len(sums)] = sums
        self.covers.record.size = k + 1
        self._count()
        return k

    def left_out(self, cover: int) -> BoolArray:
        """(E,) which elements a cover leaves out."""
        masks = self.covers.left_out[cover][self._choices.owner]
        return np.asarray(masks >> self._choices.bit.astype(np.uint64) & np.uint64(1), dtype=np.bool_)

    def violated(self, price: FloatArray, enough: float, level: float) -> list[int]:
        """Covers, true for a level, of which less than ``enough`` is paid, the worst first; ``price`` : (E,) paid."""
        self._count()
        counted = self._dense[: len(self)] @ price
        found = np.flatnonzero((counted < enough - NEGLIGIBLE) & (self.covers.level[: len(self)] <= level))
        return [int(k) for k in found[np.argsort(counted[found], kind="stable")][:MOST_VIOLATED]]

    def keep_latest(self, count: int) -> None:
        """Forget all but the covers that were found last; they are numbered anew."""
        first = max(len(self) - count, 0)
        for array in self.covers.arrays:
            array[: len(self) - first] = array[first : len(self)].copy()
        self.covers.record.size = len(self) - first
        self._known.clear()
        self._counted = 0
        self._count()

    def _count(self) -> None:
        """Number the covers that compiled loops added."""
        for k in range(self._counted, len(self)):
            key = int(self.covers.partition[k]), self.covers.left_out[k].tobytes()
            self._known.setdefault(key, k)
        if self._counted < len(self):
            fresh = np.array([self.left_out(k) for k in range(self._counted, len(self))], dtype=np.float64)
            self._dense = np.concatenate([self._dense[: self._counted], fresh])
        self._counted = len(self)

    def _masks(self, left_out: BoolArray) -> Any:
        out = np.zeros(self.covers.left_out.shape[1], dtype=np.uint64)
        chosen = np.flatnonzero(left_out)
        bits = np.uint64(1) << self._choices.bit[chosen].astype(np.uint64)
        np.bitwise_or.at(out, self._choices.owner[chosen], bits)
        return out
