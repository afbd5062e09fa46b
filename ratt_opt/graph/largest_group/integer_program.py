"""The smallest possible largest group by an integer program with lazy inequalities.

``x[i, j]`` says that robots i and j stay together; a link is cut when its ``x`` is 0:

    minimise n   subject to   1 + sum_j x[i, j] <= n             for every robot i
                              sum over links of (1 - x) <= alpha_c,   x = 1 on protected links
                              x[i, k] >= x[i, j] + x[j, k] - 1   for every link (i, j) and robot k

There are no group labels, so nothing to permute. Only links need integer variables: once they are
0 or 1 the last inequalities make ``x[i, k]`` at least 1 along every uncut path. They are added when
violated, first to the linear relaxation, then to the integer program.
"""

from __future__ import annotations

from math import ceil
from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.budget import OutOfBudget
from ratt_opt.graph.largest_group.counting import LargestGroup, by_counting, largest_left, split_result
from ratt_opt.highs import LinearProgram, rows_of

if TYPE_CHECKING:
    from ratt_opt._validation import FloatArray
    from ratt_opt.budget import Budget
    from ratt_opt.graph.communication import Link
    from ratt_opt.graph.threat import Threat

__all__ = ["by_integer_program"]


def by_integer_program(threat: Threat, budget: Budget, known: LargestGroup | None = None) -> LargestGroup:
    """Smallest largest group of any graph; the incumbent is recomputed on the graph, the bound from the multipliers.

    ``known`` : a bracket to start from
    """
    known = known or by_counting(threat, budget)
    best, bound, reason = known.cut, known.lower, known.reason
    claimed = bound
    try:
        budget.check()
        model = _Model(threat, budget)
        relaxed = ceil(_relax(model, budget) - 1e-6)
        if relaxed > bound:
            bound, reason = relaxed, "linear relaxation, recomputed from its multipliers"
        claimed = bound
        if bound < largest_left(threat.graph, best):
            best, claimed = _solve(model, best, bound, budget)
    except OutOfBudget:
        pass  # what is known so far
    return split_result(threat, best, bound, "milp", reason, claimed_lower=claimed, stop=budget.stop())


class _Model:
    """Rows ``lower <= row x``, each a few columns with +-1. Columns are the pairs ``i < j`` in order, then n."""

    def __init__(self, threat: Threat, budget: Budget) -> None:
        self.threat, self.budget = threat, budget
        self.links = sorted(threat.graph.links)
        n_robots = threat.graph.n_robots
        first, second = np.triu_indices(n_robots, 1)
        self.n_pairs = len(first)
        self.column = np.zeros((n_robots, n_robots), dtype=np.int64)
        self.column[first, second] = self.column[second, first] = np.arange(self.n_pairs)
        self.low = np.append(np.zeros(self.n_pairs), 1.0)
        for i, j in threat.protected_links:
            self.low[self.column[i, j]] = 1.0
        self.high = np.append(np.ones(self.n_pairs), float(n_robots))
        self.rows: list[tuple[list[int], list[float]]] = []
        self.sides: list[float] = []
        for i in range(n_robots):
            budget.check()
            others = [int(self.column[i, j]) for j in range(n_robots) if j != i]
            self._add([*others, self.n_pairs], [-1.0] * len(others) + [1.0], 1.0)
        kept = [int(self.column[i, j]) for i, j in self.links]
        self._add(kept, [1.0] * len(kept), float(len(kept) - threat.alpha_c))
        self._known: set[tuple[int, int, int]] = set()

    def _add(self, columns: list[int], values: list[float], lower: float) -> None:
        self.rows.append((columns, values))
        self.sides.append(lower)

    def add_violated(self, x: FloatArray, least: float = 1e-4, most: int = 400) -> bool:
        """Add the inequalities that ``x`` violates most; return whether there is any.

        ``least`` : violations by less are left: far above HiGHS's feasibility tolerance, so that rounds end
        ``most`` : added at once; fewer make more rounds, more make larger programs
        """
        matrix = x[self.column]
        np.fill_diagonal(matrix, 1.0)
        found = []
        for i, j in self.links:
            if self.budget.is_over:
                break
            for a, b in ((i, j), (j, i)):
                excess = x[self.column[i, j]] + matrix[b] - 1 - matrix[a]
                excess[[a, b]] = 0.0
                found += [(-float(excess[k]), a, b, int(k)) for k in np.flatnonzero(excess > least)]
        fresh = [one for one in sorted(found)[:most] if one[1:] not in self._known]
        for _, a, b, k in fresh:
            self._known.add((a, b, k))
            columns = [int(self.column[a, k]), int(self.column[a, b]), int(self.column[b, k])]
            self._add(columns, [1.0, -1.0, -1.0], -1.0)
        return bool(fresh)

    def program(self, *, integer: bool) -> LinearProgram:
        """The integer program, or its relaxation, with all rows so far."""
        whole = np.zeros(self.n_pairs + 1, dtype=np.bool_)
        whole[[self.column[link] for link in self.links]] = True
        cost, rows = np.append(np.zeros(self.n_pairs), 1.0), rows_of(self.rows, self.sides)
        return LinearProgram(cost, self.low, self.high, rows=rows, integer=whole.tolist() if integer else None)

    def proved(self, duals: FloatArray) -> float:
        """``min over the box of n + sum of duals * (lower - row x)``: below the optimum for any duals >= 0."""
        duals = np.maximum(duals, 0.0)
        reduced = np.append(np.zeros(self.n_pairs), 1.0)
        for dual, (columns, values) in zip(duals.tolist(), self.rows, strict=True):
            if dual:
                reduced[columns] -= dual * np.array(values)
        return float(duals @ np.array(self.sides) + np.minimum(reduced * self.low, reduced * self.high).sum())


def _relax(model: _Model, budget: Budget) -> float:
    """Lower bound by the linear relaxation with all inequalities violated on the way."""
    best = 1.0
    program = model.program(integer=False)
    while True:
        claim = program.solve(budget.seconds_left, is_long=True)
        if len(claim.duals) != len(model.rows) or len(claim.x) != model.n_pairs + 1:
            return best
        best = max(best, model.proved(claim.duals))
        before = len(model.rows)
        if budget.stop() is not None or not model.add_violated(claim.x):
            return best
        program.add_rows(rows_of(model.rows[before:], model.sides[before:]))


def _solve(model: _Model, best: frozenset[Link], bound: int, budget: Budget) -> tuple[frozenset[Link], int]:
    """Solve the integer program, adding violated inequalities; returns the best cut and the claimed bound."""
    threat, claimed = model.threat, bound
    while True:
        program = model.program(integer=True)
        program.option("mip_abs_gap", 0.999)  # sizes are integers
        if budget.max_nodes is not None:
            program.option("mip_max_nodes", budget.max_nodes - budget.nodes)
        claim = program.solve(budget.seconds_left, is_long=True)
        budget.nodes += claim.nodes
        if np.isfinite(claim.bound):
            claimed = max(claimed, ceil(claim.bound - 1e-6))
        if len(claim.x) != model.n_pairs + 1:
            return best, claimed
        cut = frozenset(link for link in model.links if claim.x[model.column[link]] < 0.5)
        if len(cut) <= threat.alpha_c and not cut & threat.protected_links:
            best = min(best, cut, key=lambda c: largest_left(threat.graph, c))
        if claimed >= largest_left(threat.graph, best) or budget.stop() is not None:
            return best, claimed
        if not model.add_violated(np.round(claim.x)):
            return best, claimed
