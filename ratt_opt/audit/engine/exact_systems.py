"""Exact solutions of sparse rational linear systems, given which unknowns may be non-zero."""

from __future__ import annotations

from fractions import Fraction
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

__all__ = ["solve_exactly"]

LARGEST_SYSTEM = 400


def solve_exactly(columns: Sequence[Mapping[int, Fraction]], target: Mapping[int, Fraction]) -> list[Fraction] | None:
    """Return one rational ``x`` with ``sum_i x_i columns[i] = target``, or ``None``.

    Unknowns that the system leaves free are zero. Systems with more than 400 unknowns are not tried.
    """
    import flint

    if len(columns) > LARGEST_SYSTEM:
        return None
    rows = sorted({row for column in columns for row in column} | set(target))
    index = {row: i for i, row in enumerate(rows)}
    width = len(columns) + 1
    flat = [flint.fmpq(0)] * (len(rows) * width)
    for j, column in enumerate([*columns, target]):
        for row, value in column.items():
            flat[index[row] * width + j] = flint.fmpq(value.numerator, value.denominator)
    if not flat:
        return [Fraction(0)] * len(columns)
    reduced, rank = flint.fmpq_mat(len(rows), width, flat).rref()
    solution = [Fraction(0)] * len(columns)
    for i in range(rank):
        pivot = next(j for j in range(width) if reduced[i, j] != 0)
        if pivot == width - 1:
            return None
        entry = reduced[i, width - 1]
        solution[pivot] = Fraction(int(entry.p), int(entry.q))
    return solution
