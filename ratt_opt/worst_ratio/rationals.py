"""Exact rational linear algebra, by FLINT."""

from __future__ import annotations

from fractions import Fraction
from typing import TYPE_CHECKING

import flint

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping, Sequence

__all__ = ["fraction", "rational", "solve_exactly", "solve_square"]


def rational(value: Fraction | int) -> flint.fmpq:
    """The number as flint's."""
    return flint.fmpq(value.numerator, value.denominator)


def fraction(value: flint.fmpq) -> Fraction:
    """The number as Python's."""
    return Fraction(int(value.p), int(value.q))


def solve_exactly(
    columns: Sequence[Mapping[int, Fraction]], target: Mapping[int, Fraction], *, most: int = 400
) -> list[Fraction] | None:
    """Return one rational ``x`` with ``sum_i x_i columns[i] = target``, or ``None``.

    Unknowns that the system leaves free are zero. Systems with more than ``most`` unknowns are not
    tried: 400 take 0.2 s, twice as many six times that.
    """
    if len(columns) > most:
        return None
    rows = sorted({row for column in columns for row in column} | set(target))
    index = {row: i for i, row in enumerate(rows)}
    width = len(columns) + 1
    flat = [flint.fmpq(0)] * (len(rows) * width)
    for j, column in enumerate([*columns, target]):
        for row, value in column.items():
            flat[index[row] * width + j] = rational(value)
    solution = [Fraction(0)] * len(columns)
    if not flat:
        return solution
    reduced, rank = flint.fmpq_mat(len(rows), width, flat).rref()
    for i in range(rank):
        pivot = next(j for j in range(width) if reduced[i, j] != 0)
        if pivot == width - 1:
            return None
        solution[pivot] = fraction(reduced[i, width - 1])
    return solution


def solve_square(
    entries: Iterable[tuple[int, int, Fraction]], right: Sequence[Fraction], n_unknowns: int, most: int = 1_500
) -> list[Fraction]:
    """Solve a square rational system exactly; all zero if it is singular, not square or too large.

    ``entries`` : (row, column, value); ``right`` : (rows,); ``most`` : unknowns (1,500 take a few seconds)
    """
    answer = [Fraction(0)] * n_unknowns
    if len(right) != n_unknowns or not 0 < n_unknowns <= most:
        return answer
    matrix = flint.fmpq_mat(n_unknowns, n_unknowns)
    for row, column, value in entries:
        matrix[row, column] = rational(value)
    try:
        solved = matrix.solve(flint.fmpq_mat(n_unknowns, 1, [rational(value) for value in right]))
    except ZeroDivisionError:
        return answer
    return [fraction(solved[k, 0]) for k in range(n_unknowns)]
