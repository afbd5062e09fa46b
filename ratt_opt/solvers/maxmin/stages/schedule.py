"""The schedule of the upper end: stages in the order of their turns. A new one is a file here, and one line."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ratt_opt.solvers.maxmin.stages.concave_trees import ConcaveTreesStage
from ratt_opt.solvers.maxmin.stages.covers import CoversStage
from ratt_opt.solvers.maxmin.stages.marginal_gains import MarginalGainsStage

if TYPE_CHECKING:
    from ratt_opt.solvers.maxmin.stages.bound_stage import BoundStage

__all__ = ["BOUND_STAGES", "TREES_ALONE"]

BOUND_STAGES: tuple[BoundStage, ...] = (
    ConcaveTreesStage(),
    MarginalGainsStage(),
    CoversStage(),
)
"""Stages of the upper end, in the order of their turns."""
TREES_ALONE: tuple[BoundStage, ...] = (ConcaveTreesStage(),)
"""Stages whose proofs are trees of tangents alone."""
