"""Stage: concave relaxations, tree after tree."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ratt_opt.solvers.maxmin.restarts import RestartedSearch
from ratt_opt.solvers.maxmin.stages.bound_stage import BoundStage, TurnShare

if TYPE_CHECKING:
    from ratt_opt.solvers.maxmin.known import Known

__all__ = ["ConcaveTreesStage"]


class ConcaveTreesStage(BoundStage):
    """Stage that divides nodes bounded by concave relaxations; it works for every criterion."""

    name = "concave trees"
    kind = "trees"

    def share(self, known: Known) -> TurnShare:
        """Return the nodes of the last slice; at first the root alone."""
        factor = 1 / known.task.params.depth.growth
        return TurnShare(first=factor, most=factor, at_first=1)

    def begin(self, known: Known) -> RestartedSearch:
        """Begin the first tree."""
        return RestartedSearch(known)
