"""The schedules of attacks: stages in the order in which they run. A new stage is a file beside this one, and one line.

Those of searches on complete graphs are in ``attack/size_vectors/size_stages.py``.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from ratt_opt.attack.stages.all_sets import Thresholds, ThresholdsOfFew
from ratt_opt.attack.stages.annealed_values import AnnealedOwnCriterion, AnnealedValues
from ratt_opt.attack.stages.branch_and_bound import (
    BranchAndBound,
    BranchAndBoundLater,
    BranchAndBoundOfOwnCriterion,
)
from ratt_opt.attack.stages.counted_robots import CountedRobots
from ratt_opt.attack.stages.dual_prices import AnnealedAttacks, DualPrices
from ratt_opt.attack.stages.every_attack import EveryAttack, EveryValuedAttack
from ratt_opt.attack.stages.forced_size import (
    ForcedSize,
    ForcedSizeOfOwnCriterion,
    ForcedSizeOnDenseGraphs,
    PossibleSizes,
    TreeInequalities,
)
from ratt_opt.attack.stages.greedy_steps import Exchanges, GreedySteps
from ratt_opt.attack.stages.listed_columns import ListedColumns, ListedColumnsAgain
from ratt_opt.attack.stages.single_robots import SingleRobots, SingleValues
from ratt_opt.attack.stages.size_vectors import SizeVectors, SpatialSizeVectors, WithoutProtection

if TYPE_CHECKING:
    from ratt_opt.attack.stages.attack_state import AttackState
    from ratt_opt.attack.staging import Stage

__all__ = ["CRITERION_STAGES", "VALUE_STAGES"]

VALUE_STAGES: tuple[Stage[AttackState], ...] = (
    CountedRobots(),
    SingleValues(),
    EveryValuedAttack(),
    Exchanges(),
    AnnealedValues(),
    Thresholds(),
    BranchAndBoundLater(),
    BranchAndBound(),
)
"""Stages of an attack: set functions that are known by their values alone."""

CRITERION_STAGES: tuple[Stage[AttackState], ...] = (
    CountedRobots(),
    ThresholdsOfFew(),
    SingleRobots(),
    EveryAttack(),
    SizeVectors(),
    SpatialSizeVectors(),
    Thresholds(),
    GreedySteps(),
    WithoutProtection(),
    ListedColumns(),
    TreeInequalities(),
    ForcedSizeOfOwnCriterion(),
    AnnealedOwnCriterion(),
    BranchAndBoundOfOwnCriterion(),
    ForcedSizeOnDenseGraphs(),
    AnnealedAttacks(),
    ListedColumnsAgain(),
    PossibleSizes(),
    ForcedSize(),
    DualPrices(),
)
"""Stages of an attack: criteria of information matrices."""
