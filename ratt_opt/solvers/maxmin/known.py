"""Shared state of every tree of a search: outcomes, plans, cuts, proofs of weak groups and tables of small ones."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.solvers.maxmin.cut_store import CutStore
from ratt_opt.solvers.maxmin.elements import Elements
from ratt_opt.solvers.maxmin.frontier import ClosingRule
from ratt_opt.solvers.maxmin.rows.separation import RowSeparation
from ratt_opt.solvers.maxmin.small_groups import SmallTables
from ratt_opt.solvers.maxmin.value_spacing import ValueSpacing
from ratt_opt.solvers.maxmin.winners import GroupProofs

if TYPE_CHECKING:
    from ratt_opt.solvers.maxmin.elements import Task
    from ratt_opt.solvers.maxmin.incumbent import Incumbent

__all__ = ["Known"]


@dataclass(frozen=True, kw_only=True, eq=False)
class Known:
    """Shared state of all trees on a problem: outcomes, plans, cuts, tables; and the rule that closes a node.

    ``rows_from`` : nodes after which cuts become rows of inequalities target by target
    """

    task: Task
    incumbent: Incumbent
    rule: ClosingRule
    cuts: CutStore
    proofs: GroupProofs
    tables: SmallTables
    rows_from: float

    @cached_property
    def elements(self) -> Elements:
        """The undominated elements, which searches in depth choose from."""
        return Elements(self.task.problem)

    @classmethod
    def of(cls, task: Task, incumbent: Incumbent, gap: float, *, by_rows: bool = True) -> Known:
        """Build the state before the first tree; ``gap`` : relative width that closes a node.

        ``by_rows`` : whether cuts may become rows of inequalities target by target, if that is worth it
        """
        rows_from = RowSeparation.first_node(task) if by_rows else np.inf
        spacing = ValueSpacing.of(task, task.params.rows.value_errors) if rows_from == 0 else None
        pool, rule = incumbent.pool, ClosingRule(incumbent.candidates, gap, spacing)
        cuts = CutStore(task, pool)
        return cls(
            task=task,
            incumbent=incumbent,
            rule=rule,
            cuts=cuts,
            proofs=GroupProofs(cuts, rule, incumbent.budget),
            tables=SmallTables(task, pool),
            rows_from=rows_from,
        )
