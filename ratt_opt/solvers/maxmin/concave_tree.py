"""Branch and bound over elements and winning groups, by outer approximation of concave relaxations.

At a node, tangent cuts of the groups' values and a linear program bound the relaxed plans that remain
(``relaxation.py``). Outcomes enter when a plan or a relaxed plan is attacked (``adversary.py``). An attack that leaves
several groups bounds a plan by the best of them, which is not concave: groups that never win are closed by bounds of
their own, and if that fails the node branches on which group wins (``winners.py``).
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.bounds.cuts import largest_of_each
from ratt_opt.budget import OutOfBudget, Stop
from ratt_opt.search.branch_and_bound import divide_nodes
from ratt_opt.solvers.maxmin.division import Division, WinnerDivision
from ratt_opt.solvers.maxmin.elements import with_choice
from ratt_opt.solvers.maxmin.frontier import Backjumps, Frontier
from ratt_opt.solvers.maxmin.proof import Leaf, TreeNode, upper_proof
from ratt_opt.solvers.maxmin.relaxation import CutRounds
from ratt_opt.solvers.maxmin.small_groups import SmallGroups
from ratt_opt.solvers.maxmin.winners import Winners

if TYPE_CHECKING:
    from ratt_opt._validation import FloatArray
    from ratt_opt.solvers.maxmin.frontier import OpenTreeNode
    from ratt_opt.solvers.maxmin.known import Known
    from ratt_opt.solvers.maxmin.proof import UpperProof
    from ratt_opt.solvers.maxmin.relaxation import RelaxedPlan
    from ratt_opt.solvers.maxmin.time_slices import Progress, TimeSlices

__all__ = ["ConcaveTree"]


class ConcaveTree:
    """The search of one tree; :meth:`run` may be interrupted at any point and leaves a valid bracket and proof."""

    def __init__(self, known: Known, *, depth_first: bool = False) -> None:
        self.task, self.pool = known.task, known.incumbent.pool
        self.limit = self.task.problem.choice_limit
        self.incumbent, self.rule, self.cuts = known.incumbent, known.rule, known.cuts
        self.winners = Winners(known.proofs, self.incumbent.candidates)
        self.rounds = CutRounds(self.cuts, self.winners, self.incumbent.adversary, rows_from=known.rows_from)
        self.root = self._first_node()
        self.frontier = Frontier(self.rule, self.root, depth_first=depth_first)
        self.by_winner = WinnerDivision(self.winners, self.frontier)
        self.small = SmallGroups(known.tables, self.by_winner, self.incumbent.budget)
        self.division = Division(self.cuts, self.by_winner)
        self.backjumps = Backjumps(self.frontier, self.cuts)
        self._at_first_root = self.incumbent.budget.nodes == 0

    @property
    def upper(self) -> float:
        """Proved upper bound on the optimum: the largest bound of a node, or of a group closed for all plans."""
        return max(self.frontier.bound, self.winners.finished, self.incumbent.proved.lower)

    def proof(self) -> UpperProof:
        """The proof of the bound: winners decided for all plans, then the tree."""
        return upper_proof(self.winners.above(self.root), self.pool.attack, self.cuts.record)

    def run(self, slices: TimeSlices, progress: Progress) -> Stop:
        """Search until the gap closes, the budget is spent or it is time for a proof; return why it stopped."""
        self._slices = slices

        def told() -> None:
            if progress is not None:
                progress(slices.budget.nodes, self.incumbent.proved.lower, self.upper)

        try:
            return divide_nodes(self.frontier.open, self, told) or Stop.GAP
        except OutOfBudget as out:
            return out.stop

    def stop(self) -> Stop | None:
        """Stop if every open node closes and everything that was closed still does, or it is time to."""
        if self.frontier.open.in_hand is None:
            self.backjumps.follow()
        for outcome in self.winners.reconsider():
            self.winners.reopen(outcome, self.root, self.frontier)
        if self.frontier.is_closed and not self.frontier.reopen():
            return Stop.GAP
        return self._slices.budget.stop() or self._slices.stop()

    def bound(self, queued: OpenTreeNode) -> tuple[TreeNode, RelaxedPlan | None] | None:
        """Bound a node by rounds of cuts; return it, narrowed, and its relaxed plan, if it is not closed.

        Raises
        ------
        OutOfBudget : it is time to stop; the node stays in hand with what was proved of it.
        """
        slices = self._slices
        if self.rule.closes(queued.node.bound):
            self.frontier.close(queued.node)
            return None
        slices.budget.nodes += 1
        if (node := self._narrowed(queued.node)) is None:
            return None
        nodes, stalls = slices.budget.nodes, 0
        params, rows = self.task.params.rounds, self.task.params.rows
        allowed_stalls = params.stalls_at_root if self._at_first_root else params.stalls
        hulls, before_hulls = rows.hulls_at_root if self._at_first_root else 0, np.inf
        why_stop = slices.stop_within_node if self.rounds.begins_with_rows else slices.stop
        self.rounds.begin(node)
        while True:
            relaxed = None if why_stop() else self.rounds.solve(node)
            if relaxed is None and (stop := why_stop()) is not None:
                raise OutOfBudget(stop)
            if relaxed is None:
                return node, None
            before = node.bound
            found = self._tighten(node, relaxed)
            if self.rule.closes(node.bound):
                self.frontier.close(node)
                return None
            plan = relaxed.rounded(self.task.choices, self.limit)
            if self.incumbent.offer(plan):
                self.incumbent.improve(plan)
            node = self._in_hand(self._eliminate(node, *found))
            stalls = stalls + 1 if before - node.bound < params.stall * (node.bound - self.rule.level) else 0
            stalled = not self.rounds.separate(node, relaxed) or stalls >= allowed_stalls
            least = rows.hull_least * (node.bound - self.rule.level)
            if stalled and hulls > 0 and before_hulls - node.bound >= least:
                hulls, before_hulls = hulls - 1, node.bound
                if self.rounds.sharpen(node, relaxed):
                    stalls, stalled = 0, False
            if stalled:
                if nodes & (nodes - 1) == 0:  # the first nodes, and ever fewer
                    self.incumbent.improve(plan)
                if not self.rule.closes(node.bound):
                    return node, relaxed
                self.frontier.close(node)  # by a plan found just now
                return None

    def _narrowed(self, node: TreeNode) -> TreeNode | None:
        """Narrow the node in hand by small groups; ``None`` if it is closed, or divided."""
        narrowed = self.small.narrow(node, self.rule.better) if self.rule.level > 0 else node
        if narrowed is None:
            return None
        node = self._in_hand(narrowed)
        if self.limit is None or self.limit.has_plan(node.choices):
            return node
        node.tighten(Leaf(cuts=(), weights=()), 0.0)
        self.frontier.close(node)
        return None

    def branch(self, bounded: tuple[TreeNode, RelaxedPlan | None]) -> list[OpenTreeNode]:
        """Return the children of a node."""
        self._at_first_root = False
        return [self.frontier.queued(child) for child in self.division.children(*bounded)]

    def _in_hand(self, node: TreeNode) -> TreeNode:
        """Let a narrowed node be in hand in the place of the whole one."""
        self.frontier.open.raise_bound(self.frontier.queued(node))
        return node

    def _tighten(self, node: TreeNode, relaxed: RelaxedPlan) -> tuple[Leaf, float, FloatArray]:
        """Derive the node's bound from the multipliers, keeping the old one if it is better.

        Returns the leaf of these multipliers, its bound and its combined scores (E,).
        """
        active = relaxed.is_active
        if not active.any():
            return node.leaf, *self.cuts.leaf_bound(node.leaf, node.choices)
        leaf = Leaf(cuts=tuple(relaxed.cuts[active].tolist()), weights=tuple(relaxed.duals[active].tolist()))
        bound, combined = self.cuts.leaf_bound(leaf, node.choices)
        node.tighten(leaf, bound)
        return leaf, bound, combined

    def _eliminate(self, node: TreeNode, leaf: Leaf, bound: float, combined: FloatArray) -> TreeNode:
        """Split off elements whose choice would close the node by the same multipliers; return what remains."""
        slack, everything = self.rule.missing(bound), node.choices
        largest, lowest = largest_of_each(combined, everything), -largest_of_each(-combined, everything)
        for i in np.flatnonzero(lowest - largest < slack).tolist():
            choice = node.choices[i]
            gone = combined[choice] - largest[i] < slack
            if gone.all():
                continue
            closed = node.child(with_choice(node.choices, i, choice[gone]))
            closed.leaf, closed.bound = leaf, self.cuts.leaf_bound(leaf, closed.choices)[0]
            if not self.rule.closes(closed.bound):
                continue
            rest = node.child(with_choice(node.choices, i, choice[~gone]))
            node.divide(i, [closed, rest], self.task)
            self.frontier.close(closed)
            node = rest
        return node

    def _first_node(self) -> TreeNode:
        """The root, bounded by tangent cuts of known outcomes whose winner is decided.

        They touch at the best plan; one touches where each robot has all its elements: no plan has more information, so
        there the tangent is at most what all elements are worth together.
        """
        node = TreeNode(choices=self.task.choices, winners={}, bound=np.inf, leaf=Leaf(cuts=(), weights=()))
        best, everything = self.incumbent.candidates.best, np.arange(self.task.objective.n)
        points = self.pool.group_points(self.task.objective.information[best])
        for outcome in range(len(self.pool)):
            winner = self.winners.of(node, outcome)
            if winner is None:
                continue
            touched = [(best, points[winner]), *(() if len(self.cuts) else ((everything, None),))]
            for elements, point in touched:
                k = self.cuts.touching(outcome, winner, elements, point)
                self.rounds.use(k)
                leaf = Leaf(cuts=(k,), weights=(1.0,))
                node.tighten(leaf, self.cuts.leaf_bound(leaf, node.choices)[0])
            if len(self.cuts) >= 4 * self.task.params.rounds.cuts or self.incumbent.budget.is_over:
                break
        return node
