"""Closing a node by the winner of one outcome, and dividing it by which group wins."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.solvers.maxmin.task import with_choice
from ratt_opt.solvers.maxmin.tree import Split

if TYPE_CHECKING:
    from ratt_opt._validation import FloatArray
    from ratt_opt.solvers.maxmin.frontier import Frontier
    from ratt_opt.solvers.maxmin.groups.closed_group import ClosedGroup
    from ratt_opt.solvers.maxmin.groups.winners import Winners
    from ratt_opt.solvers.maxmin.tree import TreeNode

__all__ = ["WinnerDivision"]


class WinnerDivision:
    """Uses proofs of weak groups within a node's own choices; the leaves they close go to the frontier."""

    def __init__(self, winners: Winners, frontier: Frontier) -> None:
        self.task, self.pool, self.winners, self.frontier = winners.task, winners.pool, winners, frontier
        self._proofs = winners.proofs

    def close(self, node: TreeNode, outcome: int) -> bool:
        """Close a node by bounds on the winner of one outcome alone; False where that does not work."""
        winner = self.winners.of(node, outcome)
        proof = None if winner is None else self._proofs.find(winner, node.choices)
        if winner is None or proof is None:
            return False
        self._close(node, outcome, winner, proof)
        return True

    def _close(self, node: TreeNode, outcome: int, group: int, proof: ClosedGroup) -> None:
        for leaf in self._proofs.graft(node, outcome, group, proof):
            self.frontier.close(leaf)

    def undecided(self, node: TreeNode, of_robot: FloatArray, level: float) -> int | None:
        """The outcome of undecided winner with the smallest value below ``level``, if any has."""
        teams = self.pool.outcome_values(self.pool.group_values(of_robot))
        for outcome in np.argsort(teams, kind="stable").tolist():
            if teams[outcome] >= level:
                return None
            if self.winners.of(node, outcome) is None:
                return int(outcome)
        return None

    def divide(self, node: TreeNode, outcome: int) -> list[TreeNode]:
        """Children in which the winner of an outcome is decided, or soon will be; those that need a search.

        Groups that a bound closes within the node's choices need none. A single robot that may win
        with some of its elements only is divided into those and the others, so that the latter close.
        """
        lone = self._divide_lone_robot(node, outcome)
        if lone:
            return lone
        parts, open_children = [], []
        for group in self.pool.of_outcome[outcome]:
            proof = self._proofs.find(group, node.choices)
            child = node.child(winner=(outcome, group))
            if proof is None:
                open_children.append(child)
            else:
                self._close(child, outcome, group, proof)
            parts.append((self.pool.groups[group], child))
        node.split = Split(by_winner=True, subject=outcome, parts=tuple(parts))
        return open_children

    def _divide_lone_robot(self, node: TreeNode, outcome: int) -> list[TreeNode]:
        groups = self.pool.of_outcome[outcome]
        winner = max(groups, key=lambda g: (len(self.pool.groups[g]), -g))
        for group in groups:
            if len(self.pool.groups[group]) != 1 or group == winner:
                continue
            (robot,) = self.pool.groups[group]
            choice = node.choices[robot]
            weak = self.task.singles[choice] <= self.frontier.rule.level
            if weak.any() and not weak.all():
                children = [node.child(with_choice(node.choices, robot, choice[part])) for part in (weak, ~weak)]
                node.divide(robot, children, self.task)
                return children
        return []
