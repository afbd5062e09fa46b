"""The linear program of a worst-case ratio: a growing list of rows, switched on and off between nodes.

Its bounds and points are found again without rounding; nothing is claimed that was not checked exactly.
"""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from math import inf
from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.highs import LinearProgram, rows_of
from ratt_opt.worst_ratio.params import DEFAULT
from ratt_opt.worst_ratio.rationals import solve_square

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping

    from ratt_opt._validation import FloatArray
    from ratt_opt.budget import Budget
    from ratt_opt.worst_ratio.params import WorstRatioParams

    Multipliers = dict[int, Fraction]
    """Rational multipliers by row."""

__all__ = [
    "ClaimedOptimum",
    "Inequality",
    "RatioProgram",
    "basic_multipliers",
    "checked_bound",
    "proved_bound",
    "rational_points",
]  # fmt: skip


@dataclass(frozen=True, slots=True)
class Inequality:
    """``sum_j terms[j] x_j >= least``."""

    terms: Mapping[int, Fraction]
    least: Fraction = Fraction(0)


@dataclass(frozen=True, slots=True, kw_only=True)
class ClaimedOptimum:
    """Answer of HiGHS: ``x`` (columns,) and multipliers ``y`` (rows,), and its basis; not trusted.

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

    def __init__(self, n_columns: int, params: WorstRatioParams = DEFAULT) -> None:
        self.params = params
        self._program = LinearProgram(np.eye(1, n_columns)[0])
        if n_columns >= params.many_columns:
            self._program.option("solver", "ipm")
        self.rows: list[Inequality] = []
        self.on: list[bool] = []

    def add(self, rows: Iterable[Inequality]) -> list[int]:
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
        """Run HiGHS for at most that many seconds; ``None`` unless it claims an optimum.

        ``afresh`` : forget the basis of the last solve
        """
        if afresh:
            self._program.restart()
        claimed = self._program.solve(seconds)
        if not claimed.is_optimal:
            return None
        basic_columns, tight_rows = self._program.basis()
        return ClaimedOptimum(x=claimed.x, y=claimed.duals, basic_columns=basic_columns, tight_rows=tight_rows)


def proved_bound(program: RatioProgram, claimed: ClaimedOptimum, budget: Budget) -> Fraction:
    """Return a lower bound on the minimum, proved by rational multipliers; 0 (``x_0 >= 0``) if none verifies."""
    best = Fraction(0)
    for multipliers in _candidates(program, claimed, budget):
        best = max(best, checked_bound(program, multipliers) or best)
        if best > claimed.x[0] - program.params.behind:
            break
    return best


def _candidates(program: RatioProgram, claimed: ClaimedOptimum, budget: Budget) -> Iterator[Multipliers]:
    """Yield rational multipliers, cheap ones first."""
    support = [int(i) for i in np.flatnonzero(claimed.y > program.params.nonzero) if program.on[i]]
    for denominator in program.params.denominators:
        yield {i: Fraction(float(claimed.y[i])).limit_denominator(denominator) for i in support}
    if len(claimed.tight_rows) > program.params.unknowns:
        return
    yield basic_multipliers(program, claimed)
    again = program.solve(budget.seconds_left, afresh=True)
    if again is not None:
        yield basic_multipliers(program, again)


def checked_bound(program: RatioProgram, multipliers: Mapping[int, Fraction]) -> Fraction | None:
    """Weak duality: y >= 0 on rows that count, and A'y <= cost, give ``least' y <= minimum``; else ``None``."""
    reduced: dict[int, Fraction] = {}
    for i, multiplier in multipliers.items():
        if multiplier < 0 or not program.on[i]:
            return None
        for j, value in program.rows[i].terms.items():
            reduced[j] = reduced.get(j, Fraction(0)) + multiplier * value
    if any(value > (1 if j == 0 else 0) for j, value in reduced.items()):
        return None
    return sum((y * program.rows[i].least for i, y in multipliers.items()), Fraction(0))


def basic_multipliers(program: RatioProgram, claimed: ClaimedOptimum) -> Multipliers:
    """The multipliers of the basis without rounding: columns in it have reduced cost 0. Not checked here."""
    entries = ((column, row, value) for row, column, value in _basis(program, claimed))
    right = [Fraction(int(j == 0)) for j in claimed.basic_columns]
    solved = solve_square(entries, right, len(claimed.tight_rows), program.params.unknowns)
    return {i: value for i, value in zip(claimed.tight_rows, solved, strict=True) if value}


def rational_points(program: RatioProgram, claimed: ClaimedOptimum) -> Iterator[list[Fraction]]:
    """Yield rational points near a claimed optimum, simple ones first, then the basis's own. Not checked here."""
    for denominator in program.params.denominators:
        yield [Fraction(float(v)).limit_denominator(denominator) for v in claimed.x]
    right = [program.rows[i].least for i in claimed.tight_rows]
    solved = solve_square(_basis(program, claimed), right, len(claimed.basic_columns), program.params.unknowns)
    point = [Fraction(0)] * len(claimed.x)
    for j, value in zip(claimed.basic_columns, solved, strict=True):
        point[j] = value
    yield point


def _basis(program: RatioProgram, claimed: ClaimedOptimum) -> Iterator[tuple[int, int, Fraction]]:
    """Entries (row, column, value) of the basis matrix."""
    position = {j: k for k, j in enumerate(claimed.basic_columns)}
    for k, i in enumerate(claimed.tight_rows):
        for j, value in program.rows[i].terms.items():
            if j in position:
                yield k, position[j], value
