"""The schedule of attacks: stages in the order in which they run, when each applies, and its share of the budget.

Those of searches on complete graphs are in ``attack/size_vectors/size_vector_search.py``.
"""

from __future__ import annotations

from ratt_opt.attack.staging import Stage
from ratt_opt.attackers.criterion_attack import CriterionAttack as Criterion
from ratt_opt.attackers.every_attack import PARAMS as EVERY_ATTACK
from ratt_opt.attackers.team_attack import TeamAttack as Team

__all__ = ["CRITERION", "USER_FUNCTION"]

SPATIAL_SHARE = 0.6
"""Share of the remaining time for families by their sizes, before prices (targets not in the plane)."""

GREEDY_SHARE = 0.05
"""Share of the remaining time for greedy steps on networks.
At 500 robots of disk-6 they took 36 of 40 seconds; annealed attacks, which come later, are worse for the team."""

BOUND_SHARE, BOUND_NODES = 0.3, 500_000
"""Share of the remaining time, and nodes, for the weakest group of the forced size; prices get the rest."""

SOON_SHARE, LISTED_SHARE, LISTED_NODES = 0.4, 0.5, 20_000_000
"""Shares of the remaining time for columns of all groups that an attack may leave: after few annealed attacks, after
all; nodes. Most attacks with few links close in a fraction of a second; hubs of 30 robots have one that a few starts do
not find."""

SIZES_SHARE = 0.7
"""Share of the remaining time for groups of possible sizes on dense graphs: they close most, dual prices hardly any."""

FIRST_BOUND_SHARE, FIRST_BOUND_NODES = 0.05, 20_000
"""Share of the remaining time, and nodes, for a first bound on dense graphs.
The attack that comes with it is one of the starts of annealing: at 50 robots this start ends at the worst attack once,
and the others 10 % above."""

ANNEALED_SHARE = 0.5
"""Share of the remaining seconds and values for annealing by values alone, before all attacks are searched.
Without it attacks on 24 and 30 robots with a criterion of one's own were 0.6 to 6 % milder than the worst one after 5
s; with it 0 to 1 %."""

USER_FUNCTION: tuple[Stage[Team], ...] = (
    Stage("smallest largest group", Team.smallest_largest_group, Team.counts_robots),
    Stage("single robots", Team.singles, Team.is_valued_at_once),
    Stage("every attack", Team.every_attack, Team.has_few_attacks_by_value),
    Stage("greedy steps and exchanges", Team.exchanges, Team.is_valued_at_once),
    Stage("annealed values", Team.annealed_values, Team.anneals_values, ANNEALED_SHARE),
    Stage("thresholds", Team.thresholds, Team.has_a_table),
    Stage("branch and bound", Team.defer_branch_and_bound, Team.is_limited_and_inner),
    Stage("branch and bound", Team.tree_of_attacks, Team.is_limited),
)
"""Set functions that are known by their values alone."""

CRITERION: tuple[Stage[Criterion], ...] = (
    Stage("smallest largest group", Criterion.smallest_largest_group, Criterion.counts_robots),
    Stage("thresholds", Criterion.thresholds_of_few, Criterion.is_small),
    Stage("single robots", Criterion.first_bound),
    Stage("every attack", Criterion.every_attack, Criterion.has_few_attacks, EVERY_ATTACK.most),
    Stage("size vectors", Criterion.size_vectors, Criterion.is_planar_and_complete),
    Stage("size vectors", Criterion.size_vectors, Criterion.is_spatial_and_complete, SPATIAL_SHARE),
    Stage("thresholds", Criterion.thresholds, Criterion.is_tabulated),
    Stage("greedy steps", Criterion.greedy, share=GREEDY_SHARE),
    Stage("without protection", Criterion.without_protection, Criterion.is_complete_but_for_protection),
    Stage("listed columns", Criterion.listed_columns, Criterion.may_list_columns, SOON_SHARE, LISTED_NODES),
    Stage("tree inequalities", Criterion.trees),
    Stage("forced size", Criterion.forced_size, Criterion.has_no_prices),
    Stage("annealed values", Criterion.annealed_values, Criterion.has_no_prices_and_a_limit, ANNEALED_SHARE),
    Stage("branch and bound", Criterion.tree_of_attacks, Criterion.has_no_prices_and_a_limit),
    Stage("forced size", Criterion.forced_size, Criterion.may_have_sizes, FIRST_BOUND_SHARE, FIRST_BOUND_NODES),
    Stage("annealed attacks", Criterion.anneal, Criterion.has_prices),
    Stage("listed columns", Criterion.listed_columns, Criterion.may_list_columns_again, LISTED_SHARE, LISTED_NODES),
    Stage("possible sizes", Criterion.possible_sizes, Criterion.may_have_sizes, SIZES_SHARE),
    Stage("forced size", Criterion.forced_size, Criterion.has_prices, BOUND_SHARE, BOUND_NODES),
    Stage("dual prices", Criterion.dual_prices, Criterion.has_prices),
)
"""Criteria of information matrices."""
