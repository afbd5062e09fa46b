"""Stage: a search in depth whose dead ends are attacks that leave too little to gain."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.setfunctions.criteria.logdet import LogDetObjective
from ratt_opt.solvers.maxmin.marginal_search import MarginalSearch
from ratt_opt.solvers.maxmin.marginal_tables import MOST_ROBOTS
from ratt_opt.solvers.maxmin.stages.depth_stage import DepthStage

if TYPE_CHECKING:
    from ratt_opt.solvers.maxmin.known import Known

__all__ = ["MarginalGainsStage"]


class MarginalGainsStage(DepthStage):
    """Stage that bounds what robots that have not chosen yet can still gain."""

    name = "marginal gains"

    def fits(self, known: Known) -> bool:
        """Tell whether gains diminish, as those of log-determinants do, and there are not too many plans."""
        if known.task.objective.compiled_code != LogDetObjective.native_kernel:
            return False
        sizes = [float(len(choice)) for choice in known.elements.problem.choices]
        return len(sizes) <= MOST_ROBOTS and bool(np.prod(sizes) <= known.task.params.marginals.plans)

    def begin(self, known: Known) -> MarginalSearch:
        """Begin at the level of the best plan."""
        return MarginalSearch(known, known.elements)
