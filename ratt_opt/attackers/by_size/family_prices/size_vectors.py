"""All vectors of sizes that the groups of an attack may have, as arrays."""

from __future__ import annotations

from collections import Counter
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
        self._n_robots, self._vectors = n_robots, vectors
        self._first: IntArray = np.array([sizes[0] for sizes in vectors], dtype=np.int64)
        # A group of nobody, of which there is none, so that no vector is without other groups.
        others = [{0: 0, **Counter(sizes[1:])} for sizes in vectors]
        self._starts: IntArray = np.cumsum([0, *map(len, others)])
        self._sizes: IntArray = np.array([size for counts in others for size in counts], dtype=np.int64)
        self._counts: FloatArray = np.array([k for counts in others for k in counts.values()], dtype=np.float64)
        everyone = np.arange(n_robots + 1)
        self.is_largest: BoolArray = np.isin(everyone, self._first)
        self.is_other: BoolArray = np.isin(everyone, self._sizes[self._counts > 0])

    def vector(self, which: int) -> tuple[int, FloatArray]:
        """The largest size of a vector, and how many (N + 1,) other groups of each size it has."""
        own, others = slice(*self._starts[which : which + 2]), np.zeros(self._n_robots + 1)
        others[self._sizes[own]] = self._counts[own]
        return int(self._first[which]), others

    def divided(self, first: int) -> tuple[SizeVectors, SizeVectors]:
        """The ``first`` vectors, and the others: at least one each."""
        return SizeVectors(self._n_robots, self._vectors[:first]), SizeVectors(self._n_robots, self._vectors[first:])

    def roles(self, size: int) -> tuple[bool, ...]:
        """Whether a group of that size may be the largest (true), and another one (false)."""
        possible = (False, bool(self.is_other[size])), (True, bool(self.is_largest[size]))
        return tuple(role for role, may_have in possible if may_have)

    def costs(self, largest: FloatArray, other: FloatArray) -> FloatArray:
        """(V,) what each costs by prices of sizes (N + 1,)."""
        return np.asarray(largest[self._first] + np.add.reduceat(self._counts * other[self._sizes], self._starts[:-1]))

    def some(self) -> IntArray:
        """A few that are far apart."""
        return np.arange(0, len(self._first), max(len(self._first) // FIRST, 1))
