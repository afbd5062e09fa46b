"""Proofs that groups stay weak, remembered, and their place in the search tree."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.solvers.maxmin.groups.closed_group import close_group
from ratt_opt.solvers.maxmin.proof import Leaf
from ratt_opt.solvers.maxmin.task import with_choice

if TYPE_CHECKING:
    from ratt_opt.solvers.maxmin.frontier import ClosingRule
    from ratt_opt.solvers.maxmin.groups.closed_group import ClosedGroup
    from ratt_opt.solvers.maxmin.relaxed.cut_store import CutStore
    from ratt_opt.solvers.maxmin.task import Choices
    from ratt_opt.solvers.maxmin.tree import TreeNode

__all__ = ["GroupProofs"]


class GroupProofs:
    """Closes groups of the pool; attempts are remembered until a better plan is known."""

    def __init__(self, cuts: CutStore, rule: ClosingRule) -> None:
        self.task, self.pool, self.cuts, self.rule = cuts.task, cuts.pool, cuts, rule
        self._attempts: dict[tuple[int, bytes], tuple[float, ClosedGroup | None]] = {}

    def find(self, group: int, choices: Choices) -> ClosedGroup | None:
        """A proof that a group stays low enough within ``choices``, if one is found."""
        members = self.pool.groups[group]
        key = (group, b"|".join(choices[i].tobytes() for i in members))
        level, proof = self._attempts.get(key, (-np.inf, None))
        if proof is not None and not self.rule.closes(proof.bound):
            level, proof = -np.inf, None  # of a time when the best plan seemed better
        if proof is None and level < self.rule.level:
            proof = close_group(self.task, members, choices, self.rule)
            self._attempts[key] = (self.rule.level, proof)
        return proof

    def graft(self, node: TreeNode, outcome: int, group: int, proof: ClosedGroup) -> list[TreeNode]:
        """Write the proof that a group is closed below ``node`` of the search tree; return its leaves."""
        if proof.cut is not None:
            node.leaf = Leaf(cuts=(self.cuts.add(outcome, group, proof.cut),), weights=(1.0,))
            node.bound = proof.bound
            return [node]
        children = [node.child(with_choice(node.choices, proof.robot, part)) for part, _ in proof.parts]
        node.divide(proof.robot, children, self.task)
        return [
            leaf
            for child, (_, below) in zip(children, proof.parts, strict=True)
            for leaf in self.graft(child, outcome, group, below)
        ]
