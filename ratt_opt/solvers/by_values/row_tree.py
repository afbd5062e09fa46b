"""Best plans of sums of parts and of submodular functions by branch and bound: ``part_rows.py`` bounds each node.

A node is divided into all elements of one robot. If robots may be exchanged (``region_rows.py``), it is divided by how
many of them choose elements of a region or of one column.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.budget import OutOfBudget, Stop
from ratt_opt.setfunctions.best_elements import BestElements
from ratt_opt.solvers.by_values.columns import PlanColumns
from ratt_opt.solvers.by_values.divided_plans import DividedPlans
from ratt_opt.solvers.by_values.outcome_rows import blinds_alone
from ratt_opt.solvers.by_values.part_rows import PartRows
from ratt_opt.solvers.by_values.region_rows import RegionRows

if TYPE_CHECKING:
    from ratt_opt._validation import FloatArray, IntArray
    from ratt_opt.budget import Budget
    from ratt_opt.problem import Problem
    from ratt_opt.setfunctions.decomposition import Decomposition
    from ratt_opt.solvers.by_values.columns import PlanNode
    from ratt_opt.solvers.by_values.plan_attacks import PlanAttacks
    from ratt_opt.solvers.maxmin.params import MaxMinParams

__all__ = ["RowTree"]


class RowTree(DividedPlans["PlanNode"]):
    """The nodes that are left, bounded by rows.

    ``single`` : (E,) individual values if the function is submodular
    ``known`` : what bounds all plans, and the budget of the first bounds, which raise ``OutOfBudget``
    """

    def __init__(  # noqa: PLR0917
        self,
        problem: Problem,
        parts: Decomposition,
        attacks: PlanAttacks,
        single: FloatArray | None,
        known: tuple[float, Budget],
        params: MaxMinParams,
    ) -> None:
        upper, budget = known
        self._problem, self._params = problem, params.row_tree
        f, may_merge = problem.objective, blinds_alone(problem) and not problem.threat.protected_robots
        # Elements of equal utilities may be exchanged: what they are worth depends on nothing else.
        best_elements = f if may_merge and isinstance(f, BestElements) else None
        self._columns = columns = PlanColumns(problem, parts, merges=best_elements is not None)
        self._rows: PartRows | RegionRows
        if best_elements is not None and columns.merges:
            self._rows = RegionRows(problem, best_elements, columns, attacks, params)
        else:
            self._rows = PartRows(problem, parts, columns, attacks, single, budget, params)
        super().__init__(self._columns.root(), upper, attacks)
        self._point = self._columns.middle_of(self._columns.root())

    @property
    def relies_on_caps(self) -> bool:
        """True if groups of some outcomes were left out, as they are worth no more than the best plan."""
        return self._rows.leaves_out

    def rounded(self) -> IntArray:
        """(N,) a plan near the last fractional one."""
        return self._columns.rounded(self._point)

    def _divided(self, plans: PlanNode, bound: float, budget: Budget) -> list[tuple[float, PlanNode]]:
        """Bound a node, then close or divide it; one plan is attacked."""
        bound = self._bounded(plans, bound, budget)
        if bound <= self._attacks.lower:
            return []
        children = self._rows.children(plans, self._point, bound)
        if not children:
            self._attack(plans, bound, budget)
        return [(bound, child) for child in children]

    def _bounded(self, node: PlanNode, bound: float, budget: Budget) -> float:
        """Lower the bound of the node in hand by rounds of rows."""
        params, stalls = self._params, 0
        allowed = params.at_root if node.is_first else params.elsewhere
        self._rows.begin(node, budget)
        while stalls <= allowed:
            budget.check()
            relaxed = self._rows.solve(budget)
            if relaxed is None:
                break
            self._point, before = relaxed.selection, bound
            bound = min(bound, self._rows.largest(relaxed, node))
            self._lower(bound)
            if bound <= self._attacks.lower:
                break
            if not self._rows.separate(node, relaxed.selection, relaxed.level, budget):
                break
            is_stall = before - bound < params.stall * (bound - self._attacks.lower)
            stalls = stalls + 1 if is_stall else 0
        return bound

    def _attack(self, plans: PlanNode, bound: float, budget: Budget) -> None:
        """Attack the one plan of a node to the end."""
        found = self._attacks.settle(self._columns.rounded(self._columns.middle_of(plans)), -np.inf)
        bound = min(bound, found.upper)
        if bound > self._attacks.lower and found.stop in {Stop.TIME, Stop.EVALUATIONS}:
            budget.check()
            raise OutOfBudget(found.stop)
        if bound > self._attacks.lower:
            self._settle(bound)
