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

from dataclasses import dataclass, field
from math import ceil
from time import monotonic
from typing import TYPE_CHECKING, Any

import numpy as np

from ratt_opt.graph.largest_group import LargestGroup, counting_bound, heuristic_cut, largest_left

if TYPE_CHECKING:
    from ratt_opt._validation import FloatArray
    from ratt_opt.graph.communication import Link
    from ratt_opt.graph.threat import Threat

__all__ = ["by_milp"]

VIOLATION = 1e-4
LARGEST_ROUND = 400
"""Inequalities added per round, the most violated first."""


def by_milp(threat: Threat, time_limit: float | None, max_nodes: int | None) -> LargestGroup:
    """Smallest largest group of any graph; the incumbent is recomputed on the graph, the bound from the multipliers."""
    deadline = np.inf if time_limit is None else monotonic() + time_limit
    program = _Program(threat)
    best = heuristic_cut(threat)
    bound, reason = counting_bound(threat), "the links left do not fit into smaller groups"
    relaxed = ceil(program.relax(deadline) - 1e-6)
    if relaxed > bound:
        bound, reason = relaxed, "linear relaxation, recomputed from its multipliers"
    claimed = bound
    if bound < largest_left(threat.graph, best):
        best, claimed = program.solve(best, bound, deadline, max_nodes)
    upper = largest_left(threat.graph, best)
    assert len(best) <= threat.alpha_c, "an incumbent is within its budget"
    claimed = max(bound, min(claimed, upper))
    return LargestGroup(lower=bound, upper=upper, cut=best, method="milp", reason=reason, claimed_lower=claimed)


@dataclass(slots=True)
class _Rows:
    """``lower <= row x``, each row a few columns with +-1."""

    columns: list[list[int]] = field(default_factory=list)
    values: list[list[float]] = field(default_factory=list)
    lower: list[float] = field(default_factory=list)

    def add(self, columns: list[int], values: list[float], lower: float) -> None:
        self.columns.append(columns)
        self.values.append(values)
        self.lower.append(lower)


