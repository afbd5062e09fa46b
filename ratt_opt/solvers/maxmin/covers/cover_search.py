"""The search by covers at one level after the other.

Covers are true for all levels above the one that they were found for, and serve there, too.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.solvers.maxmin.covers.choices import MOST_CHOICES
from ratt_opt.solvers.maxmin.covers.cover import cover_bound
from ratt_opt.solvers.maxmin.covers.records import DiveProof
from ratt_opt.solvers.maxmin.covers.search import CoverLevelSearch
from ratt_opt.solvers.maxmin.covers.separation import Separation
from ratt_opt.solvers.maxmin.covers.tables import BY_COVER, BY_SUM
from ratt_opt.solvers.maxmin.levels.by_levels import SearchByLevels

if TYPE_CHECKING:
    from ratt_opt.solvers.maxmin.levels.elements import Elements
    from ratt_opt.solvers.maxmin.levels.level_search import LevelSearch
    from ratt_opt.solvers.maxmin.proof import UpperProof
    from ratt_opt.solvers.maxmin.search import Known

__all__ = ["CoverSearch"]

MOST_COVERS = 20_000
"""Covers that are known at once: a node looks at all of them."""


class CoverSearch(SearchByLevels):
    """Bounds the optimum by searches whose dead ends are covers."""

    def __init__(self, known: Known, elements: Elements) -> None:
        super().__init__(known, elements)
        self._separation = Separation(elements.problem)
        self._proof: DiveProof | None = None

    @classmethod
    def of(cls, known: Known, elements: Elements) -> CoverSearch | None:
        """The search, unless a robot has more elements than its masks hold."""
        fits = max(map(len, elements.problem.choices)) <= MOST_CHOICES
        return cls(known, elements) if fits else None

    def proof(self) -> UpperProof:
        """The proof of ``upper``."""
        assert self._proof is not None
        return self._proof.written()

    def _begun(self) -> LevelSearch:
        return CoverLevelSearch(self._elements, self._separation, self._known.incumbent, self._level)

    def _make_room(self) -> None:
        """Of too many covers forget the old ones, too, and the searches that know them."""
        if len(self._separation.pool) > MOST_COVERS:
            self._separation.pool.keep_latest(MOST_COVERS // 4)
            self._searches.clear()
        super()._make_room()

    def _keep(self, search: LevelSearch) -> None:
        """Take what a search proved; its covers are stated now, since what numbers them changes."""
        assert isinstance(search, CoverLevelSearch)
        nodes, pool = search.dive.record.nodes, self._separation.pool
        by_cover = nodes[nodes[:, 0] == BY_COVER, 1]
        in_sums = [search.sums.leaves[r].covers for r in np.unique(nodes[nodes[:, 0] == BY_SUM, 1]).tolist()]
        used = np.unique(np.concatenate([by_cover, *(np.array(own, dtype=np.int64) for own in in_sums)])).tolist()
        covers = {k: self._separation.stated(k, self._elements) for k in used}
        bound = max((cover_bound(self._elements.whole, cover) for cover in covers.values()), default=0.0)
        if bound < self.upper:
            self.upper = bound
            left_out = {k: pool.covers.left_out[k].tolist() for k in used}
            leaves, terms = search.sums.leaves, search.sums.rows().terms
            self._proof = DiveProof(self._elements, nodes, covers=covers, left_out=left_out, sums=leaves, terms=terms)
