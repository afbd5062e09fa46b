"""The schedules of attacks: stages in the order in which they run. A new stage is a file beside this one, and one line.

Those of searches on complete graphs are in ``attack/size_vectors/size_vector_search.py``.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from ratt_opt.attack.stages.all_sets import ThresholdsOfFewStage, ThresholdsStage
from ratt_opt.attack.stages.annealed_values import AnnealedOwnCriterionStage, AnnealedValuesStage
from ratt_opt.attack.stages.blinded_robots import BlindedRobotsStage
from ratt_opt.attack.stages.branch_and_bound import (
    BranchAndBoundLaterStage,
    BranchAndBoundOfOwnCriterionStage,
    BranchAndBoundStage,
)
from ratt_opt.attack.stages.dual_prices import AnnealedAttacksStage, DualPricesStage
from ratt_opt.attack.stages.every_attack import EveryAttackStage, EveryValuedAttackStage
from ratt_opt.attack.stages.forced_size import (
    ForcedSizeOfOwnCriterionStage,
    ForcedSizeOnDenseGraphsStage,
    ForcedSizeStage,
    TreeInequalitiesStage,
)
from ratt_opt.attack.stages.greedy_steps import GreedyStepsStage
from ratt_opt.attack.stages.listed_columns import ListedColumnsAgainStage, ListedColumnsStage, ListedSizeStage
from ratt_opt.attack.stages.possible_sizes import PossibleSizesStage
from ratt_opt.attack.stages.single_robots import CountedRobotsStage, SingleRobotsStage, SingleValuesStage
from ratt_opt.attack.stages.size_vectors import SizeVectorsStage, SpatialSizeVectorsStage

if TYPE_CHECKING:
    from ratt_opt.attack.stages.attack_state import AttackState
    from ratt_opt.attack.staging import Stage

__all__ = ["CRITERION_STAGES", "VALUE_STAGES"]

VALUE_STAGES: tuple[Stage[AttackState], ...] = (
    CountedRobotsStage(),
    SingleValuesStage(),
    BlindedRobotsStage(),
    EveryValuedAttackStage(),
    GreedyStepsStage(),
    AnnealedValuesStage(),
    ThresholdsStage(),
    BranchAndBoundLaterStage(),
    BranchAndBoundStage(),
)
"""Stages of an attack: set functions that are known by their values alone."""

CRITERION_STAGES: tuple[Stage[AttackState], ...] = (
    CountedRobotsStage(),
    ThresholdsOfFewStage(),
    SingleRobotsStage(),
    EveryAttackStage(),
    SizeVectorsStage(),
    SpatialSizeVectorsStage(),
    ThresholdsStage(),
    GreedyStepsStage(),
    ListedColumnsStage(),
    TreeInequalitiesStage(),
    ListedSizeStage(),
    ForcedSizeOfOwnCriterionStage(),
    AnnealedOwnCriterionStage(),
    BranchAndBoundOfOwnCriterionStage(),
    ForcedSizeOnDenseGraphsStage(),
    AnnealedAttacksStage(),
    PossibleSizesStage(),
    ForcedSizeStage(),
    ListedColumnsAgainStage(),
    DualPricesStage(),
)
"""Stages of an attack: criteria of information matrices."""