class _Program:
    """Columns are the pairs ``i < j`` in order, then n."""

    def __init__(self, threat: Threat) -> None:
        self.threat = threat
        self.n_robots = threat.graph.n_robots
        self.links = sorted(threat.graph.links)
        upper = np.triu_indices(self.n_robots, 1)
        self.column = np.zeros((self.n_robots, self.n_robots), dtype=np.int64)
        self.column[upper] = np.arange(len(upper[0]))
        self.column += self.column.T
        self.n_pairs = len(upper[0])
        self.low = np.zeros(self.n_pairs + 1)
        for i, j in threat.protected_links:
            self.low[self.column[i, j]] = 1.0
        self.low[-1] = 1.0
        self.high = np.append(np.ones(self.n_pairs), float(self.n_robots))
        self.rows = _Rows()
        for i in range(self.n_robots):
            others = [int(self.column[i, j]) for j in range(self.n_robots) if j != i]
            self.rows.add([*others, self.n_pairs], [-1.0] * len(others) + [1.0], 1.0)
        kept = [int(self.column[i, j]) for i, j in self.links]
        self.rows.add(kept, [1.0] * len(kept), float(len(kept) - threat.alpha_c))
        self.known: set[tuple[int, int, int]] = set()

    def _violated(self, x: FloatArray) -> int:
        """Add the most violated inequalities; returns how many."""
        matrix = x[self.column]
        np.fill_diagonal(matrix, 1.0)
        found = []
        for i, j in self.links:
            for a, b in ((i, j), (j, i)):
                excess = x[self.column[i, j]] + matrix[b] - 1 - matrix[a]
                excess[[a, b]] = 0.0
                found += [(-float(excess[k]), a, b, int(k)) for k in np.flatnonzero(excess > VIOLATION)]
        fresh = [one for one in sorted(found)[:LARGEST_ROUND] if one[1:] not in self.known]
        for _, a, b, k in fresh:
            self.known.add((a, b, k))
            columns = [int(self.column[a, k]), int(self.column[a, b]), int(self.column[b, k])]
            self.rows.add(columns, [1.0, -1.0, -1.0], -1.0)
        return len(fresh)

    def _model(self, *, integer: bool) -> Any:
        import highspy

        solver: Any = highspy.Highs()  # type: ignore[no-untyped-call]
        solver.setOptionValue("output_flag", False)
        solver.setOptionValue("threads", 1)
        model = highspy.HighsLp()
        model.num_col_, model.num_row_ = self.n_pairs + 1, len(self.rows.lower)
        model.col_cost_ = np.append(np.zeros(self.n_pairs), 1.0)
        model.col_lower_, model.col_upper_ = self.low, self.high
        model.row_lower_ = np.array(self.rows.lower)
        model.row_upper_ = np.full(len(self.rows.lower), highspy.kHighsInf)
        model.a_matrix_.format_ = highspy.MatrixFormat.kRowwise
        model.a_matrix_.start_ = np.cumsum([0, *map(len, self.rows.columns)])
        model.a_matrix_.index_ = np.array([c for row in self.rows.columns for c in row], dtype=np.int32)
        model.a_matrix_.value_ = np.array([v for row in self.rows.values for v in row])
        if integer:
            kinds = [highspy.HighsVarType.kContinuous] * (self.n_pairs + 1)
            for i, j in self.links:
                kinds[self.column[i, j]] = highspy.HighsVarType.kInteger
            model.integrality_ = kinds
        solver.passModel(model)
        return solver

    def relax(self, deadline: float) -> float:
        """Lower bound by the linear relaxation with all inequalities violated on the way."""
        best = 1.0
        while True:
            solver = self._model(integer=False)
            if deadline < np.inf:
                solver.setOptionValue("time_limit", max(deadline - monotonic(), 0.0))
            solver.run()
            solution = solver.getSolution()
            x, duals = np.array(solution.col_value), np.array(solution.row_dual)
            if len(duals) != len(self.rows.lower) or len(x) != self.n_pairs + 1:
                return best
            best = max(best, self._dual_bound(duals))
            if monotonic() >= deadline or not self._violated(x):
                return best

    def _dual_bound(self, duals: FloatArray) -> float:
        """``min over the box of n + sum of duals * (lower - row x)``: below the optimum for any duals >= 0."""
        duals = np.maximum(duals, 0.0)
        reduced = np.append(np.zeros(self.n_pairs), 1.0)
        for dual, columns, values in zip(duals.tolist(), self.rows.columns, self.rows.values, strict=True):
            if dual:
                reduced[columns] -= dual * np.array(values)
        return float(duals @ np.array(self.rows.lower) + np.minimum(reduced * self.low, reduced * self.high).sum())

    def solve(
        self, best: frozenset[Link], bound: int, deadline: float, max_nodes: int | None
    ) -> tuple[frozenset[Link], int]:
        """Solve the integer program, adding violated inequalities; returns the best cut and the claimed bound."""
        claimed = bound
        while True:
            solver = self._model(integer=True)
            solver.setOptionValue("mip_abs_gap", 0.999)  # sizes are integers
            if max_nodes is not None:
                solver.setOptionValue("mip_max_nodes", max_nodes)
            if deadline < np.inf:
                solver.setOptionValue("time_limit", max(deadline - monotonic(), 0.0))
            solver.run()
            claim = solver.getInfo().mip_dual_bound
            if np.isfinite(claim):
                claimed = max(claimed, ceil(claim - 1e-6))
            x = np.array(solver.getSolution().col_value)
            if len(x) != self.n_pairs + 1:
                return best, claimed
            cut = frozenset(link for link in self.links if x[self.column[link]] < 0.5)
            if len(cut) <= self.threat.alpha_c and not cut & self.threat.protected_links:
                best = min(best, cut, key=lambda c: largest_left(self.threat.graph, c))
            if monotonic() >= deadline or claimed >= largest_left(self.threat.graph, best):
                return best, claimed
            if max_nodes is not None and solver.getInfo().mip_node_count >= max_nodes:
                return best, claimed
            if not self._violated(np.round(x)):
                return best, claimed
