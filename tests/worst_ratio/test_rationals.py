"""Rational linear systems: solved exactly, or refused."""

from fractions import Fraction

import numpy as np

from ratt_opt.worst_ratio.rationals import solve_exactly, solve_square


def test_square_systems_are_solved_exactly():
    rng = np.random.default_rng(3)
    size = 12
    matrix = rng.integers(-2, 3, (size, size)) + 5 * np.eye(size, dtype=np.int64)
    solution = [Fraction(int(a), int(b)) for a, b in rng.integers(1, 9, (size, 2))]
    entries = [(i, j, Fraction(int(matrix[i, j]))) for i in range(size) for j in range(size)]
    right = [sum((Fraction(int(matrix[i, j])) * solution[j] for j in range(size)), Fraction(0)) for i in range(size)]
    assert solve_square(entries, right, size) == solution
    assert solve_square([(0, 0, Fraction(1)), (1, 0, Fraction(1))], [Fraction(1), Fraction(2)], 2) == [0, 0]
    assert solve_square([(0, 0, Fraction(1))], [Fraction(1)], 2) == [0, 0]


def test_rectangular_systems_give_one_solution_or_none():
    one, two = Fraction(1), Fraction(2)
    columns = [{0: one}, {0: two, 1: one}, {1: two}]
    found = solve_exactly(columns, {0: Fraction(3), 1: Fraction(1, 3)})
    total = [sum(x * column.get(row, 0) for x, column in zip(found, columns, strict=True)) for row in (0, 1)]
    assert total == [3, Fraction(1, 3)]
    assert solve_exactly(columns[:1], {1: one}) is None
    assert solve_exactly([], {}) == []
