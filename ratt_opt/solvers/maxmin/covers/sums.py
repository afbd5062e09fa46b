"""Sums of covers that a linear program found, as rows that grow: conditions that forbid more than each cover does."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.solvers.maxmin.covers.tables import Sums
from ratt_opt.solvers.maxmin.proof import CoverLeaf

if TYPE_CHECKING:
    from ratt_opt._validation import FloatArray, IntArray

__all__ = ["CoverSums"]

FIRST_ROOM = 64
MOST_TRIED = 60
"""Sums that are looked at: those that were of most use lately."""
FADING = 0.9
"""How much of earlier use counts when the next one is found."""


class CoverSums:
    """Sums by number, with the leaf that each stands for."""

    def __init__(self, elements: int) -> None:
        self._elements, self._terms, self._used = elements, np.zeros((FIRST_ROOM, elements)), np.zeros(FIRST_ROOM)
        self.leaves: list[CoverLeaf] = []

    def add(self, covers: IntArray, weights: FloatArray, terms: FloatArray) -> None:
        """Add the covers' weighted sum; ``terms`` : (E,) what each element counts."""
        number = len(self.leaves)
        if number == len(self._used):
            self._terms = np.concatenate([self._terms, np.zeros_like(self._terms)])
            self._used = np.concatenate([self._used, np.zeros_like(self._used)])
        self._terms[number] = terms
        self._used *= FADING
        self._used[number] = self._used.max() + 1.0
        self.leaves.append(CoverLeaf(covers=tuple(covers.tolist()), weights=tuple(weights.tolist())))

    def rows(self) -> Sums:
        """As the loops of a dive read them."""
        tried = np.argsort(-self._used[: len(self.leaves)], kind="stable")[:MOST_TRIED]
        return Sums(self._elements, self._terms, tried.astype(np.int64), self._used)
