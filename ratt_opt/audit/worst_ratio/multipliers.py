"""Bounds and points of a ratio's linear program without rounding; nothing is claimed that was not checked exactly."""

from __future__ import annotations

from fractions import Fraction
from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.audit.engine.rationals import LARGEST_SQUARE, solve_square

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

    from ratt_opt.audit.worst_ratio.program import ClaimedOptimum, RatioProgram
    from ratt_opt.budget import Budget

    Multipliers = dict[int, Fraction]
    """Rational multipliers by row."""

__all__ = ["BEHIND", "DENOMINATORS", "basic_multipliers", "checked_bound", "exact_point", "proved_bound"]

BEHIND = 1e-9
"""How far a proved bound may stay behind the claimed one before better rationals are tried."""
DENOMINATORS = (60, 10_000, 1_000_000)
"""Denominators tried when a float is read as a rational; whatever comes out is checked exactly."""
NONZERO = 1e-9
"""Multipliers below this are the solver's rounding of zero."""


def proved_bound(program: RatioProgram, claimed: ClaimedOptimum, budget: Budget) -> Fraction:
    """Return a lower bound on the minimum, proved by rational multipliers; 0 (``x_0 >= 0``) where none verifies."""
    best = Fraction(0)
    for multipliers in _candidates(program, claimed, budget):
        best = max(best, checked_bound(program, multipliers) or best)
        if best > claimed.x[0] - BEHIND:
            break
    return best


def _candidates(program: RatioProgram, claimed: ClaimedOptimum, budget: Budget) -> Iterator[Multipliers]:
    """Yield rational multipliers, cheap ones first."""
    support = [int(i) for i in np.flatnonzero(claimed.y > NONZERO) if program.on[i]]
    for denominator in DENOMINATORS:
        yield {i: Fraction(float(claimed.y[i])).limit_denominator(denominator) for i in support}
    if len(claimed.tight_rows) > LARGEST_SQUARE:
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
    solved = solve_square(entries, right, len(claimed.tight_rows))
    return {i: value for i, value in zip(claimed.tight_rows, solved, strict=True) if value}


def exact_point(program: RatioProgram, claimed: ClaimedOptimum) -> list[Fraction]:
    """The point of the basis without rounding: its rows hold with equality. Not checked here."""
    right = [program.rows[i].least for i in claimed.tight_rows]
    solved = solve_square(_basis(program, claimed), right, len(claimed.basic_columns))
    point = [Fraction(0)] * len(claimed.x)
    for j, value in zip(claimed.basic_columns, solved, strict=True):
        point[j] = value
    return point


def _basis(program: RatioProgram, claimed: ClaimedOptimum) -> Iterator[tuple[int, int, Fraction]]:
    """Entries (row, column, value) of the basis matrix."""
    position = {j: k for k, j in enumerate(claimed.basic_columns)}
    for k, i in enumerate(claimed.tight_rows):
        for j, value in program.rows[i].terms.items():
            if j in position:
                yield k, position[j], value
