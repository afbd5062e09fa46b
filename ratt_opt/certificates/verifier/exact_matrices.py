"""Exact rational matrices for the verifier: definiteness without rounding."""

from __future__ import annotations

from functools import reduce
from typing import TYPE_CHECKING, Any

from flint import arb, fmpq, fmpq_mat, fmpz_mat

from ratt_opt.certificates.verifier.work import afford

if TYPE_CHECKING:
    from collections.abc import Iterable

__all__ = [
    "definite",
    "is_positive",
    "largest",
    "missing",
    "total",
    "trace",
]


def total(terms: Iterable[Any]) -> Any:
    """Sum that starts from the exact zero."""
    return sum(terms, fmpq(0))


def largest(values: list[Any]) -> Any:
    """The largest of exact numbers, or a ball around the largest of balls."""
    if all(isinstance(value, fmpq) for value in values):
        return max(values)
    return reduce(lambda a, b: a.max(b), map(arb, values))


def trace(a: fmpq_mat) -> Any:
    """Sum of the diagonal."""
    return total(a[i, i] for i in range(a.nrows()))


def definite(matrix: fmpq_mat) -> int:
    """Return 1 for a positive definite, 0 for a singular positive semidefinite matrix, -1 otherwise.

    The eigenvalues of a symmetric matrix are real. None of them is negative if and only if the signs of its
    characteristic polynomial's coefficients alternate, up to zeros: then it has one sign at all negative numbers.
    """
    afford(matrix)
    if matrix.nrows() == 2 and matrix[0, 0] > 0 and (minor := matrix.det()) >= 0:
        return 1 if minor > 0 else 0
    coefficients = matrix.numer_denom()[0].charpoly().coeffs()
    if any(c * (-1) ** k < 0 for k, c in enumerate(reversed(coefficients))):
        return -1
    return 1 if coefficients[0] else 0


def is_positive(matrix: fmpz_mat) -> bool:
    """Decide whether a symmetric matrix of integers is positive definite."""
    return definite(fmpq_mat(matrix)) > 0


def missing(matrix: fmpq_mat, identity: fmpq_mat) -> Any:
    """Return ``delta >= 0`` with ``matrix + delta I`` positive semidefinite; 0 if the matrix is.

    ``None`` if the matrix is further from it than rounding explains.
    """
    if definite(matrix) >= 0:
        return fmpq(0)
    enough = max(abs(x) for x in matrix.entries()) * matrix.nrows()  # by Gershgorin
    for k in range(64, 27, -1):
        if definite(matrix + identity * (delta := enough / 2**k)) >= 0:
            return delta
    return None
