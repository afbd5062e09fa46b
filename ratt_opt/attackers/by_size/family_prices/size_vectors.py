"""All vectors of sizes that the groups of an attack may have, as arrays."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Sequence

    from ratt_opt._validation import BoolArray, FloatArray, IntArray
    from ratt_opt.graph.survivor_sizes import Sizes

__all__ = ["SizeVectors"]

FIRST = 30
"""Vectors that a program begins with, one out of so many."""


class SizeVectors:
    """``vectors`` : non-increasing sizes of groups among N robots, V >= 1 of them, none of them empty.

    ``is_largest``, ``is_other`` : (N + 1,) sizes that the largest group, and another one, may have
    """

    def __init__(self, n_robots: int, vectors: Sequence[Sizes]) -> None:
        self._first: IntArray = np.array([sizes[0] for sizes in vectors], dtype=np.int64)
        self._others = np.zeros((len(vectors), n_robots + 1))
        for row, sizes in zip(self._others, vectors, strict=True):
            np.add.at(row, np.array(sizes[1:], dtype=np.int64), 1.0)
        self.is_largest: BoolArray = np.isin(np.arange(n_robots + 1), self._first)
        self.is_other: BoolArray = np.asarray(self._others.any(axis=0))

    def vector(self, which: int) -> tuple[int, FloatArray]:
        """The largest size of a vector, and how many (N + 1,) other groups of each size it has."""
        return int(self._first[which]), self._others[which]

    def roles(self, size: int) -> tuple[bool, ...]:
        """Whether a group of that size may be the largest (true), and another one (false)."""
        possible = (False, bool(self.is_other[size])), (True, bool(self.is_largest[size]))
        return tuple(role for role, may_have in possible if may_have)

    def costs(self, largest: FloatArray, other: FloatArray) -> FloatArray:
        """(V,) what each costs by prices of sizes (N + 1,)."""
        return np.asarray(largest[self._first] + self._others @ other)

    def some(self) -> IntArray:
        """A few that are far apart."""
        return np.arange(0, len(self._first), max(len(self._first) // FIRST, 1))
