"""A linear program in HiGHS whose answers are re-derived in rationals before anything is claimed."""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from math import inf
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping, Sequence

    from ratt_opt._validation import FloatArray

__all__ = ["MANY_COLUMNS", "ClaimedOptimum", "Program", "Row", "solve_square"]

ROUNDING = 1e-9
"""How far a proved bound may stay behind the claimed one before better rationals are tried."""

DENOMINATORS = (60, 10_000, 1_000_000)
"""Denominators tried when a float is read as a rational; whatever comes out is checked exactly."""


MANY_COLUMNS = 1000
"""From here on an interior-point method with crossover on all rows at once beats simplex on a growing list of rows."""

LARGEST_SQUARE = 1_500
"""Most unknowns of a rational system that is solved (a few seconds)."""


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


class Program:
    """Minimise ``x_0`` over ``x >= 0`` and a growing list of rows, each switched on or off.

    The only mutable object of the search: it keeps the solver's basis between the nodes.
    """

    def __init__(self, n_columns: int) -> None:
        import highspy

        self._highs: Any = highspy.Highs()  # type: ignore[no-untyped-call]
        for name, value in (("output_flag", False), ("threads", 1), ("random_seed", 0)):
            self._highs.setOptionValue(name, value)
        if n_columns >= MANY_COLUMNS:
            self._highs.setOptionValue("solver", "ipm")
        self._infinity = highspy.kHighsInf
        self._optimal = highspy.HighsModelStatus.kOptimal
        self._basic = highspy.HighsBasisStatus.kBasic
        for column in range(n_columns):
            self._highs.addCol(float(column == 0), 0.0, self._infinity, 0, [], [])
        self.rows: list[Row] = []
        self.on: list[bool] = []

    def add(self, rows: Iterable[Row]) -> list[int]:
        """Append rows, switched on, and return their indices."""
        rows = list(rows)
        first = len(self.rows)
        if rows:
            counts = [len(row.terms) for row in rows]
            starts = np.concatenate([[0], np.cumsum(counts)[:-1]]).astype(np.int32)
            index = np.array([j for row in rows for j in row.terms], dtype=np.int32)
            value = np.array([float(v) for row in rows for v in row.terms.values()])
            lower = np.array([float(row.least) for row in rows])
            upper = np.full(len(rows), self._infinity)
            self._highs.addRows(len(rows), lower, upper, len(index), starts, index, value)
        self.rows += rows
        self.on += [True] * len(rows)
        return list(range(first, len(self.rows)))

    def switch(self, index: int, *, on: bool) -> None:
        """Make row ``index`` count or not."""
        if self.on[index] != on:
            lower = float(self.rows[index].least) if on else -self._infinity
            self._highs.changeRowBounds(index, lower, self._infinity)
            self.on[index] = on

    def solve(self, time_limit: float) -> ClaimedOptimum | None:
        """Run HiGHS for at most ``time_limit`` seconds; ``None`` unless it claims an optimum."""
        self._highs.setOptionValue("time_limit", self._highs.getRunTime() + max(time_limit, 0.0))
        self._highs.run()
        if self._highs.getModelStatus() != self._optimal:
            return None
        solution, basis = self._highs.getSolution(), self._highs.getBasis()
        return ClaimedOptimum(
            x=np.array(solution.col_value),
            y=np.array(solution.row_dual),
            basic_columns=tuple(j for j, status in enumerate(basis.col_status) if status == self._basic),
            tight_rows=tuple(i for i, status in enumerate(basis.row_status) if status != self._basic),
        )

    def proved_bound(self, claimed: ClaimedOptimum) -> Fraction:
        """Return a lower bound on the minimum, proved by rational multipliers; 0 (``x_0 >= 0``) where none verifies."""
        best = Fraction(0)
        for multipliers in self._candidates(claimed):
            best = max(best, self._check_multipliers(multipliers) or best)
            if best > claimed.x[0] - ROUNDING:
                break
        return best

    def _candidates(self, claimed: ClaimedOptimum) -> Iterator[dict[int, Fraction]]:
        """Yield rational multipliers, cheap ones first."""
        for denominator in DENOMINATORS:
            yield {i: Fraction(float(claimed.y[i])).limit_denominator(denominator) for i in self._support(claimed)}
        if len(claimed.tight_rows) > LARGEST_SQUARE:
            return
        yield self._basic_multipliers(claimed)
        self._highs.clearSolver()
        again = self.solve(inf)
        if again is not None:
            yield self._basic_multipliers(again)

    def _support(self, claimed: ClaimedOptimum) -> list[int]:
        return [int(i) for i in np.flatnonzero(claimed.y > 1e-9) if self.on[i]]

    def _check_multipliers(self, multipliers: Mapping[int, Fraction]) -> Fraction | None:
        """Weak duality: y >= 0 on rows that count, and A'y <= cost, give ``least' y <= minimum``."""
        reduced: dict[int, Fraction] = {}
        for i, multiplier in multipliers.items():
            if multiplier < 0 or not self.on[i]:
                return None
            for j, value in self.rows[i].terms.items():
                reduced[j] = reduced.get(j, Fraction(0)) + multiplier * value
        if any(value > (1 if j == 0 else 0) for j, value in reduced.items()):
            return None
        return sum((y * self.rows[i].least for i, y in multipliers.items()), Fraction(0))

    def _basic_multipliers(self, claimed: ClaimedOptimum) -> dict[int, Fraction]:
        """The multipliers of the basis without rounding: columns in it have reduced cost 0."""
        entries = [(column, row, value) for row, column, value in self._basis(claimed)]
        right = [Fraction(int(j == 0)) for j in claimed.basic_columns]
        solved = solve_square(entries, right, len(claimed.tight_rows))
        return {i: value for i, value in zip(claimed.tight_rows, solved, strict=True) if value}

    def exact_point(self, claimed: ClaimedOptimum) -> list[Fraction]:
        """The point of the basis without rounding: its rows hold with equality. Not checked here."""
        right = [self.rows[i].least for i in claimed.tight_rows]
        solved = solve_square(self._basis(claimed), right, len(claimed.basic_columns))
        point = [Fraction(0)] * len(claimed.x)
        for j, value in zip(claimed.basic_columns, solved, strict=True):
            point[j] = value
        return point

    def _basis(self, claimed: ClaimedOptimum) -> list[tuple[int, int, Fraction]]:
        """Entries (row, column, value) of the basis matrix."""
        position = {j: k for k, j in enumerate(claimed.basic_columns)}
        return [
            (k, position[j], value)
            for k, i in enumerate(claimed.tight_rows)
            for j, value in self.rows[i].terms.items()
            if j in position
        ]


def solve_square(
    entries: Iterable[tuple[int, int, Fraction]], right: Sequence[Fraction], n_unknowns: int
) -> list[Fraction]:
    """Solve a square rational system exactly; all zero where it is singular, not square or too large."""
    import flint

    answer = [Fraction(0)] * n_unknowns
    if len(right) != n_unknowns or not 0 < n_unknowns <= LARGEST_SQUARE:
        return answer
    matrix, target = flint.fmpq_mat(n_unknowns, n_unknowns), flint.fmpq_mat(n_unknowns, 1)
    for row, column, value in entries:
        matrix[row, column] = flint.fmpq(value.numerator, value.denominator)
    for row, value in enumerate(right):
        target[row, 0] = flint.fmpq(value.numerator, value.denominator)
    try:
        solved = matrix.solve(target)
    except ZeroDivisionError:
        return answer
    return [Fraction(int(solved[k, 0].p), int(solved[k, 0].q)) for k in range(n_unknowns)]
