"""Concave relaxations, tree after tree.

A tree that takes too many nodes is given up for one that begins with the outcomes, cuts and plans found by then: the
next tree meets at its root what the one before met in some deep node. Trees after the first are searched in depth:
below a node that is closed, divisions that its proof does not rely on are taken back (``frontier.py``), which saves the
siblings that were not searched yet. The tree of smallest bound is kept.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from ratt_opt.budget import Stop
from ratt_opt.solvers.maxmin.bound_stage import BoundStage, TurnShare
from ratt_opt.solvers.maxmin.concave_tree import ConcaveTree
from ratt_opt.solvers.maxmin.time_slices import TimeSlicesUntil

if TYPE_CHECKING:
    from ratt_opt.solvers.maxmin.known import Known
    from ratt_opt.solvers.maxmin.proof import UpperProof
    from ratt_opt.solvers.maxmin.time_slices import Progress, Turn

__all__ = ["ConcaveTreesStage", "RestartedSearch"]


class RestartedSearch:
    """The search of one problem by such trees; it may be interrupted at any point, as each of them may."""

    def __init__(self, known: Known) -> None:
        self._known = known
        self.first = self._best = self._current = ConcaveTree(known)
        self._params = known.task.params.restarts
        self._tree_nodes, self._until = float(self._params.later), self._params.first

    @property
    def upper(self) -> float:
        """Proved upper bound on the optimum: the smaller one of the best tree so far and of the one in work."""
        return self._lowest().upper

    def proof(self) -> UpperProof:
        """The proof of :attr:`upper`."""
        return self._lowest().proof()

    def run(self, turn: Turn) -> Stop:
        """Search until the gap closes, the turn or the budget is spent or it is time for a proof; why it stopped."""
        budget = turn.slices.budget
        until = budget.nodes + turn.nodes
        slices = TimeSlicesUntil(turn.slices, lambda: budget.nodes >= until)
        while True:
            stop = self._current.run(TimeSlicesUntil(slices, self._is_given_up), self._told(turn.progress))
            if stop is Stop.GAP:
                return stop
            if (reason := budget.stop() or slices.stop()) is not None:
                return reason
            if self._current is self.first and self._until < self._params.more and self._is_nearly_done():
                self._until = self._params.more
            else:
                self._begin_next()

    def _is_given_up(self) -> bool:
        """True if the current tree has taken too many nodes."""
        if self._known.rows_from == 0:  # rows serve all nodes, so that a new tree would meet nothing new
            return False
        return self._known.incumbent.budget.nodes >= self._until

    def _is_nearly_done(self) -> bool:
        return self.upper - self._known.incumbent.candidates.level <= self._params.nearly * abs(self.upper)

    def _lowest(self) -> ConcaveTree:
        return min(self._best, self._current, key=lambda tree: tree.upper)

    def _told(self, progress: Progress) -> Progress:
        if progress is None:
            return None
        return lambda nodes, lower, upper: progress(nodes, lower, min(upper, self._best.upper))

    def _begin_next(self) -> None:
        """Put a tree of more nodes in the place of the one in work."""
        if self._current is not self.first:
            self._tree_nodes *= self._params.growth
        self._best = self._lowest()
        self._until = self._known.incumbent.budget.nodes + int(self._tree_nodes)
        self._current = ConcaveTree(self._known, depth_first=True)


class ConcaveTreesStage(BoundStage):
    """Stage that divides nodes bounded by concave relaxations; it works for every criterion."""

    name = "concave trees"
    kind = "trees"

    def share(self, known: Known) -> TurnShare:
        """Return the nodes of the last slice; at first the root alone."""
        factor = 1 / known.task.params.depth.growth
        return TurnShare(first=factor, most=factor, at_first=1)

    def begin(self, known: Known) -> RestartedSearch:
        """Begin the first tree."""
        return RestartedSearch(known)
