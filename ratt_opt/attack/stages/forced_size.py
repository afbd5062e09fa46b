"""Stages: the size that some group is forced to keep, and what its weakest set is worth."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ratt_opt.attack.bounds import bound_by_trees, forced_group_bound
from ratt_opt.attack.stages.attack_state import AttackState
from ratt_opt.attack.staging import Share, Stage

if TYPE_CHECKING:
    from ratt_opt.attack.params import AttackParams

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
        attack.sure = bound_by_trees(task, attack.objective, is_about_values=not attack.is_brief)


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
        forced_group_bound(attack.task, attack.team, attack.sure)


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
