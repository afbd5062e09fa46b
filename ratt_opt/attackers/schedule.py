"""The schedule of attacks: stages in the order in which they run, when each applies, and its share of the budget.

Those of searches on complete graphs are in ``by_size/size_vector_search.py`` and ``family_prices/family_search.py``.
"""

from __future__ import annotations

from ratt_opt.attackers.criterion_attack import CriterionAttack as Criterion
from ratt_opt.attackers.staging import Stage
from ratt_opt.attackers.team_attack import TeamAttack as Team

__all__ = ["CRITERION", "USER_FUNCTION"]

SPATIAL_SHARE = 0.6
"""Of the time left for families by their sizes where targets are not in the plane, before prices."""

GREEDY_SHARE = 0.05
"""Of the time left for greedy steps on networks, which at 500 robots of disk-6 took 36 of 40 seconds; annealed attacks,
which come later, are worse for the team."""

LISTING_SHARE = 0.1
"""Of the seconds left for listing groups. It takes a second on sparse graphs of 50 robots, four on dense ones."""

SOON_SHARE, SOON_NODES = 0.2, 200_000
"""Of what is left for partitions of few groups before attacks are annealed: about a second, within which most close.
Hubs of 50 robots, (24, 9), had an attack after two minutes that was 0.13 % milder than what any start finds; so few
starts are enough."""

SIZES_SHARE, SIZES_NODES = 0.2, 3_000_000
"""Of the seconds left, and of the nodes, at most so many, for groups of possible sizes. Lists of weak sets take most of
them: at 50 robots of a dense graph, 10 blinded and 128 links cut, 2 million nodes and six seconds."""

FIRST_ASKED, ASKED_SHARE = 0.1, 0.5
"""Of the seconds left to ask of each weak set, if they are few, whether an attack can leave it: slow and sure. The
second on dense graphs after partitions, or where these are not searched. Two dense graphs, of 24 and 30 robots, were
left open by 0.1 % where sizes and sets had a fifth together; with a half at first, a disk of mean degree 12 that
partitions close in two seconds waited for 15."""

BOUND_SHARE, BOUND_NODES = 0.3, 500_000
"""Of what is left, for the weakest group of the forced size; prices get the rest."""

PRICES_SHARE = 0.5
"""Of what is left for dual prices on graphs that are not dense, before groups of possible sizes and the forced size."""

SPLIT_SHARE, SPLIT_NODES = 0.2, 10_000_000
"""Of what is left for partitions on dense graphs, and at most so many nodes (some seconds)."""

ANNEALED_SHARE = 0.5
"""Of the seconds and values left for annealing by values alone; then all attacks are searched. Without it attacks on 24
and 30 robots with a criterion of one's own were 0.6 to 6 % milder than the worst one after 5 s; with it 0 to 1 %."""

USER_FUNCTION: tuple[Stage[Team], ...] = (
    Stage("single robots", Team.singles, Team.is_valued_at_once),
    Stage("every attack", Team.every_attack, Team.has_few_attacks_and_no_table),
    Stage("greedy steps and exchanges", Team.exchanges, Team.is_valued_at_once),
    Stage("annealed values", Team.annealed_values, Team.anneals_values, ANNEALED_SHARE),
    Stage("thresholds", Team.thresholds, Team.has_a_table),
    Stage("branch and bound", Team.tree_for_later, Team.is_limited_and_inner),
    Stage("branch and bound", Team.tree_of_attacks, Team.is_limited),
)
"""Set functions that are known by their values alone."""

CRITERION: tuple[Stage[Criterion], ...] = (
    Stage("thresholds", Criterion.thresholds_of_few, Criterion.is_small),
    Stage("single robots", Criterion.first_bound),
    Stage("every attack", Criterion.every_attack, Criterion.has_few_attacks),
    Stage("size vectors", Criterion.size_vectors, Criterion.is_planar_and_complete),
    Stage("size vectors", Criterion.size_vectors, Criterion.is_spatial_and_complete, SPATIAL_SHARE),
    Stage("thresholds", Criterion.thresholds, Criterion.is_tabulated),
    Stage("greedy steps", Criterion.greedy, share=GREEDY_SHARE),
    Stage("listing of groups", Criterion.list_groups, Criterion.may_list_groups, LISTING_SHARE),
    Stage("without protection", Criterion.without_protection, Criterion.is_complete_but_for_protection),
    # where all groups are listed, on graphs that are not dense
    Stage("forced size", Criterion.forced_size, Criterion.goes_by_groups),
    Stage("partitions", Criterion.partitions_at_first, Criterion.has_few_groups, SOON_SHARE, SOON_NODES),
    Stage("annealed attacks", Criterion.anneal_among_groups, Criterion.may_anneal_among_groups),
    Stage("partitions", Criterion.partitions, Criterion.has_few_groups),
    Stage("exact covers", Criterion.exact_covers, Criterion.has_many_groups),
    # elsewhere
    Stage(
        "possible sizes", Criterion.possible_sizes_alone, Criterion.may_have_sizes_of_dense, SIZES_SHARE, SIZES_NODES
    ),
    Stage("forced size", Criterion.forced_size, Criterion.is_packed_and_dense, BOUND_SHARE, BOUND_NODES),
    Stage("tree inequalities", Criterion.trees),
    Stage("forced size", Criterion.forced_size, Criterion.has_no_prices),
    Stage("annealed values", Criterion.annealed_values, Criterion.has_no_prices_and_a_limit, ANNEALED_SHARE),
    Stage("branch and bound", Criterion.tree_of_attacks, Criterion.has_no_prices_and_a_limit),
    Stage("annealed attacks", Criterion.anneal, Criterion.has_prices),
    Stage("dual prices", Criterion.dual_prices_at_first, Criterion.prices_come_first, PRICES_SHARE),
    Stage("possible sizes", Criterion.possible_sizes, Criterion.looks_at_sizes, SIZES_SHARE, SIZES_NODES),
    Stage("weak sets", Criterion.weak_sets, Criterion.has_weak_sets, FIRST_ASKED, SIZES_NODES),
    Stage("weak sets", Criterion.weak_sets, Criterion.has_weak_sets_and_no_groups, ASKED_SHARE, SIZES_NODES),
    Stage("forced size", Criterion.forced_size, Criterion.has_prices, BOUND_SHARE, BOUND_NODES),
    Stage("partitions", Criterion.partitions_at_first, Criterion.is_dense_with_groups, SPLIT_SHARE, SPLIT_NODES),
    Stage("possible sizes", Criterion.possible_sizes, Criterion.may_have_sizes_again, SIZES_SHARE, SIZES_NODES),
    Stage("weak sets", Criterion.weak_sets, Criterion.has_weak_sets_again, ASKED_SHARE, SIZES_NODES),
    Stage("forced size", Criterion.forced_size, Criterion.is_dense_with_groups, BOUND_SHARE, BOUND_NODES),
    Stage("dual prices", Criterion.dual_prices, Criterion.has_prices),
)
"""Criteria of information matrices."""
