"""The schedule of attacks: stages in the order in which they run, when each applies, and its share of the budget.

Those of searches on complete graphs are in ``attack/size_vectors/size_vector_search.py``.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from ratt_opt.attack.stages.criterion_attack import CriterionAttack as Criterion
from ratt_opt.attack.stages.team_attack import TeamAttack as Team
from ratt_opt.attack.staging import Stage

if TYPE_CHECKING:
    from ratt_opt.attack.params.stages import StageParams

__all__ = ["criterion_stages", "stages_by_values"]


def stages_by_values(share: StageParams) -> tuple[Stage[Team], ...]:
    """Stages of an attack: set functions that are known by their values alone."""
    return (
        Stage("smallest largest group", Team.smallest_largest_group, Team.counts_robots),
        Stage("single robots", Team.singles, Team.is_valued_at_once),
        Stage("every attack", Team.every_attack, Team.has_few_attacks_by_value),
        Stage("greedy steps and exchanges", Team.exchanges, Team.is_valued_at_once),
        Stage("annealed values", Team.annealed_values, Team.anneals_values, share.annealed_values),
        Stage("thresholds", Team.thresholds, Team.has_a_table),
        Stage("branch and bound", Team.defer_branch_and_bound, Team.is_limited_and_inner),
        Stage("branch and bound", Team.tree_of_attacks, Team.is_limited),
    )


def criterion_stages(share: StageParams) -> tuple[Stage[Criterion], ...]:
    """Stages of an attack: criteria of information matrices."""
    return (
        Stage("smallest largest group", Criterion.smallest_largest_group, Criterion.counts_robots),
        Stage("thresholds", Criterion.thresholds_of_few, Criterion.is_small),
        Stage("single robots", Criterion.first_bound),
        Stage("every attack", Criterion.every_attack, Criterion.has_few_attacks, share.every_attack),
        Stage("size vectors", Criterion.size_vectors, Criterion.is_planar_and_complete),
        Stage("size vectors", Criterion.size_vectors, Criterion.is_spatial_and_complete, share.spatial),
        Stage("thresholds", Criterion.thresholds, Criterion.is_tabulated),
        Stage("greedy steps", Criterion.greedy, share=share.greedy),
        Stage("without protection", Criterion.without_protection, Criterion.is_complete_but_for_protection),
        Stage(
            "listed columns",
            Criterion.listed_columns,
            Criterion.may_list_columns,
            share.listed_soon,
            share.listed_nodes,
        ),
        Stage("tree inequalities", Criterion.trees),
        Stage("forced size", Criterion.forced_size, Criterion.has_no_prices),
        Stage("annealed values", Criterion.annealed_values, Criterion.has_no_prices_and_a_limit, share.annealed_values),
        Stage("branch and bound", Criterion.tree_of_attacks, Criterion.has_no_prices_and_a_limit),
        Stage(
            "forced size", Criterion.forced_size, Criterion.may_have_sizes, share.first_bound, share.first_bound_nodes
        ),
        Stage("annealed attacks", Criterion.anneal, Criterion.has_prices),
        Stage(
            "listed columns",
            Criterion.listed_columns,
            Criterion.may_list_columns_again,
            share.listed,
            share.listed_nodes,
        ),
        Stage("possible sizes", Criterion.possible_sizes, Criterion.may_have_sizes, share.sizes),
        Stage("forced size", Criterion.forced_size, Criterion.has_prices, share.bound, share.bound_nodes),
        Stage("dual prices", Criterion.dual_prices, Criterion.has_prices),
    )
