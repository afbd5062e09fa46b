"""Best-first search over the attacks on the planner and over which groups save the optimal plan.

For a fixed attack on the planner's plan ``u`` and a fixed family of robot groups in which the optimal plan
``o`` reaches value 1, the smallest worst-case value of ``u`` is a linear program. A node without a group
for some outcome branches on that outcome's groups. Every node's bound is proved by rational multipliers.
"""

from __future__ import annotations

import heapq
import time
from dataclasses import dataclass, field
from fractions import Fraction
from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.audit.worst_ratio.program import DENOMINATORS, ROUNDING, ClaimedOptimum, Program, Row
from ratt_opt.audit.worst_ratio.witness import scaled_values
from ratt_opt.errors import ProofError

if TYPE_CHECKING:
    from collections.abc import Callable

    from ratt_opt._validation import IntArray
    from ratt_opt.audit.worst_ratio.class_rows import FunctionClass
    from ratt_opt.audit.worst_ratio.skeleton import Groups, Roles

__all__ = ["Search"]

REACHED = 1 - 1e-9


@dataclass(frozen=True, slots=True, order=True)
class _Node:
    bound: Fraction
    height: int
    """Minus the depth: among equal bounds the deepest comes first, so that an instance is found early."""
    serial: int
    attack: Groups = field(compare=False)
    saved: frozenset[int] = field(compare=False)
    """Groups, as robot masks, that must reach value 1 under the optimal plan."""


class Search:
    """Closes the bracket of one worst-case ratio.

    Parameters
    ----------
    roles : the combinatorial part
    function_class : columns and rows of the class
    accept : checks a table of integers and returns the exact ratio that it attains, or raises ``ProofError``
    floor : a proved lower bound on the ratio
    """

    def __init__(
        self, roles: Roles, function_class: FunctionClass, accept: Callable[[IntArray], Fraction], floor: Fraction
    ) -> None:
        self.roles, self.function_class, self.accept, self.floor = roles, function_class, accept, floor
        self.upper = Fraction(1)
        self.table: IntArray | None = None
        self.closed = Fraction(1)
        """Smallest bound of the nodes that were left for good."""
        self.nodes = self.programs = 0
        self.program = Program(function_class.n_columns)
        self._core = frozenset(mask for pair in roles.comparisons for mask in pair)
        column = function_class.column
        self.program.add(function_class.first_rows())
        self.program.add(Row({column(a): Fraction(1), column(b): Fraction(-1)}) for a, b in roles.comparisons)
        groups = sorted({group for outcome in roles.outcomes for group in outcome})
        hit = [Row({0: Fraction(1), column(group): Fraction(-1)}) for group in groups]
        kept = [Row({column(group << roles.n_robots): Fraction(1)}, Fraction(1)) for group in groups]
        self._hit = dict(zip(groups, self.program.add(hit), strict=True))
        self._saved = dict(zip(groups, self.program.add(kept), strict=True))

    def run(self, time_limit: float) -> bool:
        """Search for at most ``time_limit`` seconds of wall time; return whether it finished."""
        self.deadline = time.monotonic() + time_limit
        forced = frozenset(outcome[0] for outcome in self.roles.outcomes if len(outcome) == 1)
        self.open = [_Node(self.floor, 0, k, attack, forced) for k, attack in enumerate(self.roles.attacks)]
        self._seen = {(node.attack, node.saved) for node in self.open}
        while self.open and self.open[0].bound < self.upper:
            if not self._expand(self.open[0]):
                return False
        return True

    @property
    def lower(self) -> Fraction:
        """Proved lower bound on the ratio, at any time."""
        waiting = self.open[0].bound if self.open else Fraction(1)
        return max(self.floor, min(self.closed, waiting, self.upper))

    def _expand(self, node: _Node) -> bool:
        """Solve the first open node and replace it by its children; ``False`` when time is up."""
        claimed = self._solve(node)
        if claimed is None:
            return False
        bound = max(node.bound, self.program.proved_bound(claimed))
        self.nodes += 1
        heapq.heappop(self.open)
        if bound >= self.upper:
            return True
        missed = self._missed_outcome(node, claimed)
        if missed is None:
            self._record(node, claimed)
            self.closed = min(self.closed, max(bound, self.floor))
            return True
        for group in missed:
            # A group that contains one known to reach 1 reaches 1: only the smallest are kept.
            saved = frozenset(s for s in node.saved if s & group != group) | {group}
            if (node.attack, saved) not in self._seen:
                self._seen.add((node.attack, saved))
                heapq.heappush(self.open, _Node(bound, node.height - 1, len(self._seen), node.attack, saved))
        return True

    def _used(self, node: _Node) -> frozenset[int]:
        return self._core | set(node.attack) | {group << self.roles.n_robots for group in node.saved}

    def _solve(self, node: _Node) -> ClaimedOptimum | None:
        """Solve the node's program, adding class rows until none is violated."""
        for group, row in self._hit.items():
            self.program.switch(row, on=group in node.attack)
        for group, row in self._saved.items():
            self.program.switch(row, on=group in node.saved)
        used = sorted(self._used(node))
        while True:
            claimed = self.program.solve(self.deadline - time.monotonic())
            self.programs += 1
            if claimed is None:
                return None
            rows = self.function_class.violated(claimed.x, used)
            if not rows:
                return claimed
            self.program.add(rows)

    def _missed_outcome(self, node: _Node, claimed: ClaimedOptimum) -> Groups | None:
        """Outcome in which no group of the optimal plan reaches 1, the fewest groups first."""
        shift = self.roles.n_robots
        groups = sorted(self._saved)
        values = self.function_class.optimal_values(
            claimed.x, sorted(self._used(node)), [group << shift for group in groups]
        )
        reached = {group for group, value in zip(groups, values, strict=True) if value >= REACHED}
        missed = [outcome for outcome in self.roles.outcomes if not reached.intersection(outcome)]
        return min(missed, key=len) if missed else None

    def _record(self, node: _Node, claimed: ClaimedOptimum) -> None:
        """Turn a solution into a rational instance; keep it when its exact ratio is the smallest so far."""
        used = sorted(self._used(node))
        for attempt in range(len(DENOMINATORS) + 1):
            if attempt < len(DENOMINATORS):
                point = [Fraction(float(v)).limit_denominator(DENOMINATORS[attempt]) for v in claimed.x]
            else:
                point = self.program.exact_point(claimed)
            table = scaled_values(self.function_class.table(point, used))
            if table is None or not np.any(table):
                continue
            try:
                ratio = self.accept(table)
            except ProofError:
                continue
            if ratio < self.upper:
                self.upper, self.table = ratio, table
            if ratio < claimed.x[0] + ROUNDING:
                return
