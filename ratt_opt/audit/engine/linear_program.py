"""Floating-point linear programs by HiGHS; nothing it says is believed before an exact check."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Sequence

    import highspy

    from ratt_opt._validation import FloatArray

__all__ = ["Program", "solve"]


@dataclass(frozen=True, slots=True, kw_only=True)
class Program:
    """Minimise ``cost @ x`` over ``row_lower <= A x <= row_upper``, ``column_lower <= x <= column_upper``.

    ``columns`` : the columns of A, each a list of (row, value).
    """

    cost: FloatArray
    columns: Sequence[Sequence[tuple[int, float]]]
    row_lower: FloatArray
    row_upper: FloatArray
    column_lower: FloatArray
    column_upper: FloatArray


def solve(program: Program, *, time_limit: float = 60.0) -> FloatArray | None:
    """Return a claimed optimal ``x`` (K,), or ``None`` where HiGHS claims none (infeasible, unbounded, out of time)."""
    import highspy

    highs = highspy.Highs()  # type: ignore[no-untyped-call]
    for name, value in (("output_flag", False), ("threads", 1), ("time_limit", time_limit), ("random_seed", 0)):
        highs.setOptionValue(name, value)
    highs.passModel(_model(program))
    highs.run()
    if highs.getModelStatus() != highspy.HighsModelStatus.kOptimal:
        return None
    return np.array(highs.getSolution().col_value, dtype=np.float64)


def _model(program: Program) -> highspy.HighsLp:
    import highspy

    lp = highspy.HighsLp()
    lp.num_col_, lp.num_row_ = len(program.cost), len(program.row_lower)
    lp.col_cost_ = program.cost
    lp.col_lower_, lp.col_upper_ = program.column_lower, program.column_upper
    lp.row_lower_, lp.row_upper_ = program.row_lower, program.row_upper
    starts = np.zeros(lp.num_col_ + 1, dtype=np.int32)
    starts[1:] = np.cumsum([len(column) for column in program.columns])
    lp.a_matrix_.format_ = highspy.MatrixFormat.kColwise
    lp.a_matrix_.start_ = starts
    lp.a_matrix_.index_ = np.array([row for column in program.columns for row, _ in column], dtype=np.int32)
    lp.a_matrix_.value_ = np.array([value for column in program.columns for _, value in column], dtype=np.float64)
    return lp
