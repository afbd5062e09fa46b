"""The attacker's linear program in highspy, grown by columns."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from ratt_opt._validation import FloatArray, IntArray

__all__ = ["EqualityProgram"]


class EqualityProgram:
    """Minimise ``costs' s + penalties' |violation|`` subject to ``robots x + columns s + violation = right``.

    0 <= x <= 1, s >= 0; columns of s are added as needed. Whatever the solver answers is not trusted by the caller.

    Parameters
    ----------
    robots : (R, F) columns of x
    right : (R,)
    penalties : (R,) cost of violating a row by 1; infinite where that is not allowed
    """

    def __init__(self, robots: FloatArray, right: FloatArray, penalties: FloatArray) -> None:
        import highspy

        self._n_free, self._right = robots.shape[1], right
        self._infinity = highspy.kHighsInf
        soft = np.flatnonzero(np.isfinite(penalties))
        n_soft = len(soft)
        rows, columns = np.nonzero(robots.T)[::-1]
        model = highspy.HighsLp()
        model.num_col_, model.num_row_ = self._n_free + 2 * n_soft, len(right)
        model.col_cost_ = np.concatenate([np.zeros(self._n_free), penalties[soft], penalties[soft]])
        model.col_lower_ = np.zeros(model.num_col_)
        model.col_upper_ = np.concatenate([np.ones(self._n_free), np.full(2 * n_soft, self._infinity)])
        model.row_lower_ = model.row_upper_ = right
        lengths = np.concatenate([np.bincount(columns, minlength=self._n_free), np.ones(2 * n_soft, dtype=np.int64)])
        model.a_matrix_.format_ = highspy.MatrixFormat.kColwise
        model.a_matrix_.start_ = np.concatenate([[0], np.cumsum(lengths)])
        model.a_matrix_.index_ = np.concatenate([rows, soft, soft])
        model.a_matrix_.value_ = np.concatenate([robots[rows, columns], np.ones(n_soft), -np.ones(n_soft)])
        self._solver: Any = highspy.Highs()  # type: ignore[no-untyped-call]
        self._solver.setOptionValue("output_flag", False)
        self._solver.setOptionValue("threads", 1)
        self._solver.passModel(model)
        self._runs = 0

    def add(self, entries: FloatArray, first_row: IntArray, costs: FloatArray) -> None:
        """Add columns of s: column v has ``entries[v]`` (q,) in rows ``first_row[v] ...`` and a cost."""
        kept = entries != 0
        rows = (first_row[:, None] + np.arange(entries.shape[1]))[kept]
        starts = np.concatenate([[0], np.cumsum(kept.sum(axis=1))[:-1]])
        zeros, infinite = np.zeros(len(costs)), np.full(len(costs), self._infinity)
        self._solver.addCols(
            len(costs),
            costs,
            zeros,
            infinite,
            len(rows),
            starts.astype(np.int32),
            rows.astype(np.int32),
            np.ascontiguousarray(entries[kept]),
        )

    def solve(self) -> tuple[FloatArray, FloatArray, float]:
        """(F,) x, (R,) row multipliers and the value reached."""
        if self._runs:  # the last basis is feasible for the grown program
            self._solver.setOptionValue("simplex_strategy", 4)
        self._runs += 1
        self._solver.run()
        solution = self._solver.getSolution()
        fraction, duals = np.array(solution.col_value[: self._n_free]), np.array(solution.row_dual)
        if len(duals) != len(self._right) or len(fraction) != self._n_free:
            return np.full(self._n_free, self._right[-1] / self._n_free), np.zeros(len(self._right)), np.inf
        return fraction, duals, float(self._solver.getInfo().objective_function_value)
