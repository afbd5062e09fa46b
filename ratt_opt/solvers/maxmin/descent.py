"""Branch and bound by concave relaxations, tree after tree.

A tree that takes too many nodes is given up for one that begins with the outcomes, cuts and plans found by then: the
next tree meets at its root what the one before met in some deep node. Trees after the first are searched in depth:
below a node that is closed, divisions that its proof does not rely on are taken back (``frontier.py``), which saves the
siblings that were not searched yet. The tree of smallest bound is kept as the proof.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from ratt_opt.budget import Stop
from ratt_opt.solvers.maxmin.search import BranchAndBound
from ratt_opt.solvers.maxmin.turns import TurnsUntil

if TYPE_CHECKING:
    from ratt_opt.solvers.maxmin.proof import UpperProof
    from ratt_opt.solvers.maxmin.search import Known, Progress
    from ratt_opt.solvers.maxmin.turns import Turns

__all__ = ["RestartedSearch"]

FIRST_NODES = 100
"""Nodes of the first tree: most searches end within. With 20, ten robots took a third longer."""
NEARLY, MORE_NODES = 5e-3, 500
"""Relative width at which that tree is nearly done, and then goes on to this many nodes: log-det, (3, 107) and (5,
107), end after 220 and 471 nodes, and not within 15 seconds if they are given up at 100."""
TREE_NODES, GROWTH = 100, 1.5
"""Nodes of a later tree before it is given up, and how many times as many the next one then has."""


class RestartedSearch:
    """The search of one problem by such trees; it may be interrupted at any point, as each of them may."""

    def __init__(self, known: Known) -> None:
        self._known = known
        self.first = self._best = self._current = BranchAndBound(known)
        self._tree_nodes, self._until = float(TREE_NODES), FIRST_NODES

    @property
    def upper(self) -> float:
        """Proved upper bound on the optimum: the smaller one of the best tree so far and of the one in work."""
        return self._lowest().upper

    def proof(self) -> UpperProof:
        """The proof of :attr:`upper`."""
        return self._lowest().proof()

    def run(self, turns: Turns, progress: Progress) -> Stop:
        """Search until the gap closes, the budget is spent or it is time for a proof; return why it stopped."""
        while True:
            stop = self._current.run(TurnsUntil(turns, self._is_given_up), self._told(progress))
            if stop is Stop.GAP:
                return stop
            if (reason := turns.budget.stop() or turns.stop()) is not None:
                return reason
            if self._current is self.first and self._until < MORE_NODES and self._is_nearly_done():
                self._until = MORE_NODES
            else:
                self._begin_next()

    def _is_given_up(self) -> bool:
        """Whether the tree in work has taken too many nodes."""
        return self._known.incumbent.budget.nodes >= self._until

    def _is_nearly_done(self) -> bool:
        return self.upper - self._known.incumbent.candidates.level <= NEARLY * abs(self.upper)

    def _lowest(self) -> BranchAndBound:
        return min(self._best, self._current, key=lambda tree: tree.upper)

    def _told(self, progress: Progress) -> Progress:
        if progress is None:
            return None
        return lambda nodes, lower, upper: progress(nodes, lower, min(upper, self._best.upper))

    def _begin_next(self) -> None:
        """Put a tree of more nodes in the place of the one in work."""
        if self._current is not self.first:
            self._tree_nodes *= GROWTH
        self._best = self._lowest()
        self._until = self._known.incumbent.budget.nodes + int(self._tree_nodes)
        self._current = BranchAndBound(self._known, depth_first=True)
