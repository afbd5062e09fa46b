"""Proof that one group never exceeds a level, whatever its robots choose.

A small depth-first search of its own: tangent cuts at improving mixtures of the group's elements bound it, and if
one cut is not enough the robot whose mixture gains most is divided. One plan above the level ends it without a proof.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.bounds.cuts import GroupCut, combined_bound, tangent_cut
from ratt_opt.solvers.maxmin.proof import Leaf
from ratt_opt.solvers.maxmin.relaxed.mixtures import divide_elements, mixing_gains
from ratt_opt.solvers.maxmin.task import with_choice

if TYPE_CHECKING:
    from ratt_opt._validation import FloatArray, IntArray
    from ratt_opt.budget import Budget
    from ratt_opt.solvers.maxmin.frontier import ClosingRule
    from ratt_opt.solvers.maxmin.proof import TreeNode
    from ratt_opt.solvers.maxmin.relaxed.cut_store import CutStore
    from ratt_opt.solvers.maxmin.task import Choices, Task

__all__ = ["ClosedGroup", "GroupProofs", "close_group"]

STEPS = 6
"""Frank-Wolfe steps towards the best mixture of a node. 3 and 12 lead to as many search nodes in teams of ten."""
LARGEST_PROOF = 300
"""Cuts after which the attempt is given up."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class ClosedGroup:
    """A node of the proof: closed by ``cut``, or divided into ``parts`` = (elements of ``robot``, node)."""

    bound: float
    cut: GroupCut | None = None
    robot: int = -1
    parts: tuple[tuple[IntArray, ClosedGroup], ...] = ()


class _RefutedError(Exception):
    """The group exceeds the level with some elements, the proof became too large, or the time is up."""


def close_group(
    task: Task, members: tuple[int, ...], choices: Choices, rule: ClosingRule, budget: Budget
) -> ClosedGroup | None:
    """Prove that ``rule`` closes the group's value under every plan within ``choices``, or return ``None``.

    Of hundreds of robots and targets a proof takes seconds, so the budget is asked at each of its nodes.
    """
    search = _Search(task, members, rule, budget)
    try:
        return search.close(choices)
    except _RefutedError:
        return None


class _Search:
    def __init__(self, task: Task, members: tuple[int, ...], rule: ClosingRule, budget: Budget) -> None:
        self.problem, self.objective = task.problem, task.objective
        self.members, self.rule, self.budget = members, rule, budget
        self.inside = np.isin(np.arange(task.problem.n_robots), members)
        self.cuts = 0

    def close(self, choices: Choices) -> ClosedGroup:
        """Close one node of the proof, by a cut or by dividing it."""
        if self.budget.is_over:
            raise _RefutedError
        own = tuple(choices[i] for i in self.members)
        plan = np.array([choice[0] for choice in own], dtype=np.int64)
        selection = np.zeros(self.objective.n)
        for step in range(STEPS):
            share = 2 / (step + 2)
            selection *= 1 - share
            selection[plan] += share
            chosen = np.flatnonzero(selection)
            mixed = np.tensordot(selection[chosen], self.objective.information[chosen], axes=1)
            point: FloatArray = self.objective.prior_information + mixed
            cut = tangent_cut(self.problem, self.members, point)
            self.cuts += 1
            bound, scores = combined_bound(np.array([cut.constant]), cut.scores[None], np.ones(1), choices)
            if self.rule.closes(bound):
                return ClosedGroup(bound=bound, cut=cut)
            plan = np.array([choice[scores[choice].argmax()] for choice in own], dtype=np.int64)
            value = float(self.objective.value(self.objective.posterior_information(plan)[None])[0])
            if not self.rule.closes(value) or self.cuts > LARGEST_PROOF:
                raise _RefutedError
        return self._divide(choices, selection, point, cut.target)

    def _divide(self, choices: Choices, selection: FloatArray, point: FloatArray, target: int | None) -> ClosedGroup:
        inside, points = self.inside[None], point[None]
        gains = mixing_gains(
            self.problem, selection=selection, inside=inside, points=points, weights=np.ones(1), targets=[target]
        )
        divisible = [i for i in self.members if len(choices[i]) > 1]
        if not divisible:
            raise _RefutedError
        robot = max(divisible, key=lambda i: (gains[i], -i))
        parts = tuple(
            (part, self.close(with_choice(choices, robot, part)))
            for part in divide_elements(self.objective, choices[robot], selection, point)
        )
        return ClosedGroup(bound=max(node.bound for _, node in parts), robot=robot, parts=parts)


class GroupProofs:
    """Closes groups of the pool; attempts are remembered until a better plan is known."""

    def __init__(self, cuts: CutStore, rule: ClosingRule, budget: Budget) -> None:
        self.task, self.pool, self.cuts, self.rule, self.budget = cuts.task, cuts.pool, cuts, rule, budget
        self._attempts: dict[tuple[int, bytes], tuple[float, ClosedGroup | None]] = {}
        self._written: dict[tuple[int, ClosedGroup], int] = {}
        """Outcome and proof -> the cut in the store: the same proof is written below many nodes."""

    def find(self, group: int, choices: Choices) -> ClosedGroup | None:
        """A proof that a group stays low enough within ``choices``, if one is found."""
        members = self.pool.groups[group]
        key = (group, b"|".join(choices[i].tobytes() for i in members))
        level, proof = self._attempts.get(key, (-np.inf, None))
        if proof is not None and not self.rule.closes(proof.bound):
            level, proof = -np.inf, None  # of a time when the best plan seemed better
        if proof is None and level < self.rule.level:
            proof = close_group(self.task, members, choices, self.rule, self.budget)
            self._attempts[key] = (self.rule.level, proof)
        return proof

    def graft(self, node: TreeNode, outcome: int, group: int, proof: ClosedGroup) -> list[TreeNode]:
        """Write the proof that a group is closed below ``node`` of the search tree; return its leaves."""
        if proof.cut is not None:
            if (k := self._written.get((outcome, proof))) is None:
                k = self._written[outcome, proof] = self.cuts.add(outcome, group, proof.cut)
            node.leaf = Leaf(cuts=(k,), weights=(1.0,))
            node.bound = proof.bound
            return [node]
        children = [node.child(with_choice(node.choices, proof.robot, part)) for part, _ in proof.parts]
        node.divide(proof.robot, children, self.task)
        return [
            leaf
            for child, (_, below) in zip(children, proof.parts, strict=True)
            for leaf in self.graft(child, outcome, group, below)
        ]
