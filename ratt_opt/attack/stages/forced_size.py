"""Stages: the size that some group is forced to keep, and what its weakest set is worth.

Both rely on a non-decreasing objective. A group of k robots is worth at least its strongest robot, so at least the k-th
smallest individual value; of a criterion with compiled code the weakest set of k robots is searched for
(``attack/least_sets``).
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.attack.bounds import ROUNDING, first_bound, forced_survivors, tree_bound
from ratt_opt.attack.least_sets.exchanges import weak_sets_of_size
from ratt_opt.attack.least_sets.least_set_search import LeastSetSearch
from ratt_opt.attack.stages.attack_state import AttackState
from ratt_opt.attack.staging import Share, Stage
from ratt_opt.graph.largest_group.heuristic_cut import heuristic_cut
from ratt_opt.graph.largest_group.spreading import forced_size
from ratt_opt.problem import Attack

if TYPE_CHECKING:
    from ratt_opt._validation import FloatArray
    from ratt_opt.attack.params import AttackParams
    from ratt_opt.attack.task import AttackTask
    from ratt_opt.attack.team import Team
    from ratt_opt.budget import Budget

__all__ = [
    "ForcedSizeOfOwnCriterionStage",
    "ForcedSizeOnDenseGraphsStage",
    "ForcedSizeStage",
    "TreeInequalitiesStage",
]


class TreeInequalitiesStage(Stage[AttackState]):
    """Stage that raises the forced size by tree inequalities."""

    name = "tree inequalities"

    def run(self, attack: AttackState) -> None:
        """Unblinded robots that every attack leaves in some group, by tree inequalities, and what that is worth."""
        task = attack.task
        if attack.is_brief and task.budget.max_nodes is None:
            task.budget.max_nodes = task.budget.nodes + task.params.criterion.inner_nodes
        budget, bracket, params = task.budget, task.bracket, task.params.bounds
        objective, plan, threat = attack.objective, task.values.plan, attack.threat
        part = budget.part(params.share, at_least=min(params.short_share * budget.seconds_left, params.short))
        attack.sure = forced_size(threat, part, threat.graph.n_robots, task.params.trees)
        bracket.raise_lower(first_bound(objective, plan, threat, attack.sure))
        if not attack.is_brief:
            bracket.raise_lower(tree_bound(objective, plan, threat, part, bracket.upper, params))
        budget.check()


class ForcedSizeStage(Stage[AttackState]):
    """Stage that searches for the weakest set of the forced size."""

    name = "forced size"

    def applies(self, attack: AttackState) -> bool:
        """Criterion compiled, budget left."""
        return attack.has_prices

    def share(self, params: AttackParams) -> Share:
        """Return a part that leaves time for prices."""
        return Share(part=params.stages.bound, max_nodes=params.stages.bound_nodes)

    def run(self, attack: AttackState) -> None:
        """The weakest set of the size that some group is forced to keep."""
        task, team = attack.task, attack.team
        task.budget.check()
        single = task.values.singletons()
        _offer_cut(task, single)
        size = max(forced_survivors(attack.threat), attack.sure)
        if size:
            task.bracket.raise_lower(float(np.sort(single)[size - 1]))
        if team is not None and size:
            with task.budget.stage(task.params.bounds.fewer) as part:
                for fewer in range(1, size):
                    _bound_by_weakest(task, team, fewer, part)
            _bound_by_weakest(task, team, size, task.budget)


class ForcedSizeOfOwnCriterionStage(ForcedSizeStage):
    """Stage for a criterion without compiled code."""

    def applies(self, attack: AttackState) -> bool:
        """Criterion of one's own."""
        return not attack.has_prices

    def share(self, params: AttackParams) -> Share:  # noqa: ARG002
        """Return the whole budget: little else helps."""
        return Share()


class ForcedSizeOnDenseGraphsStage(ForcedSizeStage):
    """Stage that looks at the forced size early if the graph is dense."""

    def applies(self, attack: AttackState) -> bool:
        """Dense graph, at most 100 robots, packed team, not brief."""
        return attack.may_have_sizes

    def share(self, params: AttackParams) -> Share:
        """Return a small part."""
        return Share(part=params.stages.first_bound, max_nodes=params.stages.first_bound_nodes)


def _bound_by_weakest(task: AttackTask, team: Team, size: int, budget: Budget) -> None:
    """Raise the lower end by the weakest set of robots of one size; raises ``OutOfBudget``."""
    bracket, depth = task.bracket, task.params.bounds.in_depth
    weakest = min(map(team.value, weak_sets_of_size(team, size, budget)), default=np.inf)
    search = LeastSetSearch(team, size, min(weakest, bracket.upper), bracket.lower, in_depth=depth)
    for bound in search.rising_bounds(budget):
        bracket.raise_lower(bound * (1 - ROUNDING))


def _offer_cut(task: AttackTask, single: FloatArray) -> None:
    """The cut that shrinks the largest group, with the strongest robots of the best group blinded in turn."""
    problem = task.problem
    cut = heuristic_cut(problem.threat, task.budget)
    groups = problem.communication.groups(cut)
    blinded: set[int] = set()
    for _ in range(problem.threat.n_blinded):
        worth = [problem.objective(task.values.plan[sorted(group - blinded)]) for group in groups]
        best = groups[int(np.argmax(worth))] - blinded - problem.protected_robots
        if not best:
            break
        blinded.add(min(best, key=lambda i: (-single[i], i)))
    task.offer(Attack(frozenset(blinded), cut))
