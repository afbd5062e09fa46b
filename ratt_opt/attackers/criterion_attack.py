"""One attack on one plan under a criterion of information matrices: what its schedule depends on, what stages ask."""

from __future__ import annotations

from functools import cached_property
from math import isinf
from typing import TYPE_CHECKING

from ratt_opt.attack.least_sets.packed_team import PackedTeam
from ratt_opt.attack.pricing import Plan
from ratt_opt.attackers.by_covers.cover_search import CoverSearch
from ratt_opt.attackers.by_partition.split_search import SplitSearch
from ratt_opt.attackers.by_size.relaxed_teams import PossibleGroups, unprotected_bound
from ratt_opt.attackers.by_size.size_vector_search import SizeVectorSearch
from ratt_opt.attackers.first_bound import first_bound
from ratt_opt.attackers.forced_group import forced_group_bound
from ratt_opt.attackers.heuristics.greedy import greedy_attack
from ratt_opt.attackers.team_attack import TeamAttack, last_stage
from ratt_opt.attackers.tree_bound import bound_by_trees
from ratt_opt.budget import OutOfBudget
from ratt_opt.graph.separable_groups import separable_groups

if TYPE_CHECKING:
    from ratt_opt.attackers.by_prices.price_search import PriceSearch
    from ratt_opt.attackers.task import AttackTask, Resumable
    from ratt_opt.budget import Stop
    from ratt_opt.graph.separable_groups import SeparableGroups

__all__ = ["CriterionAttack"]

SMALL = 12
"""Most robots for which all sets are looked at before anything else: some milliseconds."""
MANY_GROUPS = 300_000
"""Groups that an attack may leave for partitions to be searched."""

DENSE = 0.5
"""Share of all links from which partitions have but a share of the seconds, after possible sizes and before prices: a
disk of 24 robots and mean degree 12 closes in 0.5 s by partitions, and not in 30 by prices; a random graph with 0.7 of
all links in 6 s by sizes and prices, and not in 60 by partitions."""

PARTITIONED = 10_000
"""Groups up to which their partitions are searched without prices. Where they are few an attack mostly leaves one large
group, and what each of them needs blinded is another long proof (hubs of 30 robots, (6, 16): 3,300 groups, 0.1 s each);
where they are many, some dozens of these proofs say enough of all: the small world of 24 robots with a third blinded
closes in 2 instead of 9 s, annealing and listing included."""

FIRST_STARTS, INNER_STARTS, STARTS_FOR = 18, 3, 24
"""Annealed attacks before the first threshold, and where only nodes limit or another search sets no time: about every
fourth start finds the best attack of 24 robots where it is hardest to find (small worlds and hubs, a third blinded).
The first grow with the square of the robots beyond these 24: half a second of them at 24 robots, 1.4 s at 30."""

INNER_NODES = 500_000
"""Of the search by prices where another search asks and nothing is limited: some ten seconds. Rankings attack dozens of
teams, none of which need ever close."""

LOOKS_FROM = 2.0
"""Seconds left from which possible sizes are looked at on sparse graphs, too: of one second they took a fifth, at 30 to
50 robots, and raised the lower end from 0.80 to 0.83 of the attack, where the first threshold is at 0.9."""


