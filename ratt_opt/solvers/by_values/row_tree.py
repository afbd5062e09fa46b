"""Best plans of sums of parts and of submodular functions by branch and bound: ``part_rows.py`` bounds each node.

A node is divided into all elements of one robot. If robots may be exchanged, it is divided by how many of them choose
elements of one column: first into plans in which no two do, and those in which some two share a column.
"""

from __future__ import annotations

from dataclasses import dataclass
from heapq import heappop, heappush
from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.budget import OutOfBudget, Stop
from ratt_opt.solvers.by_values.part_rows import PartRows

if TYPE_CHECKING:
    from ratt_opt._validation import FloatArray, IntArray
    from ratt_opt.budget import Budget
    from ratt_opt.problem import Problem
    from ratt_opt.setfunctions.decomposition import Decomposition
    from ratt_opt.solvers.by_values.columns import PlanNode
    from ratt_opt.solvers.by_values.plan_attacks import PlanAttacks

__all__ = ["RowTree", "RowTreeParams"]


@dataclass(frozen=True, slots=True, kw_only=True)
class RowTreeParams:
    """Effort of one node; more of each gives fewer nodes for more time.

    ``stall`` : share of what is open at a node that a round has to close; ``at_root``, ``elsewhere`` : rounds that
        close less after which the node is divided
    """

    stall: float = 0.03
    at_root: int = 12
    elsewhere: int = 2


class RowTree:
    """The nodes that are left; valid at any moment.

    ``single`` : (E,) individual values if the function is submodular
    ``known`` : what bounds all plans, and the budget of the first bounds, which raise ``OutOfBudget``
    """

    def __init__(
        self,
        problem: Problem,
        parts: Decomposition,
        attacks: PlanAttacks,
        single: FloatArray | None,
        known: tuple[float, Budget],
    ) -> None:
        upper, budget = known
        self._problem, self._attacks, self._params = problem, attacks, RowTreeParams()
        self._rows = PartRows(problem, parts, attacks, single, budget)
        self._columns = self._rows.columns
        self._open: list[tuple[float, int, PlanNode]] = [(-upper, 0, self._columns.root())]
        self._count, self._settled, self._hand = 0, -np.inf, -np.inf
        self._point = self._columns.middle_of(self._columns.root())

    @property
    def upper(self) -> float:
        """No plan is worth more, unless it is worth no more than the best plan known."""
        return max(self.bound, self._attacks.lower)

    @property
    def bound(self) -> float:
        """The bound of the rows themselves: less than the best plan's worst case only if a property is not kept."""
        return max(self._settled, self._hand, -self._open[0][0] if self._open else -np.inf)

    @property
    def relies_on_caps(self) -> bool:
        """True if groups of some outcomes were left out, as they are worth no more than the best plan."""
        return self._rows.leaves_out

    @property
    def is_finished(self) -> bool:
        """True if dividing can prove no more."""
        return not self._open or self._settled >= -self._open[0][0]

    @property
    def is_at_root(self) -> bool:
        """True if nothing is divided yet."""
        return self._count == 0 and bool(self._open)

    def rounded(self) -> IntArray:
        """(N,) a plan near the last fractional one."""
        return self._columns.rounded(self._point)

    def divide(self, budget: Budget) -> None:
        """Bound the node of the largest bound, then close or divide it; raises ``OutOfBudget``."""
        bound, number, node = self._open[0]
        self._hand, left = -bound, [node]  # in hand before it is nowhere else
        heappop(self._open)
        try:
            if self._hand > self._attacks.lower:
                budget.nodes += 1
                self._lower_hand(node, budget)
            left = [] if self._hand <= self._attacks.lower else self._divided(node, self._hand, budget)
        finally:
            for one in left:
                self._count += int(one is not node)
                heappush(self._open, (-self._hand, number if one is node else self._count, one))
            self._hand = -np.inf

    def _lower_hand(self, node: PlanNode, budget: Budget) -> None:
        """Lower the bound of the node in hand by rounds of rows."""
        params, stalls = self._params, 0
        allowed = params.at_root if node.is_first else params.elsewhere
        self._rows.begin(node, budget)
        while stalls <= allowed:
            budget.check()
            relaxed = self._rows.solve(budget)
            if relaxed is None:
                break
            self._point, before = relaxed.selection, self._hand
            self._hand = min(self._hand, self._rows.largest(relaxed, node))
            if self._hand <= self._attacks.lower:
                break
            if not self._rows.separate(node, relaxed.selection, relaxed.level, budget):
                break
            is_stall = before - self._hand < params.stall * (self._hand - self._attacks.lower)
            stalls = stalls + 1 if is_stall else 0

    def _divided(self, node: PlanNode, best: float, budget: Budget) -> list[PlanNode]:
        """The parts of a node; none if it is one plan, which is attacked."""
        children = self._columns.children(node, self._point, apart=self._problem.threat.n_blinded > 0)
        if children:
            return children
        found = self._attacks.settle(self._columns.rounded(self._columns.middle_of(node)), -np.inf)
        best = min(best, found.upper)
        if best > self._attacks.lower and found.stop in {Stop.TIME, Stop.EVALUATIONS}:
            budget.check()
            raise OutOfBudget(found.stop)
        if best > self._attacks.lower:
            self._settled = max(self._settled, best)
        return []
