"""The attacker's linear program in highspy."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from ratt_opt._validation import FloatArray, IntArray

__all__ = ["solve_equality_form"]


def solve_equality_form(
    robots: FloatArray, shares: FloatArray, first_row: IntArray, costs: FloatArray, right: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Minimise ``costs' s`` subject to ``robots x + (shares placed at their rows) s = right``, 0 <= x <= 1, s >= 0.

    Parameters
    ----------
    robots : (R, F) columns of x
    shares : (V, q) column v of s has these entries in rows ``first_row[v] ...``
    right : (R,)

    Returns
    -------
    (F,) x and (R,) row multipliers; whatever the solver reached, not trusted by the caller
    """
    import highspy

    n_rows, n_free = robots.shape
    model = highspy.HighsLp()
    model.num_col_, model.num_row_ = n_free + len(costs), n_rows
    model.col_cost_ = np.concatenate([np.zeros(n_free), costs])
    model.col_lower_ = np.zeros(model.num_col_)
    model.col_upper_ = np.concatenate([np.ones(n_free), np.full(len(costs), highspy.kHighsInf)])
    model.row_lower_ = model.row_upper_ = right
    rows, columns = np.nonzero(robots.T)[::-1]
    wide = first_row[:, None] + np.arange(shares.shape[1])
    kept = shares != 0
    lengths = np.concatenate([np.bincount(columns, minlength=n_free), kept.sum(axis=1)])
    model.a_matrix_.format_ = highspy.MatrixFormat.kColwise
    model.a_matrix_.start_ = np.concatenate([[0], np.cumsum(lengths)])
    model.a_matrix_.index_ = np.concatenate([rows, wide[kept]])
    model.a_matrix_.value_ = np.concatenate([robots[rows, columns], shares[kept]])
    solver: Any = highspy.Highs()  # type: ignore[no-untyped-call]
    solver.setOptionValue("output_flag", False)
    solver.setOptionValue("threads", 1)
    solver.passModel(model)
    solver.run()
    solution = solver.getSolution()
    fraction, duals = np.array(solution.col_value[:n_free]), np.array(solution.row_dual)
    if len(duals) != n_rows or len(fraction) != n_free:
        return np.full(n_free, right[-1] / n_free), np.zeros(n_rows)
    return fraction, duals
