"""Stages: branch and bound over all attacks, at once or in a later call."""

from __future__ import annotations

from ratt_opt.attack.attack_tree import AttackTree
from ratt_opt.attack.stages.attack_state import AttackState
from ratt_opt.attack.staging import Stage, go_on
from ratt_opt.budget import Stop

__all__ = ["BranchAndBoundLaterStage", "BranchAndBoundOfOwnCriterionStage", "BranchAndBoundStage"]


class BranchAndBoundStage(Stage[AttackState]):
    """Stage that divides the attacks on any set function."""

    name = "branch and bound"

    def applies(self, attack: AttackState) -> bool:
        """A limit, or no other search asks."""
        return attack.is_limited or not attack.is_inner

    def run(self, attack: AttackState) -> Stop:
        """Branch and bound over all attacks."""
        attack.task.budget.check()
        return go_on(attack.task, AttackTree(attack.task))


class BranchAndBoundLaterStage(BranchAndBoundStage):
    """Stage that leaves the branch and bound to a call that asks again."""

    def applies(self, attack: AttackState) -> bool:
        """A limit, another search asks."""
        return attack.is_limited and attack.is_inner

    def run(self, attack: AttackState) -> Stop:
        """Keep a branch and bound in the memory; the next call continues it."""
        attack.task.budget.check()
        attack.task.memory.search = AttackTree(attack.task)
        return attack.task.budget.stop() or Stop.HEURISTIC


class BranchAndBoundOfOwnCriterionStage(BranchAndBoundStage):
    """Stage for a criterion without compiled code."""

    def applies(self, attack: AttackState) -> bool:
        """Criterion of one's own; a limit of time, or no other search asks."""
        return not attack.has_prices and (attack.has_time_limit or not attack.is_inner)
