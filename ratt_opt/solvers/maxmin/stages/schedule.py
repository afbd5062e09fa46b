"""The schedules of both ends: stages in the order in which they run. A new one is a class and one line here."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ratt_opt.solvers.maxmin.covers.cover_search import CoversStage
from ratt_opt.solvers.maxmin.marginal_search import MarginalGainsStage
from ratt_opt.solvers.maxmin.restarts import ConcaveTreesStage
from ratt_opt.solvers.maxmin.stages.first_plans import AttackedStage, BestAttackedStage, ClimbStage, QuickValuesStage
from ratt_opt.solvers.maxmin.stages.proof import ProofStage
from ratt_opt.solvers.maxmin.stages.ties import TiesStage
from ratt_opt.solvers.maxmin.walk import WalkStage

if TYPE_CHECKING:
    from ratt_opt.solvers.maxmin.bound_stage import BoundStage
    from ratt_opt.solvers.maxmin.plan_stage import PlanStage

__all__ = ["BOUND_STAGES", "PLAN_STAGES", "TREES_ALONE"]

BOUND_STAGES: tuple[BoundStage, ...] = (
    ConcaveTreesStage(),
    MarginalGainsStage(),
    CoversStage(),
)
"""Stages of the upper end, in the order of their turns."""
TREES_ALONE: tuple[BoundStage, ...] = (ConcaveTreesStage(),)
"""Stages whose proofs are trees of tangents alone."""
PLAN_STAGES: tuple[PlanStage, ...] = (
    AttackedStage(),
    QuickValuesStage(),
    ClimbStage(),
    WalkStage(),
    BestAttackedStage(),
    ProofStage(),
    TiesStage(),
)
"""Stages of the lower end, in order; each says in which phase it runs."""
