"""Rounds of cuts: solve a node's linear program, cut its relaxed plan off, solve again."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.solvers.maxmin.relaxed.node_program import NodeProgram

if TYPE_CHECKING:
    from ratt_opt._validation import FloatArray
    from ratt_opt.solvers.maxmin.groups.winners import Winners
    from ratt_opt.solvers.maxmin.plans.adversary import Adversary
    from ratt_opt.solvers.maxmin.proof import TreeNode
    from ratt_opt.solvers.maxmin.relaxed.cut_store import CutStore
    from ratt_opt.solvers.maxmin.relaxed.node_program import RelaxedPlan

__all__ = ["CUTS_A_ROUND", "CutRounds"]


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
    """The cuts in use at a node: usable ones that were stored, and tangents if its relaxed plan violates none."""

    def __init__(self, cuts: CutStore, winners: Winners, adversary: Adversary) -> None:
        self.task, self.pool = cuts.task, cuts.pool
        self.cuts, self.winners, self.adversary = cuts, winners, adversary
        self._program = NodeProgram(self.task.objective.n, self.task.choices)

    def use(self, k: int) -> None:
        """Bring cut ``k`` into the program."""
        self._program.use(k, float(self.cuts.constants[k]), self.cuts.scores(k))

    def begin(self, node: TreeNode) -> None:
        """Leave out what is not usable at a node; give it a cut on every decided outcome if it has none."""
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
        """The relaxed plan of a node under the cuts in use, or ``None`` if HiGHS claims none."""
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
