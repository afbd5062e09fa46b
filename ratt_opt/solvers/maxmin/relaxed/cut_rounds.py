"""Rounds of cuts: solve a node's linear program, cut its relaxed plan off, solve again."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.bounds.cuts import combined_bound, tangent_cut
from ratt_opt.solvers.maxmin.proof import TangentCut
from ratt_opt.solvers.maxmin.relaxed.node_program import NodeProgram

if TYPE_CHECKING:
    from collections.abc import Sequence

    from ratt_opt._validation import BoolArray, FloatArray, IntArray
    from ratt_opt.bounds.cuts import GroupCut
    from ratt_opt.solvers.maxmin.groups.winners import Winners
    from ratt_opt.solvers.maxmin.plans.adversary import Adversary
    from ratt_opt.solvers.maxmin.plans.outcome_pool import OutcomePool
    from ratt_opt.solvers.maxmin.proof import Leaf, TreeNode
    from ratt_opt.solvers.maxmin.relaxed.node_program import RelaxedPlan
    from ratt_opt.solvers.maxmin.task import Task

__all__ = ["CUTS_A_ROUND", "CutRounds", "CutStore"]


class CutStore:
    """Cut ``k`` bounds the team value under outcome ``outcomes[k]`` where its group ``groups[k]`` wins.

    Cuts are never removed: leaves refer to them. Scores are stored element by element, because a
    relaxed plan has few elements.
    """

    def __init__(self, task: Task, pool: OutcomePool) -> None:
        self.task, self.pool = task, pool
        self._cuts: list[GroupCut] = []
        self._origin = np.zeros((64, 2), dtype=np.int64)
        self._constants = np.zeros(64)
        self._scores = np.zeros((task.objective.n, 64))
        self._copied: dict[tuple[int, int, int | None, bytes], int] = {}

    def __len__(self) -> int:
        return len(self._cuts)

    @property
    def outcomes(self) -> IntArray:
        """(K,) outcome of each cut."""
        return self._origin[: len(self._cuts), 0]

    @property
    def groups(self) -> IntArray:
        """(K,) group of each cut, by its number in the pool."""
        return self._origin[: len(self._cuts), 1]

    @property
    def constants(self) -> FloatArray:
        """(K,) constants."""
        return self._constants[: len(self._cuts)]

    def scores(self, cut: int | IntArray) -> FloatArray:
        """(E,) scores of one cut, or (E, K) of some."""
        return self._scores[:, cut]

    def bounds(self, selection: FloatArray) -> FloatArray:
        """(K,) what each cut bounds its group's value by under a relaxed selection (E,)."""
        chosen = np.flatnonzero(selection)
        return np.asarray(self.constants + selection[chosen] @ self._scores[chosen, : len(self._cuts)])

    def tangent(self, outcome: int, group: int, point: FloatArray, target: int | None = None) -> int:
        """Add the tangent of a group's value at the posterior information ``point``; return its index."""
        return self.add(outcome, group, tangent_cut(self.task.problem, self.pool.groups[group], point, target))

    def copied(self, outcome: int, group: int, point: FloatArray, target: int | None) -> int:
        """The index of a tangent that another search had; added where it is met for the first time."""
        key = outcome, group, target, point.tobytes()
        if key not in self._copied:
            self._copied[key] = self.tangent(outcome, group, point, target)
        return self._copied[key]

    def add(self, outcome: int, group: int, cut: GroupCut) -> int:
        """Add a cut; return its index."""
        k = len(self._cuts)
        if k == len(self._constants):
            self._origin = np.concatenate([self._origin, np.zeros_like(self._origin)])
            self._constants = np.concatenate([self._constants, np.zeros_like(self._constants)])
            self._scores = np.concatenate([self._scores, np.zeros_like(self._scores)], axis=1)
        self._origin[k] = outcome, group
        self._constants[k] = cut.constant
        self._scores[:, k] = cut.scores
        self._cuts.append(cut)
        return k

    def usable(self, winners: IntArray) -> BoolArray:
        """(K,) whether each cut's group is the one that wins its outcome, by ``winners`` (O,)."""
        return np.asarray(winners[self.outcomes] == self.groups)

    def leaf_bound(self, leaf: Leaf, choices: Sequence[IntArray]) -> tuple[float, FloatArray]:
        """The bound of a leaf's convex combination over plans within ``choices``, and its combined scores."""
        cuts = list(leaf.cuts)
        return combined_bound(self._constants[cuts], self._scores[:, cuts].T, np.array(leaf.weights), choices)

    def record(self, k: int) -> TangentCut:
        """One cut as part of a proof."""
        cut = self._cuts[k]
        return TangentCut(attack=int(self.outcomes[k]), group=cut.group, point=cut.point, target=cut.target)


