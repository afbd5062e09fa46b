"""Dividing a node that cuts did not close: by which group wins an outcome, or by one robot's elements."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.solvers.maxmin.proof import Leaf
from ratt_opt.solvers.maxmin.relaxed.mixtures import divide_by_scores, divide_elements, mixing_gains, rounding_losses
from ratt_opt.solvers.maxmin.task import with_choice

if TYPE_CHECKING:
    from ratt_opt._validation import FloatArray, IntArray
    from ratt_opt.solvers.maxmin.groups.winners import WinnerDivision
    from ratt_opt.solvers.maxmin.proof import TreeNode
    from ratt_opt.solvers.maxmin.relaxed.cut_store import CutStore
    from ratt_opt.solvers.maxmin.relaxed.node_program import RelaxedPlan

__all__ = ["NEGLIGIBLE", "Division"]

FLAT = 1e-2
"""Mixtures that cost less than this share of the gap in every cut do not explain it; known outcomes that a rounded plan
falls short in may. 0 and 0.1 take as many nodes in teams of ten."""
SHORT_OUTCOMES = 16
"""Outcomes that a rounded plan falls short in most, looked at if mixtures explain nothing. 4 and 64 take as many
nodes in teams of ten."""
NEGLIGIBLE = 1e-12
"""Multipliers below this are left out of a leaf."""
CUT_OFF = 1e-9
"""Share of the relaxed level by which an undecided winner has to be lower to be divided on."""


class Division:
    """Chooses what to divide a node by; the children go to the frontier."""

    def __init__(self, cuts: CutStore, by_winner: WinnerDivision) -> None:
        self.task, self.pool, self.cuts = cuts.task, cuts.pool, cuts
        self.by_winner, self.frontier = by_winner, by_winner.frontier

    def divide(self, node: TreeNode, relaxed: RelaxedPlan | None) -> None:
        """Branch on an undecided winner that would cut the relaxed plan off, else on the most mixed robot."""
        children = self._by_winner(node, relaxed) or self._by_elements(node, relaxed)
        if not node.split:
            self._settle(node)
        for child in children:
            self.frontier.push(child)

    def _by_winner(self, node: TreeNode, relaxed: RelaxedPlan | None) -> list[TreeNode]:
        """Children by the winner of an outcome; none if no undecided one would cut the relaxed plan off."""
        level = np.inf if relaxed is None else relaxed.level - CUT_OFF * abs(relaxed.level)
        best = self.frontier.rule.plans.best
        of_robot = self.task.objective.information[best] if relaxed is None else self.task.mixed(relaxed.selection)
        outcome = self.by_winner.undecided(node, of_robot, level)
        return [] if outcome is None else self.by_winner.divide(node, outcome)

    def _by_elements(self, node: TreeNode, relaxed: RelaxedPlan | None) -> list[TreeNode]:
        """Children by the elements of one robot; none if the node is divided already or no robot has a choice."""
        open_robots = [i for i, choice in enumerate(node.choices) if len(choice) > 1]
        if node.split or not open_robots:
            return []
        i, parts = self._most_mixed(node, relaxed, open_robots)
        children = [node.child(with_choice(node.choices, i, part)) for part in parts]
        node.divide(i, children, self.task)
        return children

    def _settle(self, node: TreeNode) -> None:
        """Finish a node of a single plan: a tangent at the plan itself is exact there."""
        objective = self.task.objective
        points = self.pool.group_points(objective.information[[choice[0] for choice in node.choices]])
        values, winners = objective.value(points), self.by_winner.winners.at(node)
        decided = np.flatnonzero(winners >= 0)
        if len(decided):
            outcome = int(decided[values[winners[decided]].argmin()])
            group = int(winners[outcome])
            leaf = Leaf(cuts=(self.cuts.tangent(outcome, group, points[group]),), weights=(1.0,))
            node.tighten(leaf, self.cuts.leaf_bound(leaf, node.choices)[0])
        self.frontier.settle(node)

    def _most_mixed(
        self, node: TreeNode, relaxed: RelaxedPlan | None, open_robots: list[int]
    ) -> tuple[int, tuple[IntArray, ...]]:
        """The robot to branch on and the parts of its elements; any robot with a choice if none is mixed."""
        if relaxed is None:
            choice = node.choices[open_robots[0]]
            return open_robots[0], (choice[:1], choice[1:])
        active = relaxed.duals > NEGLIGIBLE
        scores = self.cuts.scores(relaxed.cuts[active])
        losses = rounding_losses(node.choices, relaxed.selection, scores)
        i = int(losses.argmax())
        if losses[i] > FLAT * (node.bound - self.frontier.rule.level):
            return i, divide_by_scores(node.choices[i], relaxed.selection, scores, relaxed.duals[active])
        return self._most_gained(node, relaxed, open_robots)

    def _most_gained(
        self, node: TreeNode, relaxed: RelaxedPlan, open_robots: list[int]
    ) -> tuple[int, tuple[IntArray, ...]]:
        """The robot whose mixture gains most if the rounded plan falls short of the relaxed level."""
        objective, singles = self.task.objective, self.task.singles
        points = self.pool.group_points(self.task.mixed(relaxed.selection))
        groups, weights = self._short(node, relaxed)
        targets = [objective.tangent_targets(points[g], -np.inf, 1)[0] for g in groups.tolist()]
        inside, mix = self.pool.membership()[groups] > 0, relaxed.selection
        gains = mixing_gains(
            self.task.problem, selection=mix, inside=inside, points=points[groups], weights=weights, targets=targets
        )
        i = max(open_robots, key=lambda r: (gains[r], float(np.ptp(singles[node.choices[r]]))))
        heaviest = points[groups[int(weights.argmax())]] if len(weights) else objective.prior_information
        return i, divide_elements(objective, node.choices[i], relaxed.selection, heaviest)

    def _short(self, node: TreeNode, relaxed: RelaxedPlan) -> tuple[IntArray, FloatArray]:
        """Groups that fall short of the relaxed level once the relaxed plan is rounded, and by how much."""
        plan = relaxed.rounded(node.choices)
        values = self.pool.group_values(self.task.objective.information[plan])
        teams = self.pool.outcome_values(values)
        worst = np.argsort(teams, kind="stable")[:SHORT_OUTCOMES]
        worst = worst[teams[worst] < relaxed.level]
        best = [max(self.pool.of_outcome[o], key=lambda g: values[g]) for o in worst.tolist()]
        return np.array(best, dtype=np.int64), relaxed.level - teams[worst]
