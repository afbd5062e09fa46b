"""One attack on one plan under a criterion of information matrices: what its schedule depends on, what stages ask."""

from __future__ import annotations

from functools import cached_property
from math import isinf
from typing import TYPE_CHECKING

from ratt_opt.attack.bounds import bound_by_trees, first_bound, forced_group_bound
from ratt_opt.attack.heuristics import greedy_attack
from ratt_opt.attack.size_vectors.possible_sizes import possible_sizes_bound, unprotected_bound
from ratt_opt.attack.size_vectors.size_vector_search import SizeVectorSearch
from ratt_opt.attack.stages.every_attack import EveryAttack
from ratt_opt.attack.stages.team_attack import TeamAttack, last_stage
from ratt_opt.attack.team import Team
from ratt_opt.attack.thresholds.dual_prices import ThresholdDecision
from ratt_opt.attack.thresholds.listed_columns import ListedSearch
from ratt_opt.attack.thresholds.pricing import PricingProblem
from ratt_opt.attack.thresholds.threshold_search import ThresholdSearch
from ratt_opt.budget import OutOfBudget
from ratt_opt.graph.few_cuts import attacks_are_few
from ratt_opt.graph.group_list import LARGEST_MASK, MOST_CUT, groups_of

if TYPE_CHECKING:
    from ratt_opt.attack.task import AttackTask
    from ratt_opt.budget import Stop

__all__ = ["CriterionAttack"]


