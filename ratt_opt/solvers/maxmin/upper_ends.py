"""The upper ends of a search in turns: concave relaxations, and a search in depth if robots see few targets."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.attack.team import LARGEST_DIMENSION
from ratt_opt.budget import Stop
from ratt_opt.setfunctions.criteria.logdet import LogDetObjective
from ratt_opt.setfunctions.criteria.trace import TraceObjective
from ratt_opt.solvers.maxmin.covers.search import CoverSearch
from ratt_opt.solvers.maxmin.descent import RestartedSearch
from ratt_opt.solvers.maxmin.elements import Elements
from ratt_opt.solvers.maxmin.marginal_search import MarginalSearch
from ratt_opt.solvers.maxmin.turns import TurnsUntil

if TYPE_CHECKING:
    from ratt_opt.solvers.maxmin.levels import SearchByLevels
    from ratt_opt.solvers.maxmin.proof import UpperProof
    from ratt_opt.solvers.maxmin.search import Known, Progress
    from ratt_opt.solvers.maxmin.turns import Turns

__all__ = ["UpperEnds"]

SUMS = frozenset((TraceObjective.compiled_code, LogDetObjective.compiled_code))
"""Criteria that are sums over targets."""
UNSEEN = 0.25
"""Least share of pairs of an element and a target without information for a search in depth."""
TURN, GROWTH = 20, 2.0
"""Nodes of the concave search's second turn, after its root, and how many times as many each later one has."""
NODES_IN_DEPTH = 10
"""Nodes that the search in depth has for each of the concave one's."""


class UpperEnds:
    """The smallest of all bounds, with its proof; may be interrupted at any point, as all of them may."""

    def __init__(self, known: Known, *, in_depth: bool = True) -> None:
        self.concave = RestartedSearch(known)
        self._known = known
        self._in_depth = _search_in_depth(known) if in_depth else None
        self._turn = float(TURN)

    @property
    def upper(self) -> float:
        """Proved upper bound on the optimum."""
        return min(end.upper for end in self._ends())

    def proof(self) -> UpperProof:
        """The proof of :attr:`upper`."""
        return min(self._ends(), key=lambda end: end.upper).proof()

    def run(self, turns: Turns, progress: Progress) -> Stop:
        """Search until the gap closes, the budget is spent or it is time for a proof; return why it stopped."""
        if self._in_depth is None:
            return self.concave.run(turns, progress)
        most = 1.0
        while True:
            before = turns.budget.nodes
            stop = self._run_concave(turns, progress, int(most))
            if stop is Stop.NODES and turns.budget.stop() is None:
                stop = self._in_depth.run(turns, progress, self.upper, int(NODES_IN_DEPTH * self._turn))
            if stop is not Stop.NODES or turns.budget.stop() is not None:
                return stop
            if turns.budget.nodes == before:  # all that is left is what margins for rounding leave
                return Stop.GAP
            most = self._turn
            self._turn *= GROWTH

    def _ends(self) -> list[RestartedSearch | SearchByLevels]:
        return [self.concave] if self._in_depth is None else [self.concave, self._in_depth]

    def _run_concave(self, turns: Turns, progress: Progress, nodes: int) -> Stop:
        until = turns.budget.nodes + nodes
        return self.concave.run(TurnsUntil(turns, lambda: turns.budget.nodes >= until), progress)


def _search_in_depth(known: Known) -> SearchByLevels | None:
    """The search if robots see few targets and the criterion is trace or log-det, of up to 64 dimensions."""
    objective = known.task.objective
    if objective.compiled_code not in SUMS or objective.dimension > LARGEST_DIMENSION:
        return None
    seen = np.trace(objective.information, axis1=-2, axis2=-1) > 0
    if seen.mean() > 1 - UNSEEN:
        return None
    elements = Elements(known.task.problem)
    return MarginalSearch.of(known, elements) or CoverSearch.of(known, elements)
