"""Linear and integer programs by HiGHS: one adapter, whose answers are claims.

HiGHS has returned wrong optima in several releases. Nothing it says is passed on: callers use its points and
multipliers as suggestions and derive every bound from them anew.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from math import inf
from typing import TYPE_CHECKING, Any

import numpy as np

from ratt_opt.running.interrupts import interrupts_afterwards

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import ArrayLike

    from ratt_opt._validation import FloatArray, IntArray

__all__ = ["ClaimedSolution", "LinearProgram", "Rows", "rows_of", "silent_solver"]


@dataclass(frozen=True, slots=True)
class Rows:
    """``lower <= A x <= upper`` with A by rows: row ``i`` has ``values[starts[i]:starts[i+1]]`` in those ``columns``.

    ``lower``, ``upper`` : (m,); ``starts`` : (m + 1,); ``columns``, ``values`` : (entries,)
    ``by_columns`` : A is given the other way round, ``starts`` (n + 1,) and ``columns`` the row of each entry; among
    several optima HiGHS's choice depends on the order of the entries, which it keeps in this form only
    """

    lower: FloatArray
    upper: FloatArray
    starts: IntArray
    columns: IntArray
    values: FloatArray
    by_columns: bool = False


def rows_of(entries: Sequence[tuple[Sequence[int], Sequence[float]]], lower: ArrayLike, upper: ArrayLike = inf) -> Rows:
    """Rows from (columns, values) of each; the sides are (m,) or one number for all."""
    shape = (len(entries),)
    return Rows(
        lower=np.broadcast_to(np.asarray(lower, dtype=np.float64), shape),
        upper=np.broadcast_to(np.asarray(upper, dtype=np.float64), shape),
        starts=np.cumsum([0, *(len(columns) for columns, _ in entries)]),
        columns=np.array([j for columns, _ in entries for j in columns], dtype=np.int64),
        values=np.array([v for _, values in entries for v in values], dtype=np.float64),
    )


@dataclass(frozen=True, slots=True, kw_only=True)
class ClaimedSolution:
    """Answer of HiGHS; nothing here is proved.

    ``is_optimal`` : it claims an optimum. ``x`` (columns,) and ``duals`` (rows,) : what it has; empty if nothing.
    ``bound`` : claimed bound of an integer program (minus infinity if there is none); ``nodes`` it explored.
    """

    is_optimal: bool
    x: FloatArray
    duals: FloatArray
    bound: float
    nodes: int


class LinearProgram:
    """Minimise (or maximise) ``cost . x`` over columns with bounds and a growing list of rows.

    One thread, a fixed seed, no output. Solves after the first start from the last basis.

    Parameters
    ----------
    cost, lower, upper : (n,) of the columns; the bounds may be one number for all
    rows : the first rows, if any
    integer : (n,) which columns are integer; none by default
    options : further HiGHS options, such as ``solver`` or ``presolve``
    """

    def __init__(
        self,
        cost: ArrayLike,
        lower: ArrayLike = 0.0,
        upper: ArrayLike = inf,
        *,
        rows: Rows | None = None,
        maximise: bool = False,
        integer: Sequence[bool] | None = None,
        **options: bool | float | str,
    ) -> None:
        with interrupts_afterwards():  # half imported it cannot be imported again
            import highspy

        self._highspy = highspy
        self._highs: Any = silent_solver()()
        for name, value in {"threads": 1, "random_seed": 0, **options}.items():
            self._highs.setOptionValue(name, value)
        objective = np.asarray(cost, dtype=np.float64)
        n = len(objective)
        model = highspy.HighsLp()
        model.num_col_, model.num_row_ = n, 0
        model.col_cost_ = objective
        model.col_lower_ = _bounds(lower, n)
        model.col_upper_ = _bounds(upper, n)
        if maximise:
            model.sense_ = highspy.ObjSense.kMaximize
        if rows is not None:
            model.num_row_ = len(rows.lower)
            model.row_lower_, model.row_upper_ = rows.lower, rows.upper
            order = highspy.MatrixFormat
            model.a_matrix_.format_ = order.kColwise if rows.by_columns else order.kRowwise
            model.a_matrix_.start_ = rows.starts
            model.a_matrix_.index_ = rows.columns
            model.a_matrix_.value_ = rows.values
        if integer is not None:
            kinds = (highspy.HighsVarType.kContinuous, highspy.HighsVarType.kInteger)
            model.integrality_ = [kinds[bool(whole)] for whole in integer]
        self._highs.passModel(model)
        self.n_columns, self.n_rows = n, model.num_row_

    def option(self, name: str, value: bool | float | str) -> None:
        """Set an option of HiGHS."""
        self._highs.setOptionValue(name, value)

    def add_rows(self, rows: Rows) -> None:
        """Append rows."""
        count = len(rows.lower)
        if count:
            starts, columns = rows.starts[:-1].astype(np.int32), rows.columns.astype(np.int32)
            lower, upper, values = (np.ascontiguousarray(a) for a in (rows.lower, rows.upper, rows.values))
            self._highs.addRows(count, lower, upper, len(columns), starts, columns, values)
            self.n_rows += count

    def delete_rows(self, positions: IntArray) -> None:
        """Remove the rows at these positions; later ones move up."""
        self._highs.deleteRows(len(positions), np.asarray(positions, dtype=np.int32))
        self.n_rows -= len(positions)

    def bound_row(self, row: int, lower: float, upper: float) -> None:
        """Change the sides of one row."""
        self._highs.changeRowBounds(row, lower, upper)

    def bound_column(self, column: int, lower: float, upper: float) -> None:
        """Change the bounds of one column."""
        self._highs.changeColBounds(column, lower, upper)

    def bound_columns(self, lower: FloatArray, upper: FloatArray) -> None:
        """Change the bounds of the first columns: (k,), k <= n."""
        self._highs.changeColsBounds(len(lower), np.arange(len(lower), dtype=np.int32), lower, upper)

    def change_cost(self, cost: FloatArray) -> None:
        """Change the cost of the first columns: (k,), k <= n."""
        self._highs.changeColsCost(len(cost), np.arange(len(cost), dtype=np.int32), np.ascontiguousarray(cost))

    def restart(self) -> None:
        """Forget the last basis."""
        self._highs.clearSolver()

    def solve(self, seconds: float = inf, *, is_long: bool = False) -> ClaimedSolution:
        """Run HiGHS for at most that many seconds and return what it claims.

        ``is_long`` : end it if the user interrupts, which otherwise is answered once it has run
        """
        if seconds < inf:
            # HiGHS counts the time of all its runs.
            self._highs.setOptionValue("time_limit", self._highs.getRunTime() + max(seconds, 0.0))
        if is_long:
            self._run_unless_interrupted()
        else:
            self._highs.run()
        solution, info = self._highs.getSolution(), self._highs.getInfo()
        return ClaimedSolution(
            is_optimal=self._highs.getModelStatus() == self._highspy.HighsModelStatus.kOptimal,
            x=np.array(solution.col_value, dtype=np.float64),
            duals=np.array(solution.row_dual, dtype=np.float64),
            bound=float(info.mip_dual_bound),
            nodes=int(info.mip_node_count),
        )

    def _run_unless_interrupted(self) -> None:
        """HiGHS asks between its steps whether to end; what is raised if it asks could not pass through it."""
        highs = self._highs
        asked = (highs.cbMipInterrupt, highs.cbSimplexInterrupt, highs.cbIpmInterrupt)
        with interrupts_afterwards() as met:

            def answer(event: Any) -> None:
                event.interrupt(bool(met))

            for question in asked:
                question.subscribe(answer)
            try:
                highs.run()
            finally:
                for question in asked:
                    question.unsubscribe(answer)

    def basis(self) -> tuple[tuple[int, ...], tuple[int, ...]]:
        """Columns that are basic and rows that are not (tight), after a solve."""
        basis, basic = self._highs.getBasis(), self._highspy.HighsBasisStatus.kBasic
        columns = tuple(j for j, status in enumerate(basis.col_status) if status == basic)
        return columns, tuple(i for i, status in enumerate(basis.row_status) if status != basic)


@cache
def silent_solver() -> type[Any]:
    """HiGHS without output: since 1.16 its constructor prints, before an option can be set."""
    import highspy

    class Silent(highspy.Highs):
        def enableCallbacks(self) -> None:  # noqa: N802  (called by the constructor)
            self.setOptionValue("output_flag", False)
            super().enableCallbacks()  # type: ignore[no-untyped-call]

    return Silent


def _bounds(side: ArrayLike, n: int) -> FloatArray:
    return np.broadcast_to(np.asarray(side, dtype=np.float64), (n,)).copy()