class CriterionAttack(TeamAttack):
    """Conditions and steps of the schedule's rows for a criterion."""

    def __init__(self, task: AttackTask, *, is_inner: bool) -> None:
        super().__init__(task, is_inner=is_inner)
        self._plan, self._objective = task.values.plan, task.problem.information_objective
        self._is_brief = is_inner and isinf(task.budget.seconds_left)
        n_robots, links = task.problem.n_robots, len(task.problem.communication.links)
        self._is_dense = 2 * links >= task.params.criterion.dense * n_robots * (n_robots - 1)
        self._is_annealed = False
        self._listed: ListedSearch | None = None
        self._sure = 0
        """Unblinded robots that every attack leaves in some group."""

    # -- what the schedule asks ----------------------------------------------------------------------------------

    def is_small(self) -> bool:
        """Team of at most 12 robots."""
        return self.task.problem.n_robots <= self.task.params.criterion.small

    def has_few_attacks(self) -> bool:
        """Links not all alike; at most 20,000 attacks, or more than 24 robots and as many as soon are tried."""
        if self._threat.links_alike or attacks_are_few(self._threat):
            return super().has_few_attacks()
        return not (self._has_table or self._is_brief) and EveryAttack(self.task).is_soon()

    def is_planar_and_complete(self) -> bool:
        """Planar targets, complete graph, no protected links."""
        return self._team is not None and self._threat.links_alike and self._team.is_planar

    def is_spatial_and_complete(self) -> bool:
        """Other targets, complete graph, no protected links."""
        return self._team is not None and self._threat.links_alike and not self._team.is_planar

    def is_tabulated(self) -> bool:
        """Planar targets and at most 24 robots; else at most 20."""
        return self._has_table

    def is_complete_but_for_protection(self) -> bool:
        """Packed team, complete graph, protected links."""
        return self._team is not None and self.task.problem.communication.is_complete

    def may_list_columns(self) -> bool:
        """Criterion compiled, at most 60 robots and 255 links to cut."""
        is_narrow = self.task.problem.n_robots <= LARGEST_MASK and self._threat.alpha_c <= MOST_CUT
        return self._prices is not None and is_narrow

    def may_list_columns_again(self) -> bool:
        """Listed columns possible, limit of time, budget left."""
        return self.may_list_columns() and not isinf(self.task.budget.seconds_left) and self.has_prices()

    def has_prices(self) -> bool:
        """Criterion compiled, budget left."""
        return self._has_time_for_prices and self._prices is not None

    def may_have_sizes(self) -> bool:
        """Dense graph, at most 100 robots, packed team, not brief."""
        is_worth_it = self._is_dense and not self._is_brief and self._threat.n_blinded < self.task.problem.n_robots
        return (
            is_worth_it
            and self._team is not None
            and self.task.problem.n_robots <= self.task.params.possible_sizes.largest
        )

    def has_no_prices(self) -> bool:
        """Criterion of one's own."""
        return not self.has_prices()

    def has_no_prices_and_a_limit(self) -> bool:
        """Criterion of one's own, limit of time."""
        return self.has_no_prices() and not isinf(self.task.budget.seconds_left)

    # -- the stages ----------------------------------------------------------------------------------------------

    def thresholds_of_few(self) -> Stop:
        """Values of all sets, thresholds one after the other; without all values, what single robots prove."""
        try:
            return self.thresholds()
        except (OutOfBudget, KeyboardInterrupt):
            self.first_bound()
            raise

    def every_attack(self) -> Stop:
        """Every attack, valued in batches."""
        return EveryAttack(self.task).run()

    def first_bound(self) -> None:
        """Raise the lower bound by single robots and the forced size."""
        self.task.bracket.raise_lower(first_bound(self._objective, self._plan, self._threat))

    def size_vectors(self) -> Stop:
        """Families of groups by their sizes."""
        assert self._team is not None
        return SizeVectorSearch(self.task, self._team).run()

    def greedy(self) -> None:
        """Greedy steps."""
        self.task.offer(greedy_attack(self.task.problem, self._plan, budget=self.task.budget).attack)

    def without_protection(self) -> None:
        """Attackers that may cut protected links too."""
        assert self._team is not None
        unprotected_bound(self.task, self._team)

    def forced_size(self) -> None:
        """The weakest set of the size that some group is forced to keep."""
        forced_group_bound(self.task, self._team, self._sure)

    def listed_columns(self) -> None:
        """All groups that an attack may leave, if they are soon listed, and whether one leaves less than in hand."""
        assert self._prices is not None
        assert self._team is not None
        if self._listed is None:
            listed = self.task.params.listed
            most, part = listed.brief if self._is_brief else listed.most, self.task.budget.part(listed.share)
            groups = groups_of(self._threat)
            if not groups.has_listed(most, part):
                return
            self._listed = ListedSearch(self.task, self._team, groups)
        if not self._is_annealed:
            self._prices.task = self.task
            self._prices.anneal(self.task.params.listed.starts)
        self._listed.task = self.task
        self._listed.run()

    def anneal(self) -> None:
        """Annealed attacks, and patience for more."""
        assert self._prices is not None
        self._prices.task = self.task
        self._prices.anneal(self.task.params.criterion.inner_starts if self._is_brief else self._starts)
        self._is_annealed = True

    def trees(self) -> None:
        """Unblinded robots that every attack leaves in some group, by tree inequalities, and what that is worth."""
        if self._is_brief and self.task.budget.max_nodes is None:
            self.task.budget.max_nodes = self.task.budget.nodes + self.task.params.criterion.inner_nodes
        self._sure = bound_by_trees(self.task, self._objective, is_about_values=not self._is_brief)

    def possible_sizes(self) -> None:
        """Groups of sizes that are possible on the graph; then the sets that one of them may be, one by one."""
        assert self._team is not None
        self._sure = possible_sizes_bound(self.task, self._team, self._sure)

    def dual_prices(self) -> Stop:
        """Dual prices of robots and links, by thresholds."""
        assert self._prices is not None
        return last_stage(self.task, self._prices)

    # -- what is known -------------------------------------------------------------------------------------------

    @property
    def _starts(self) -> int:
        params = self.task.params.criterion
        return int(params.starts * max(self.task.problem.n_robots / params.starts_for, 1.0) ** 2)

    @cached_property
    def _has_time_for_prices(self) -> bool:
        """Budget left when prices were first considered."""
        return self.task.budget.stop() is None

    @cached_property
    def _team(self) -> Team | None:
        return Team.of(self._objective, self._plan, self.task.params)

    @cached_property
    def _prices(self) -> ThresholdSearch | None:
        """The search by prices, new or begun, for criteria with compiled code."""
        plan = PricingProblem.of(self._objective, self._plan, self._threat, self.task.params)
        if plan is None:
            return None
        begun = self.task.memory.search
        return (
            begun if isinstance(begun, ThresholdSearch) else ThresholdSearch(self.task, plan, ThresholdDecision(plan))
        )
