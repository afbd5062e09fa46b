"""Sizes of the groups of unblinded robots that an attack can leave on a graph whose groups' scores are bounded.

The bounds (``link_scores.py``) depend on sizes alone, so a vector of sizes is possible or not; every attack's is. The
blinded robots stand in any groups, which need no unblinded robot.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Iterator

    from ratt_opt._validation import FloatArray
    from ratt_opt.budget import Budget
    from ratt_opt.graph.link_scores import LinkScores
    from ratt_opt.graph.survivor_sizes import Sizes

__all__ = ["PossibleSizes"]


class PossibleSizes:
    """Vectors of sizes of ``n_seeing`` unblinded robots in groups with ``n_blinded`` blinded ones.

    ``least`` : unblinded robots that are known to be left in some group

    A table of best scores has, for each bound and each number of blinded robots used, (K, n_blinded + 1).
    """

    def __init__(self, scores: LinkScores, n_blinded: int, least: int = 0) -> None:
        self._scores, self._most, self._need = scores, scores.most, scores.need
        self._n_blinded, self.n_seeing = n_blinded, scores.most.shape[1] - 1 - n_blinded
        self._least = least
        self._apart = self._add(self._nobody(), 0)
        for _ in range(n_blinded):
            self._apart = np.maximum(self._apart, self._add(self._apart, 0))
        self._best: list[dict[int, FloatArray]] = [{0: self._apart}]
        for largest in range(1, self.n_seeing + 1):
            self._best.append(self._smaller_than(largest, self._best[-1]))

    def _nobody(self) -> FloatArray:
        table = np.full((len(self._most), self._n_blinded + 1), -np.inf)
        table[:, 0] = 0.0
        return table

    def _add(self, table: FloatArray, size: int) -> FloatArray:
        """Best scores with one more group of ``size`` unblinded robots and any number of blinded ones."""
        added = np.full_like(table, -np.inf)
        for inside in range(self._n_blinded + 1):
            score = self._most[:, size + inside, None]
            added[:, inside:] = np.maximum(added[:, inside:], table[:, : table.shape[1] - inside] + score)
        return added

    def _smaller_than(self, largest: int, smaller: dict[int, FloatArray]) -> dict[int, FloatArray]:
        """Best scores of each number of unblinded robots in groups of at most ``largest``."""
        tables = {0: self._apart}
        for count in range(1, self.n_seeing + 1):
            options = [self._add(tables[count - largest], largest)] if count >= largest else []
            if count in smaller:
                options.append(smaller[count])
            if options:
                tables[count] = np.max(options, axis=0)
        return tables

    def _is_possible(self, table: FloatArray, rest: FloatArray) -> bool:
        """Test whether groups of this table and groups of the other one can score enough together."""
        return bool(((table + rest[:, ::-1]).max(axis=1) >= self._need).all())

    @property
    def forced(self) -> int:
        """Unblinded robots that some group keeps under every attack."""
        nobody = self._nobody()
        sizes = range(self._least, self.n_seeing + 1)
        return next(k for k in sizes if self._is_possible(nobody, self._best[k].get(self.n_seeing, nobody - np.inf)))

    def largest(self, size: int) -> list[tuple[int, FloatArray]]:
        """Scores (K,) required of a largest group of ``size`` unblinded robots, by the number of blinded ones inside.

        Only for those numbers of blinded robots with which groups of that many robots may score it.
        """
        rest = self._best[size].get(self.n_seeing - size)
        if rest is None:
            return []
        needs = [
            (inside, np.maximum(self._need - rest[:, self._n_blinded - inside], self._scores.least))
            for inside in range(self._n_blinded + 1)
        ]
        return [(inside, need) for inside, need in needs if (self._most[:, size + inside] >= need).all()]

    def vectors(self, budget: Budget, at_most: int) -> list[Sizes] | None:
        """Possible vectors of which every other possible one is a merger; ``None`` if they are too many.

        Non-increasing sizes, the smallest largest group first.
        """
        found: list[Sizes] = []
        for sizes in self._below((), self._nobody(), self.n_seeing, self.n_seeing):
            found.append(sizes)
            if len(found) > at_most or budget.is_over:
                return None
        known: dict[Sizes, bool] = {}
        kept = []
        for sizes in found:
            if budget.is_over:
                return None
            if not any(self._is_vector(finer, known) for finer in _splits(sizes)):
                kept.append(sizes)
        return sorted(kept)

    def _below(self, sizes: Sizes, table: FloatArray, left: int, largest: int) -> Iterator[Sizes]:
        """Possible vectors that begin with ``sizes``; if the others may all be alone, only that one."""
        if not self._is_possible(table, self._best[min(largest, left)][left]):
            return
        first = sizes[0] if sizes else min(left, 1)
        if first >= self._least and (left == 0 or self._is_possible(table, self._best[1][left])):
            yield (*sizes, *(1,) * left)
            return
        for size in range(min(largest, left), 1 if sizes else max(self._least - 1, 1), -1):
            yield from self._below((*sizes, size), self._add(table, size), left - size, size)

    def _is_vector(self, sizes: Sizes, known: dict[Sizes, bool]) -> bool:
        if sizes not in known:
            table = self._nobody()
            for size in sizes:
                table = self._add(table, size)
            known[sizes] = sizes[0] >= self._least and self._is_possible(table, self._apart)
        return known[sizes]


def _splits(sizes: Sizes) -> Iterator[Sizes]:
    """Vectors with one group split in two; one robot off a small group first, which is possible most often."""
    for part in sorted({size for size in sizes if size > 1}):
        k = sizes.index(part)
        rest = (*sizes[:k], *sizes[k + 1 :])
        for off in range(1, part // 2 + 1):
            yield tuple(sorted((*rest, part - off, off), reverse=True))
