"""State of one attack on one plan: what conditions depend on, and what one stage leaves to the next."""

from __future__ import annotations

from functools import cached_property
from math import isinf
from typing import TYPE_CHECKING

from ratt_opt.attack.team import Team, has_native_kernel, work_of_value
from ratt_opt.attack.thresholds.dual_prices import ThresholdDecision
from ratt_opt.attack.thresholds.pricing import PricingProblem
from ratt_opt.attack.thresholds.threshold_search import ThresholdSearch

if TYPE_CHECKING:
    from ratt_opt.attack.task import AttackTask
    from ratt_opt.attack.thresholds.listed_columns import ListedSearch
    from ratt_opt.setfunctions.information import InformationObjective

__all__ = ["AttackState", "can_enumerate_subsets"]


def can_enumerate_subsets(task: AttackTask) -> bool:
    """Tell whether all subsets of the team can be enumerated, by the compiled code or by their values."""
    n_robots, f, params = task.problem.n_robots, task.problem.objective, task.params.all_sets
    if not has_native_kernel(f):
        return n_robots <= params.valued and 2**n_robots <= task.budget.evaluations_left
    is_soon = work_of_value(f) * 2.0**n_robots <= params.most_work
    return n_robots <= params.valued or (is_soon and n_robots <= params.enumerated)


class AttackState:
    """State of one attack; ``task`` has the budget of the stage that runs.

    ``is_inner`` : another search asks, and goes on with the attack later if it is worth it
    """

    def __init__(self, task: AttackTask, *, is_inner: bool) -> None:
        self.task, self.is_inner, self.threat = task, is_inner, task.problem.threat
        self.is_limited = not isinf(min(task.budget.seconds_left, task.budget.evaluations_left))
        """A limit of time or of values."""
        self.is_brief = is_inner and isinf(task.budget.seconds_left)
        """Short stages: another search runs many attacks without a limit of time."""
        self.has_table = can_enumerate_subsets(task)
        """Sets of robots are few enough to be looked at one by one."""
        self.is_annealed = False
        """Annealed attacks have been offered."""
        self.listed: ListedSearch | None = None
        """Search over listed columns, once the groups are listed."""
        self.sure = 0
        """Unblinded robots that every attack leaves in some group."""

    @property
    def n_robots(self) -> int:
        """Number of robots N."""
        return self.task.problem.n_robots

    @property
    def objective(self) -> InformationObjective:
        """The criterion. Raises ``InputError`` for other set functions."""
        return self.task.problem.information_objective

    @property
    def has_time_limit(self) -> bool:
        """Limit of time."""
        return not isinf(self.task.budget.seconds_left)

    @cached_property
    def is_dense(self) -> bool:
        """Graph so dense that sizes of groups say more than dual prices."""
        links = len(self.task.problem.communication.links)
        return 2 * links >= self.task.params.criterion.dense * self.n_robots * (self.n_robots - 1)

    @cached_property
    def team(self) -> Team | None:
        """The plan packed for compiled code; ``None`` if the criterion has none."""
        return Team.of(self.objective, self.task.values.plan, self.task.params)

    @cached_property
    def search_by_prices(self) -> ThresholdSearch | None:
        """The search by prices, new or begun; ``None`` if the criterion is not compiled."""
        plan = PricingProblem.of(self.objective, self.task.values.plan, self.threat, self.task.params)
        if plan is None:
            return None
        begun = self.task.memory.search
        if isinstance(begun, ThresholdSearch):
            return begun
        return ThresholdSearch(self.task, plan, ThresholdDecision(plan))

    @property
    def has_prices(self) -> bool:
        """Criterion compiled, budget left."""
        return self._has_time_for_prices and self.search_by_prices is not None

    @property
    def may_have_sizes(self) -> bool:
        """Dense graph, at most 100 robots, packed team, not brief."""
        is_worth_it = self.is_dense and not self.is_brief and self.threat.n_blinded < self.n_robots
        return is_worth_it and self.team is not None and self.n_robots <= self.task.params.possible_sizes.largest

    @cached_property
    def _has_time_for_prices(self) -> bool:
        """Budget left when prices were first considered."""
        return self.task.budget.stop() is None
