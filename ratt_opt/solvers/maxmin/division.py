"""Dividing a node that cuts did not close: by which group wins an outcome, or by one robot's elements.

``mixtures.py`` says which robot's elements.
"""

from __future__ import annotations

from itertools import islice
from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.solvers.maxmin.elements import with_choice
from ratt_opt.solvers.maxmin.mixtures import divide_by_scores, divide_elements, mixing_gains, rounding_losses
from ratt_opt.solvers.maxmin.proof import Leaf, Split

if TYPE_CHECKING:
    from ratt_opt._validation import FloatArray, IntArray
    from ratt_opt.solvers.maxmin.cut_store import CutStore
    from ratt_opt.solvers.maxmin.frontier import Frontier
    from ratt_opt.solvers.maxmin.proof import TreeNode
    from ratt_opt.solvers.maxmin.relaxation import RelaxedPlan
    from ratt_opt.solvers.maxmin.winners import ClosedGroup, Winners

__all__ = ["Division", "WinnerDivision"]


class WinnerDivision:
    """Branching by winners: proofs of weak groups within a node's own choices close leaves for the frontier."""

    def __init__(self, winners: Winners, frontier: Frontier) -> None:
        self.task, self.pool, self.winners, self.frontier = winners.task, winners.pool, winners, frontier
        self._proofs = winners.proofs

    def close(self, node: TreeNode, outcome: int) -> bool:
        """Close a node by bounds on the winner of one outcome alone; False if that does not work."""
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
        """Choose an outcome of undecided winner and value below ``level``, one that the fewest groups may win."""
        values = self.pool.group_values(of_robot)
        teams = self.pool.outcome_values(values)
        rising = np.argsort(teams, kind="stable")
        low = (outcome for outcome in rising[teams[rising] < level].tolist() if self.winners.of(node, outcome) is None)
        chosen, fewest = None, np.inf
        for outcome in islice(low, self.task.params.division.compared):
            groups = sorted(self.pool.of_outcome[outcome], key=lambda g: -values[g])
            may_win = (g for g in groups if self._proofs.find(g, node.choices) is None)
            count = sum(1 for _ in islice(may_win, None if chosen is None else int(fewest)))
            if count < fewest:
                chosen, fewest = outcome, count
            if fewest <= 1:
                break
        return chosen

    def divide(self, node: TreeNode, outcome: int) -> list[TreeNode]:
        """Children in which the winner of an outcome is decided, or soon will be; those that need a search.

        Groups that a bound closes within the node's choices need none.
        """
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


class Division:
    """Branching rule of a node."""

    def __init__(self, cuts: CutStore, by_winner: WinnerDivision) -> None:
        self.task, self.pool, self.cuts = cuts.task, cuts.pool, cuts
        self.by_winner, self.frontier = by_winner, by_winner.frontier

    def children(self, node: TreeNode, relaxed: RelaxedPlan | None) -> list[TreeNode]:
        """Branch on an undecided winner that would cut the relaxed plan off, else on the most mixed robot."""
        children = self._by_rest(node, relaxed) or self._by_winner(node, relaxed) or self._by_elements(node, relaxed)
        if not node.split:
            self._settle(node)
        return children

    def _by_rest(self, node: TreeNode, relaxed: RelaxedPlan | None) -> list[TreeNode]:
        """Children in which a robot is idle or busy, if few may be busy: the one that the relaxed plan decides least.

        Who is busy comes before who wins: an attack pairs busy robots with idle ones, in any plan.
        """
        limit = self.task.problem.choice_limit
        if limit is None:
            return []
        open_robots = [i for i, c in enumerate(node.choices) if len(c) > 1 and limit.idle[i] in c]
        weights = np.full(limit.idle.shape, 0.5) if relaxed is None else relaxed.selection[limit.idle]
        i = min(open_robots, key=lambda r: abs(float(weights[r]) - 0.5), default=None)
        if i is None:
            return []
        rests = node.choices[i] == limit.idle[i]
        children = [node.child(with_choice(node.choices, i, node.choices[i][part])) for part in (rests, ~rests)]
        node.divide(i, children, self.task)
        return children

    def _by_winner(self, node: TreeNode, relaxed: RelaxedPlan | None) -> list[TreeNode]:
        """Children by the winner of an outcome; none if no undecided one would cut the relaxed plan off."""
        level = np.inf if relaxed is None else relaxed.level - 1e-9 * abs(relaxed.level)  # lower by more than rounding
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
        plan = np.array([choice[0] for choice in node.choices])
        points = self.pool.group_points(objective.information[plan])
        values, winners = objective.value(points), self.by_winner.winners.at(node)
        decided = np.flatnonzero(winners >= 0)
        if len(decided):
            outcome = int(decided[values[winners[decided]].argmin()])
            group = int(winners[outcome])
            leaf = Leaf(cuts=(self.cuts.touching(outcome, group, plan, points[group]),), weights=(1.0,))
            node.tighten(leaf, self.cuts.leaf_bound(leaf, node.choices)[0])
        self.frontier.settle(node)

    def _most_mixed(
        self, node: TreeNode, relaxed: RelaxedPlan | None, open_robots: list[int]
    ) -> tuple[int, tuple[IntArray, ...]]:
        """The robot to branch on and the parts of its elements; any robot with a choice if none is mixed."""
        if relaxed is None:
            choice = node.choices[open_robots[0]]
            return open_robots[0], (choice[:1], choice[1:])
        if self.cuts.rows is not None:
            return _least_decided(node, relaxed, open_robots)
        active = relaxed.is_active
        scores = self.cuts.scores(relaxed.cuts[active])
        losses = rounding_losses(node.choices, relaxed.selection, scores)
        i = int(losses.argmax())
        if losses[i] > self.task.params.division.flat * (node.bound - self.frontier.rule.level):
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
        worst = np.argsort(teams, kind="stable")[: self.task.params.division.short_outcomes]
        worst = worst[teams[worst] < relaxed.level]
        best = [max(self.pool.of_outcome[o], key=lambda g: values[g]) for o in worst.tolist()]
        return np.array(best, dtype=np.int64), relaxed.level - teams[worst]


def _least_decided(node: TreeNode, relaxed: RelaxedPlan, open_robots: list[int]) -> tuple[int, tuple[IntArray, ...]]:
    """The robot whose elements all have small weights, and each of its elements: rows bound those much lower."""
    i = min(open_robots, key=lambda r: float(relaxed.selection[node.choices[r]].max()))
    return i, tuple(np.split(node.choices[i], len(node.choices[i])))
