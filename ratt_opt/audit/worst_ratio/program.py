"""The linear program of a worst-case ratio: a growing list of rows, switched on and off between nodes."""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from math import inf
from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.highs import LinearProgram, rows_of

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping

    from ratt_opt._validation import FloatArray

__all__ = ["MANY_COLUMNS", "ClaimedOptimum", "RatioProgram", "Row"]

MANY_COLUMNS = 1000
"""From here on an interior-point method with crossover on all rows at once beats simplex on a growing list of rows."""


@dataclass(frozen=True, slots=True)
class Row:
    """``sum_j terms[j] x_j >= least``."""

    terms: Mapping[int, Fraction]
    least: Fraction = Fraction(0)


@dataclass(frozen=True, slots=True, kw_only=True)
class ClaimedOptimum:
    """What HiGHS returned: ``x`` (columns,) and multipliers ``y`` (rows,), and its basis; not trusted.

    ``basic_columns``, ``tight_rows`` : columns that are basic and rows that are not, equally many.
    """

    x: FloatArray
    y: FloatArray
    basic_columns: tuple[int, ...]
    tight_rows: tuple[int, ...]


class RatioProgram:
    """Minimise ``x_0`` over ``x >= 0`` and a growing list of rows, each switched on or off.

    The only mutable object of the search beside its queue: it keeps the solver's basis between the nodes.
    """

    def __init__(self, n_columns: int) -> None:
        self._program = LinearProgram(np.eye(1, n_columns)[0])
        if n_columns >= MANY_COLUMNS:
            self._program.option("solver", "ipm")
        self.rows: list[Row] = []
        self.on: list[bool] = []

    def add(self, rows: Iterable[Row]) -> list[int]:
        """Append rows, switched on, and return their indices."""
        rows = list(rows)
        first = len(self.rows)
        entries = [(list(row.terms), [float(value) for value in row.terms.values()]) for row in rows]
        self._program.add_rows(rows_of(entries, [float(row.least) for row in rows]))
        self.rows += rows
        self.on += [True] * len(rows)
        return list(range(first, len(self.rows)))

    def switch(self, index: int, *, on: bool) -> None:
        """Make row ``index`` count or not."""
        if self.on[index] != on:
            self._program.bound_row(index, float(self.rows[index].least) if on else -inf, inf)
            self.on[index] = on

    def solve(self, seconds: float, *, afresh: bool = False) -> ClaimedOptimum | None:
        """Run HiGHS for at most so many seconds; ``None`` unless it claims an optimum.

        ``afresh`` : forget the basis of the last solve
        """
        if afresh:
            self._program.restart()
        claimed = self._program.solve(seconds)
        if not claimed.is_optimal:
            return None
        basic_columns, tight_rows = self._program.basis()
        return ClaimedOptimum(x=claimed.x, y=claimed.duals, basic_columns=basic_columns, tight_rows=tight_rows)
