"""``max t - slope own - EDGE_COST (violation of the edges)`` over mixtures in highspy; its word is not trusted."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from ratt_opt._validation import FloatArray, IntArray

__all__ = ["EDGES", "LevelSolver"]

EDGES = 2
EDGE_COST = 100.0
"""Cap on the multipliers of a sector's edges."""
DUAL, PRIMAL = 1, 4
"""Simplex strategies of HiGHS: after new rows, and after a new objective."""


class LevelSolver:
    """A program that grows by cuts and is solved for one slope after another, each time from the last basis.

    Parameters
    ----------
    robot : (n,) of each option, 0 to R - 1
    own : (n,) scores of the target's own level; edges : (2, n) scores and (2,) constants of the sector's edges
    """

    def __init__(self, robot: IntArray, own: FloatArray, edges: tuple[FloatArray, FloatArray]) -> None:
        import highspy

        self._infinity = highspy.kHighsInf
        self._n, self._robots, self._cuts, self._solved = len(robot), int(robot[-1]) + 1 if len(robot) else 0, 0, False
        free, robots = self._n, self._robots
        self._own = own
        matrix = np.zeros((robots + EDGES, free + 1 + EDGES))
        matrix[robot, np.arange(free)] = 1.0
        matrix[robots:, :free] = edges[0]
        matrix[robots:, free + 1 :] = np.eye(EDGES)
        rows, columns = np.nonzero(matrix)
        model: Any = highspy.HighsLp()
        model.num_row_, model.num_col_ = matrix.shape
        model.col_cost_ = np.concatenate([np.zeros(free), [-1.0], np.full(EDGES, EDGE_COST)])
        model.col_lower_ = np.concatenate([np.zeros(free), [-self._infinity], np.zeros(EDGES)])
        model.col_upper_ = np.concatenate([np.ones(free), np.full(1 + EDGES, self._infinity)])
        model.row_lower_ = np.concatenate([np.ones(robots), -edges[1]])
        model.row_upper_ = np.concatenate([np.ones(robots), np.full(EDGES, self._infinity)])
        model.a_matrix_.format_ = highspy.MatrixFormat.kRowwise
        model.a_matrix_.start_ = np.concatenate([[0], np.cumsum(np.bincount(rows, minlength=len(matrix)))])
        model.a_matrix_.index_, model.a_matrix_.value_ = columns, matrix[rows, columns]
        self._solver: Any = highspy.Highs()  # type: ignore[no-untyped-call]
        for option, value in (("output_flag", False), ("threads", 1), ("solver", "simplex"), ("presolve", "off")):
            self._solver.setOptionValue(option, value)
        self._solver.passModel(model)

    def add(self, scores: FloatArray, constants: FloatArray) -> None:
        """Rows ``t <= constants + scores . z``: (C, n) and (C,)."""
        count, width = len(constants), self._n + 1
        values = np.concatenate([-scores, np.ones((count, 1))], axis=1)
        self._solver.addRows(
            count,
            np.full(count, -self._infinity),
            constants,
            count * width,
            (np.arange(count) * width).astype(np.int32),
            np.tile(np.arange(width), count).astype(np.int32),
            np.ascontiguousarray(values.ravel()),
        )
        self._cuts += count
        self._solver.setOptionValue("simplex_strategy", DUAL)

    def change_slope(self, slope: float) -> None:
        """Another objective."""
        columns = np.arange(self._n, dtype=np.int32)
        self._solver.changeColsCost(self._n, columns, np.ascontiguousarray(slope * self._own))
        if self._solved:
            self._solver.setOptionValue("simplex_strategy", PRIMAL)

    def solve(self) -> tuple[FloatArray, float, FloatArray]:
        """(n,) mixture, ``t`` and (2 + C,) multipliers: of the edges, capped, and of the cuts, with sum 1."""
        self._solver.run()
        self._solved = True
        solution = self._solver.getSolution()
        values, duals = np.array(solution.col_value), np.array(solution.row_dual)
        weights = np.zeros(EDGES + self._cuts)
        weights[EDGES:] = 1 / self._cuts
        if len(values) <= self._n or len(duals) != self._robots + len(weights):
            return np.zeros(self._n), -np.inf, weights
        duals = np.nan_to_num(duals, posinf=0.0, neginf=0.0)
        cuts = np.clip(-duals[self._robots + EDGES :], 0.0, None)
        if cuts.sum() > 0:
            weights[:EDGES] = np.clip(duals[self._robots : self._robots + EDGES], 0.0, EDGE_COST)
            weights[EDGES:] = cuts / cuts.sum()
        return np.clip(values[: self._n], 0.0, 1.0), float(values[self._n]), weights
