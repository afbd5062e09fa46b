"""Stage: a search in depth whose dead ends are covers."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ratt_opt.solvers.maxmin.covers.choices import MOST_CHOICES
from ratt_opt.solvers.maxmin.covers.cover_search import CoverSearch
from ratt_opt.solvers.maxmin.stages.depth_stage import DepthStage

if TYPE_CHECKING:
    from ratt_opt.solvers.maxmin.known import Known

__all__ = ["CoversStage"]


class CoversStage(DepthStage):
    """Stage that counts the robots that must choose what no attack can afford to leave."""

    name = "covers"

    def fits(self, known: Known) -> bool:
        """Tell whether no robot has more elements than its masks hold."""
        return max(map(len, known.elements.problem.choices)) <= MOST_CHOICES

    def begin(self, known: Known) -> CoverSearch:
        """Begin at the level of the best plan."""
        return CoverSearch(known, known.elements)