# Nodes below: sums over four problems of ten robots and fifteen targets (trace, max-eigenvalue; gap 1e-6), 32 as it is.
CUTS_A_ROUND = 8
"""Groups cut in one round: fewer rounds against larger programs; 4 take 32 nodes, 16 take 30, in the same time."""
TARGETS_A_CUT = 4
"""Targets of one group that get a tangent each (max-eigenvalue); 1 and 8 take 32 nodes, in the same time."""
PATIENCE = 8
"""Solves without a multiplier after which a cut leaves the program; it stays stored. 2 take 34 nodes, 32 take 30."""
VIOLATED = 1e-10
"""Share of the relaxed level by which a cut has to be lower to count as violated."""
DEEP = 0.5
"""Share of the depth of the deepest known cut that a stored one needs to be brought back; 0 and 0.9 take 30 nodes."""


class CutRounds:
    """The cuts in use at a node: usable ones that were stored, and tangents where its relaxed plan violates none."""

    def __init__(self, cuts: CutStore, winners: Winners, adversary: Adversary) -> None:
        self.task, self.pool = cuts.task, cuts.pool
        self.cuts, self.winners, self.adversary = cuts, winners, adversary
        self._program = NodeProgram(self.task.objective.n, self.task.choices)

    def use(self, k: int) -> None:
        """Bring cut ``k`` into the program."""
        self._program.use(k, float(self.cuts.constants[k]), self.cuts.scores(k))

    def use_again(self, k: int) -> None:
        """Bring cut ``k`` into the program unless it is there."""
        if k not in self._program.in_use:
            self.use(k)

    def begin(self, node: TreeNode) -> None:
        """Leave out what is not usable at a node; give it a cut on every decided outcome where it has none."""
        winners = self.winners.at(node)
        usable = self.cuts.usable(winners)
        self._program.drop(lambda k: not usable[k])
        self._program.drop_idle(PATIENCE)
        if self._program.in_use:
            return
        best = np.array([choice[self.task.singles[choice].argmax()] for choice in node.choices])
        points = self.pool.group_points(self.task.objective.information[best])
        for outcome, winner in enumerate(winners.tolist()):
            if winner >= 0 and len(self._program.in_use) < CUTS_A_ROUND:
                self.use(self.cuts.tangent(outcome, winner, points[winner]))

    def solve(self, node: TreeNode) -> RelaxedPlan | None:
        """The relaxed plan of a node under the cuts in use, or ``None`` where HiGHS claims none."""
        self._program.allow(node.choices)
        return self._program.solve(self.adversary.budget.seconds_left)

    def separate(self, node: TreeNode, relaxed: RelaxedPlan) -> bool:
        """Use cuts that the relaxed plan violates; False when no stored, known or new outcome has one."""
        level = relaxed.level - VIOLATED * abs(relaxed.level)
        of_robot = self.task.mixed(relaxed.selection)
        values = self.pool.group_values(of_robot)
        if self._use_stored(node, relaxed.selection, values, level):
            return True
        if self._cut_known(node, of_robot, values, level):
            return True
        return self.adversary.learn_relaxed(of_robot) and self._cut_known(
            node, of_robot, self.pool.group_values(of_robot), level
        )

    def _use_stored(self, node: TreeNode, selection: FloatArray, values: FloatArray, level: float) -> bool:
        """Bring back stored cuts that the relaxed plan violates by much of what a new cut could."""
        winners = self.winners.at(node)
        lowest = float(values[winners[winners >= 0]].min(initial=np.inf))
        deepest = level - DEEP * max(level - lowest, 0.0)
        bounds = self.cuts.bounds(selection)
        usable = self.cuts.usable(winners) & (bounds < deepest)
        usable[self._program.in_use] = False
        candidates = np.flatnonzero(usable)
        for k in candidates[np.argsort(bounds[candidates], kind="stable")][:CUTS_A_ROUND].tolist():
            self.use(k)
        return len(candidates) > 0

    def _cut_known(self, node: TreeNode, of_robot: FloatArray, values: FloatArray, level: float) -> bool:
        """Add tangents at the relaxed plan for the known outcomes of smallest value below ``level``."""
        objective = self.task.objective
        teams = self.pool.outcome_values(values)
        cut_groups: set[int] = set()
        for outcome in np.argsort(teams, kind="stable").tolist():
            if teams[outcome] >= level or len(cut_groups) >= CUTS_A_ROUND:
                break
            winner = self.winners.of(node, outcome)
            if winner is None or winner in cut_groups or values[winner] >= level:
                continue
            members = list(self.pool.groups[winner])
            point = np.asarray(objective.prior_information + of_robot[members].sum(axis=0))
            for target in objective.tangent_targets(point, level, TARGETS_A_CUT):
                self.use(self.cuts.tangent(outcome, winner, point, target))
            cut_groups.add(winner)
        return bool(cut_groups)