class CriterionAttack(TeamAttack):
    """What the rows of the schedule are about."""

    def __init__(self, task: AttackTask, *, is_inner: bool) -> None:
        super().__init__(task, is_inner=is_inner)
        self._plan, self._objective = task.values.plan, task.problem.information_objective
        n_robots, links = task.problem.n_robots, len(task.problem.communication.links)
        self._has_many_links = 2 * links >= DENSE * n_robots * (n_robots - 1)
        self._is_brief = is_inner and isinf(task.budget.seconds_left)
        self._groups: SeparableGroups | None = None
        self._sure = 0
        """Unblinded robots that every attack leaves in some group."""
        self._sizes = PossibleGroups(None, 0)

    # -- what the schedule asks ----------------------------------------------------------------------------------

    def is_small(self) -> bool:
        """At most 12 robots."""
        return self.task.problem.n_robots <= SMALL

    def is_planar_and_complete(self) -> bool:
        """Planar targets, complete graph, no protected links."""
        return self._team is not None and self._threat.links_alike and self._team.is_planar

    def is_spatial_and_complete(self) -> bool:
        """Other targets, complete graph, no protected links."""
        return self._team is not None and self._threat.links_alike and not self._team.is_planar

    def may_list_groups(self) -> bool:
        """Packed team."""
        return self._team is not None

    def is_tabulated(self) -> bool:
        """At most 24 robots, planar targets; else at most 20."""
        return self._has_table

    def is_complete_but_for_protection(self) -> bool:
        """Packed team, complete graph, protected links."""
        return self._team is not None and self.task.problem.communication.is_complete

    def goes_by_groups(self) -> bool:
        """Groups listed, graph not dense."""
        return self._groups is not None and not self._is_dense

    def has_few_groups(self) -> bool:
        """At most 10,000 groups listed, or a brief search on a dense graph."""
        return self.goes_by_groups() and not self._has_many_groups

    def has_many_groups(self) -> bool:
        """More groups listed, graph not dense."""
        return self.goes_by_groups() and self._has_many_groups

    def may_anneal_among_groups(self) -> bool:
        """Groups listed, graph not dense, criterion compiled."""
        return self.goes_by_groups() and self._prices is not None

    def may_have_sizes_of_dense(self) -> bool:
        """Dense graph, at most 100 robots."""
        return self._team is not None and self._is_dense and PossibleGroups.apply(self.task)

    def is_packed_and_dense(self) -> bool:
        """Packed team, dense graph."""
        return self._team is not None and self._is_dense

    def has_prices(self) -> bool:
        """Criterion compiled, budget left."""
        return self._has_time_for_prices and self._prices is not None

    def prices_come_first(self) -> bool:
        """Criterion compiled, limit of time; not brief, graph not dense."""
        is_limited = not isinf(self.task.budget.seconds_left)
        return is_limited and not (self._is_brief or self._has_many_links) and self.has_prices()

    def has_no_prices(self) -> bool:
        """Criterion of one's own."""
        return not self.has_prices()

    def has_no_prices_and_a_limit(self) -> bool:
        """Criterion of one's own, limit of time."""
        return self.has_no_prices() and not isinf(self.task.budget.seconds_left)

    def looks_at_sizes(self) -> bool:
        """Dense graph, or two seconds left; not brief; at most 100 robots."""
        is_sparse_with_time = self._team is not None and self.task.budget.seconds_left > LOOKS_FROM
        return not self._is_brief and (self._is_dense or is_sparse_with_time) and PossibleGroups.apply(self.task)

    def has_weak_sets(self) -> bool:
        """Weak sets listed; partitions to come, or a sparse graph."""
        return self._sizes.has_sets and (not self._is_dense or self._groups is not None)

    def has_weak_sets_and_no_groups(self) -> bool:
        """Weak sets listed, graph dense, groups not listed."""
        return self._sizes.has_sets and self._is_dense and self._groups is None

    def is_dense_with_groups(self) -> bool:
        """Dense graph, groups listed."""
        return self._groups is not None and self._is_dense

    def may_have_sizes_again(self) -> bool:
        """Dense graph, groups listed, at most 100 robots."""
        return self.is_dense_with_groups() and PossibleGroups.apply(self.task)

    def has_weak_sets_again(self) -> bool:
        """Dense graph, groups listed, weak sets listed."""
        return self.is_dense_with_groups() and self._sizes.has_sets

    # -- the stages ----------------------------------------------------------------------------------------------

    def thresholds_of_few(self) -> Stop:
        """Values of all sets, thresholds one after the other; without all values, what single robots prove."""
        try:
            return self.thresholds()
        except (OutOfBudget, KeyboardInterrupt):
            self.first_bound()
            raise

    def first_bound(self) -> None:
        """What single robots and the forced size prove at once."""
        self.task.bracket.raise_lower(first_bound(self._objective, self._plan, self._threat))

    def size_vectors(self) -> Stop:
        """Families of groups by their sizes."""
        assert self._team is not None
        return SizeVectorSearch(self.task, self._team).run()

    def greedy(self) -> None:
        """Greedy steps."""
        self.task.offer(greedy_attack(self.task.problem, self._plan, budget=self.task.budget).attack)

    def list_groups(self) -> None:
        """The groups an attack may leave, if they are few enough, and soon listed."""
        self._groups = separable_groups(self._threat, MANY_GROUPS, self.task.budget.part())

    def without_protection(self) -> None:
        """Attackers that may cut protected links too."""
        assert self._team is not None
        unprotected_bound(self.task, self._team)

    def forced_size(self) -> None:
        """The weakest set of the size that some group is forced to keep."""
        forced_group_bound(self.task, self._team, self._sizes.least)

    def partitions(self) -> Stop:
        """Partitions of the team into listed groups, by thresholds."""
        return last_stage(self.task, self._partitions)

    def partitions_at_first(self) -> None:
        """Partitions of the team into listed groups, by thresholds."""
        self._partitions.task = self.task
        self._partitions.run()

    def exact_covers(self) -> Stop:
        """Dual prices that leave few of the listed groups, then exact covers."""
        assert self._team is not None
        assert self._groups is not None
        return last_stage(self.task, CoverSearch(self.task, self._team, self._groups))

    def anneal_among_groups(self) -> None:
        """Annealed attacks, few if partitions are searched."""
        assert self._prices is not None
        self._prices.task = self.task
        self._prices.anneal(self._starts if self._has_many_groups and not self._is_brief else INNER_STARTS)

    def anneal(self) -> None:
        """Annealed attacks, and patience for more."""
        assert self._prices is not None
        self._prices.task = self.task
        self._prices.anneal(INNER_STARTS if self._is_brief else self._starts)

    def trees(self) -> None:
        """Unblinded robots that every attack leaves in some group, by tree inequalities, and what that is worth."""
        if self._is_brief and self.task.budget.max_nodes is None:
            self.task.budget.max_nodes = self.task.budget.nodes + INNER_NODES
        is_about_values = not (self._is_brief or self._has_many_links)
        self._sure = bound_by_trees(self.task, self._objective, is_about_values=is_about_values)
        self._sizes = PossibleGroups(self._team, self._sure)

    def possible_sizes_alone(self) -> None:
        """Groups of possible sizes, with any robots in them."""
        self._sizes = PossibleGroups(self._team, self._sure)
        self._sizes.bound(self.task, lists_sets=False)

    def possible_sizes(self) -> None:
        """Groups of possible sizes, with any robots in them; lists the weak sets of these, if they are few."""
        self._sizes = PossibleGroups(self._team, self._sure)
        self._sizes.bound(self.task)

    def weak_sets(self) -> None:
        """Whether an attack can leave the weak sets, one by one."""
        self._sizes.ask(self.task)

    def dual_prices(self) -> Stop:
        """Dual prices of robots and links, by thresholds."""
        assert self._prices is not None
        return last_stage(self.task, self._prices)

    def dual_prices_at_first(self) -> None:
        """Dual prices of robots and links, by thresholds."""
        self.dual_prices()

    # -- what is known -------------------------------------------------------------------------------------------

    @property
    def _is_dense(self) -> bool:
        return self._has_many_links and not self._is_brief

    @property
    def _has_many_groups(self) -> bool:
        return self._groups is not None and len(self._groups.masks) > PARTITIONED and not self._has_many_links

    @property
    def _starts(self) -> int:
        return int(FIRST_STARTS * max(self.task.problem.n_robots / STARTS_FOR, 1.0) ** 2)

    @cached_property
    def _has_time_for_prices(self) -> bool:
        """Whether budget was left when prices were first thought of."""
        return self.task.budget.stop() is None

    @cached_property
    def _team(self) -> PackedTeam | None:
        return PackedTeam.of(self._objective, self._plan)

    @cached_property
    def _partitions(self) -> Resumable:
        assert self._team is not None
        assert self._groups is not None
        return SplitSearch(self.task, self._team, self._groups)

    @cached_property
    def _prices(self) -> PriceSearch | None:
        """The search by prices, new or begun, for criteria with compiled code."""
        plan = Plan.of(self._objective, self._plan, self._threat)
        if plan is None:
            return None
        from ratt_opt.attackers.by_prices.price_search import PriceSearch

        begun = self.task.memory.search
        return begun if isinstance(begun, PriceSearch) else PriceSearch(self.task, plan)
