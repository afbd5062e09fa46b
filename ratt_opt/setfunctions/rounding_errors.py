"""Bounds of what rounding moves: of inverses, and sizes of sums."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Sequence

    from ratt_opt._validation import FloatArray, IntArray

__all__ = ["MORE", "UNIT", "inverse_error", "largest_sizes", "most_of_plans"]

UNIT = float(np.finfo(np.float64).eps) / 2
"""Unit roundoff of float64."""
MORE = 1 + 1e-12
"""Factor on bounds for their own rounding."""


def largest_sizes(information: FloatArray, choices: Sequence[IntArray]) -> FloatArray:
    """(M,) the largest sums of the sizes of a plan's elements, of (E, M, d, d) ``information``."""
    return most_of_plans(np.linalg.norm(information, axis=(-2, -1)) * MORE, choices)


def most_of_plans(sizes: FloatArray, choices: Sequence[IntArray]) -> FloatArray:
    """(M,) the largest sums over a plan's elements of (E, M) ``sizes``."""
    return np.asarray(np.sum([sizes[choice].max(axis=0) for choice in choices], axis=0))


def inverse_error(matrices: FloatArray, inverses: FloatArray) -> FloatArray:
    """(M,) bounds of ``|Y - A^{-1}|`` for (M, d, d) matrices ``A`` and computed inverses ``Y``.

    With ``R = 1 - A Y``, ``Y - A^{-1} = -Y R (1 - R)^{-1}``; ``Y R`` is computed in integers, hence exactly.
    """
    (a, of_a), (y, of_y) = _integers(matrices), _integers(inverses)
    one = np.eye(a.shape[-1], dtype=np.int64).astype(object) << -(of_a + of_y)  # A Y is about 1, of many more digits
    rest = one - a @ y
    size = _norms(rest, of_a + of_y)
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.where(size < 1, _norms(y @ rest, of_a + 2 * of_y) * MORE / (1 - size), np.inf)


def _integers(matrices: FloatArray) -> tuple[Any, int]:
    """The matrices as integers times a power of two, exactly: an object array and the exponent."""
    digits, exponents = np.frexp(matrices)
    exponents = np.where(matrices == 0, exponents.max(), exponents)
    lowest = int(exponents.min())
    shifts = (exponents - lowest).astype(object)
    return (digits * 2.0**53).astype(np.int64).astype(object) << shifts, lowest - 53


def _norms(integers: Any, exponent: int) -> FloatArray:
    """Frobenius' norms of integer matrices times a power of two, rounded up."""
    largest = max(abs(x) for x in integers.ravel())
    excess = max(0, largest.bit_length() - 64)
    mantissas = (np.abs(integers) >> excess).astype(np.float64) + (1.0 if excess else 0.0)
    return np.asarray(np.linalg.norm(np.ldexp(mantissas, excess + exponent), axis=(-2, -1)) * MORE)
