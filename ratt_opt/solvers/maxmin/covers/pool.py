"""Covers found so far, in arrays that grow: compiled loops read them and add to them."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

if TYPE_CHECKING:
    from ratt_opt._validation import BoolArray, FloatArray
    from ratt_opt.problem import Problem

__all__ = ["MOST_CHOICES", "CoverPool", "Covers", "Places"]

FIRST_ROOM, GROWTH = 256, 2
MOST_VIOLATED = 8
NEGLIGIBLE = 1e-6
MOST_CHOICES = 64
"""Elements of one robot: those that are left out are a mask of this many bits."""


class Places(NamedTuple):
    """``bit`` (E,) : an element's place among its robot's; ``element`` (N, C) : the element at each, or -1."""

    owner: Any
    bit: Any
    element: Any


class Covers(NamedTuple):
    """Covers by number, the first ``size[0]`` of each array.

    ``left_out`` (K, N) : masks of elements; ``partition`` (K,); ``sums`` (K, S, M, T) : posterior information at which
    the tangents of the partition's groups touch; ``level`` (K,) : the least level that the cover is true for
    """

    left_out: Any
    partition: Any
    sums: Any
    level: Any
    size: Any


class CoverPool:
    """Covers over the elements of one problem."""

    def __init__(self, problem: Problem, packed_shape: tuple[int, ...]) -> None:
        self.places = _places(problem)
        self._shape = packed_shape
        self._known: dict[tuple[int, bytes], int] = {}
        self._counted = 0
        self._dense = np.zeros((0, problem.objective.n))
        self.covers = Covers(
            np.zeros((FIRST_ROOM, problem.n_robots), dtype=np.uint64),
            np.zeros(FIRST_ROOM, dtype=np.int64),
            np.zeros((FIRST_ROOM, 1, *packed_shape)),
            np.zeros(FIRST_ROOM),
            np.zeros(1, dtype=np.int64),
        )

    def __len__(self) -> int:
        return int(self.covers.size[0])

    def grow(self, groups: int = 0) -> None:
        """Make room for twice the covers, or for partitions into that many groups."""
        old = self.covers
        room = len(old.left_out) * (1 if groups > old.sums.shape[1] else GROWTH)
        wide = max(groups, old.sums.shape[1])
        grown = Covers(
            np.zeros((room, old.left_out.shape[1]), dtype=np.uint64),
            np.zeros(room, dtype=np.int64),
            np.zeros((room, wide, *self._shape)),
            np.zeros(room),
            old.size,
        )
        for new, was in zip(grown[:-1], old[:-1], strict=True):
            new[tuple(map(slice, was.shape))] = was
        self.covers = grown

    def add(self, partition: int, left_out: BoolArray, sums: list[FloatArray], level: float) -> int:
        """Add a cover unless it is known; its number. ``left_out`` : (E,)"""
        masks = self._masks(left_out)
        self._count()
        key = partition, masks.tobytes()
        if (known := self._known.get(key)) is not None:
            if level < self.covers.level[known]:
                self.covers.level[known], self.covers.sums[known, : len(sums)] = level, sums
            return known
        if len(self) == len(self.covers.left_out) or len(sums) > self.covers.sums.shape[1]:
            self.grow(len(sums))
        k = len(self)
        self.covers.left_out[k], self.covers.partition[k], self.covers.level[k] = masks, partition, level
        self.covers.sums[k, : len(sums)] = sums
        self.covers.size[0] = k + 1
        self._count()
        return k

    def left_out(self, cover: int) -> BoolArray:
        """(E,) which elements a cover leaves out."""
        masks = self.covers.left_out[cover][self.places.owner]
        return np.asarray(masks >> self.places.bit.astype(np.uint64) & np.uint64(1), dtype=np.bool_)

    def violated(self, price: FloatArray, enough: float, level: float) -> list[int]:
        """Covers, true for a level, of which less than ``enough`` is paid, the worst first; ``price`` : (E,) paid."""
        self._count()
        counted = self._dense[: len(self)] @ price
        found = np.flatnonzero((counted < enough - NEGLIGIBLE) & (self.covers.level[: len(self)] <= level))
        return [int(k) for k in found[np.argsort(counted[found], kind="stable")][:MOST_VIOLATED]]

    def keep_latest(self, count: int) -> None:
        """Forget all but the covers that were found last; they are numbered anew."""
        first = max(len(self) - count, 0)
        for array in self.covers[:-1]:
            array[: len(self) - first] = array[first : len(self)].copy()
        self.covers.size[0] = len(self) - first
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
        bits = np.uint64(1) << self.places.bit[chosen].astype(np.uint64)
        np.bitwise_or.at(out, self.places.owner[chosen], bits)
        return out


def _places(problem: Problem) -> Places:
    widest = max(map(len, problem.choices))
    bit = np.zeros(problem.objective.n, dtype=np.int64)
    element = np.full((problem.n_robots, widest), -1, dtype=np.int64)
    for i, choice in enumerate(problem.choices):
        bit[choice] = np.arange(len(choice))
        element[i, : len(choice)] = choice
    return Places(np.array(problem.robot), bit, element)
