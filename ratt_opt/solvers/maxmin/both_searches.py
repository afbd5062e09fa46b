"""The two upper ends of a search in turns: concave relaxations, and covers where robots see few targets."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ratt_opt.solvers.maxmin.covers.levels import CoverSearch
from ratt_opt.solvers.maxmin.descent import Descent
from ratt_opt.solvers.maxmin.turns import TurnsUntil
from ratt_opt.stopping import Stop

if TYPE_CHECKING:
    from ratt_opt.solvers.maxmin.proof import UpperProof
    from ratt_opt.solvers.maxmin.search import Known, Progress
    from ratt_opt.solvers.maxmin.subtrees.crew import Crew
    from ratt_opt.solvers.maxmin.turns import Turns

__all__ = ["BothSearches"]

TURN, GROWTH = 20, 2.0
"""Nodes of the concave search's second turn, after its root, and how many times as many each later one has."""
COVER_NODES = 10
"""Nodes that covers have for each of the other's."""


class BothSearches:
    """The smaller of both bounds, with its proof; may be interrupted at any point, as both may."""

    def __init__(self, known: Known, crew: Crew | None, *, by_covers: bool = True) -> None:
        self.concave = Descent(known, crew)
        self._known = known
        self._covers = CoverSearch.of(known) if by_covers else None
        self._turn = float(TURN)

    @property
    def upper(self) -> float:
        """Proved upper bound on the optimum."""
        return self.concave.upper if self._covers is None else min(self.concave.upper, self._covers.upper)

    def proof(self) -> UpperProof:
        """The proof of :attr:`upper`."""
        if self._covers is None or self.concave.upper <= self._covers.upper:
            return self.concave.proof()
        return self._covers.proof()

    def run(self, turns: Turns, progress: Progress) -> Stop:
        """Search until the gap closes, the budget is spent or it is time for a proof; return why it stopped."""
        if self._covers is None:
            return self.concave.run(turns, progress)
        most = 1.0
        while True:
            stop = self._run_concave(turns, progress, int(most))
            if stop is not Stop.NODES or turns.budget.stop() is not None:
                return stop
            stop = self._covers.run(turns, progress, self.concave.upper, int(COVER_NODES * self._turn))
            if stop is not Stop.NODES or turns.budget.stop() is not None:
                return stop
            most = self._turn
            self._turn *= GROWTH

    def _run_concave(self, turns: Turns, progress: Progress, nodes: int) -> Stop:
        until = turns.budget.nodes + nodes
        return self.concave.run(TurnsUntil(turns, lambda: turns.budget.nodes >= until), progress)
