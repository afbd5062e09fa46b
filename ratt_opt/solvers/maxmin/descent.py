"""Trees searched one after the other, each for plans above a floor that comes down to the best plan known.

What a tree costs depends on how far above the best plan it has to look. A floor halfway between that plan and the bound
closes most nodes at once and decides winners early: groups that could be above the plan only are left out. The outcomes
found on the way hurt the strongest plans, and the next tree meets them at its root; the one before had met
them in some deep node. It halves what is left, until the last one has no floor.

Trees after the first are searched in depth: below a node that is closed, divisions that its proof does not rely on are
taken back (``backjumps.py``), which saves the siblings that were not searched yet.

A tree with a floor proves a bound for all plans: what it closes is hardly above the floor. The tree of smallest bound
is kept as the proof. A tree that takes too many nodes is given up for one that begins with the outcomes found by then.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.budget import Stop
from ratt_opt.solvers.maxmin.search import BranchAndBound
from ratt_opt.solvers.maxmin.turns import TurnsUntil

if TYPE_CHECKING:
    from ratt_opt.solvers.maxmin.proof import UpperProof
    from ratt_opt.solvers.maxmin.search import Known, Progress
    from ratt_opt.solvers.maxmin.turns import Turns

__all__ = ["Descent"]

# Measured at 20 robots, max-eigenvalue, (0, 180), (0, 134) and (0, 156): docs/researchers/open_problems.md.
FIRST_NODES = 100
"""Nodes of the first tree, which has no floor: most searches end within. With 20, ten robots took a third longer."""
NEARLY, MORE_NODES = 5e-3, 500
"""Relative width at which that tree is nearly done, and then goes on to this many nodes: log-det, (3, 107) and (5,
107), end after 220 and 471 nodes, and not within 15 seconds if they are given up at 100."""
TREE_NODES, GROWTH = 100, 1.5
"""Nodes of a later tree before it is given up, and how many times as many the next one then has."""
SHARE = 0.5
"""Of what the bound is above the best plan, the share that a floor is above it. With 0.75 (0, 180) took longer."""
NARROW = 2e-4
"""If no larger share of the bound is left, floors save nothing."""
MOST_FLOORS = 20
"""Trees with a floor that end, at most: if the optimum is 0 the share left does not become small."""


class Descent:
    """The search of one problem by such trees; it may be interrupted at any point, as each of them may."""

    def __init__(self, known: Known) -> None:
        self._known = known
        self.first = self._best = self._current = BranchAndBound(known)
        self._tree_nodes, self._floors = float(TREE_NODES), MOST_FLOORS
        self._until = FIRST_NODES

    @property
    def upper(self) -> float:
        """Proved upper bound on the optimum: the smaller one of the best tree so far and of the one in work."""
        return min(self._best.upper, self._current.upper)

    def proof(self) -> UpperProof:
        """The proof of :attr:`upper`."""
        return self._lowest().proof()

    def run(self, turns: Turns, progress: Progress) -> Stop:
        """Search until the gap closes, the budget is spent or it is time for a proof; return why it stopped."""
        while True:
            stop = self._current.run(TurnsUntil(turns, self._is_given_up), self._told(progress))
            has_ended = stop is Stop.GAP
            if has_ended and self._known.rule.floor <= self._known.incumbent.candidates.level:
                return stop
            if (reason := turns.budget.stop() or turns.stop()) is not None:
                return reason
            if self._current is self.first and self._until < MORE_NODES and self._is_within(NEARLY) and not has_ended:
                self._until = MORE_NODES
            else:
                self._begin_next(has_ended=has_ended)

    def _is_given_up(self) -> bool:
        """Whether the tree in work has taken too many nodes."""
        return self._known.incumbent.budget.nodes >= self._until

    def _lowest(self) -> BranchAndBound:
        return min(self._best, self._current, key=lambda tree: tree.upper)

    def _told(self, progress: Progress) -> Progress:
        if progress is None:
            return None
        return lambda nodes, lower, upper: progress(nodes, lower, min(upper, self._best.upper))

    def _begin_next(self, *, has_ended: bool) -> None:
        """Put a tree in place of the one in work, lower if that one has ended, else with more nodes."""
        if has_ended:
            self._floors -= 1
        elif self._current is not self.first:
            self._tree_nodes *= GROWTH
        self._best = self._lowest()
        self._known.rule.floor = self._next_floor()
        self._until = self._known.incumbent.budget.nodes + int(self._tree_nodes)
        self._current = BranchAndBound(self._known, depth_first=True)

    def _is_within(self, width: float) -> bool:
        """Whether no larger share of the bound is left."""
        return self.upper - self._known.incumbent.candidates.level <= width * abs(self.upper)

    def _next_floor(self) -> float:
        upper, level = self._best.upper, self._known.incumbent.candidates.level
        if self._is_within(NARROW) or not np.isfinite(upper - level) or self._floors <= 0:
            return -np.inf
        return level + SHARE * (upper - level)
