"""Rows of the linear program of a tree by values: those in use, and the bound that multipliers combine them to."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.bounds.cuts import ROUNDING
from ratt_opt.solvers.by_values.part_row import combine, down_to_multiple

if TYPE_CHECKING:
    from ratt_opt._validation import FloatArray
    from ratt_opt.budget import Budget
    from ratt_opt.solvers.by_values.columns import PlanColumns, PlanNode
    from ratt_opt.solvers.by_values.part_row import PartRow
    from ratt_opt.solvers.maxmin.params import MaxMinParams
    from ratt_opt.solvers.maxmin.relaxation import NodeProgram, RelaxedPlan

__all__ = ["KeptRows"]


class KeptRows:
    """Rows bound the plans of any node; ``columns`` are those of the linear program, ``n_levels`` parts have levels."""

    def __init__(
        self, columns: PlanColumns, program: NodeProgram, spacing: float, params: MaxMinParams, n_levels: int = 0
    ) -> None:
        self.columns, self._program, self._spacing, self._n_levels = columns, program, spacing, n_levels
        self._params, self._of_pool = params.part_rows, params.rows
        self._rows: dict[int, PartRow] = {}
        self._made = 0
        self._mean = np.zeros(len(columns.kinds))

    def _use(self, row: PartRow, scores: FloatArray, level: int | None = None) -> None:
        """Add one row to the program: ``scores`` of its columns, and the ``level`` that it bounds if not the sum."""
        self._program.use(self._made, row.constant, scores, level)
        self._rows[self._made] = row
        self._made += 1

    def _keep_those_in_use(self) -> None:
        self._rows = {k: self._rows[k] for k in self._program.in_use}

    def solve(self, budget: Budget) -> RelaxedPlan | None:
        """The fractional plan (columns,) of the node, or ``None`` if HiGHS claims none."""
        return self._program.solve(budget.seconds_left)

    def largest(self, relaxed: RelaxedPlan, node: PlanNode) -> float:
        """The largest value of the rows combined by the multipliers, over the plans of a node."""
        active = np.flatnonzero(relaxed.duals > 0)
        rows = [self._rows[k] for k in relaxed.cuts[active].tolist()]
        combined = combine(rows, relaxed.duals[active], self._n_levels)
        if combined is None:
            return np.inf
        gains = self.columns.largest(combined.scores, node)
        bound = combined.constant + gains + ROUNDING * (combined.size + abs(gains))
        return down_to_multiple(bound, self._spacing)

    def _inward(self, node: PlanNode, point: FloatArray) -> FloatArray:
        """(columns,) a plan between a fractional one and a mean of earlier ones: rows taken there need fewer rounds."""
        params = self._of_pool
        self._mean = self.columns.within(self._mean, node, point)
        self._mean = (1 - params.newest) * self._mean + params.newest * point
        return (1 - params.inward) * point + params.inward * self._mean
