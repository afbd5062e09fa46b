"""Condition and share that the searches in depth have in common."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.attack.team import LARGEST_DIMENSION
from ratt_opt.setfunctions.criteria.logdet import LogDetObjective
from ratt_opt.setfunctions.criteria.trace import TraceObjective
from ratt_opt.solvers.maxmin.stages.bound_stage import BoundStage, TurnShare

if TYPE_CHECKING:
    from ratt_opt.solvers.maxmin.known import Known

__all__ = ["DepthStage"]

SUMS = frozenset((TraceObjective.native_kernel, LogDetObjective.native_kernel))
"""Criteria that are sums over targets."""


class DepthStage(BoundStage):
    """Stage that searches in depth, level by level."""

    kind = "in depth"

    def applies(self, known: Known) -> bool:
        """Robots see few targets, all may choose, and the criterion is trace or log-det, of up to 64 dimensions."""
        objective = known.task.objective
        if (
            known.task.problem.at_most is not None
            or objective.compiled_code not in SUMS
            or objective.dimension > LARGEST_DIMENSION
        ):
            return False
        seen = np.trace(objective.information, axis1=-2, axis2=-1) > 0
        return bool(seen.mean() <= 1 - known.task.params.depth.unseen) and self.fits(known)

    def fits(self, known: Known) -> bool:
        """Tell whether the search can hold the team's elements."""
        raise NotImplementedError

    def share(self, known: Known) -> TurnShare:
        """Return many nodes for each of the trees', fewer beside rows after turns in vain."""
        params = known.task.params.depth
        if known.rows_from == 0:
            return TurnShare(first=params.first, most=params.most, in_vain=params.in_vain)
        return TurnShare(first=params.most, most=params.most)
