"""Bounds of what rounding moves: of inverses, and sizes of sums; how far matrices are from positive semidefinite."""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Sequence

    from ratt_opt._validation import FloatArray, IntArray

__all__ = [
    "MORE",
    "UNIT",
    "inverse_error",
    "is_definite",
    "largest_sizes",
    "most_of_plans",
    "negative_parts",
    "shrunk_to_semidefinite",
]

UNIT = float(np.finfo(np.float64).eps) / 2
"""Unit roundoff of float64."""
MORE = 1 + 1e-12
"""Factor on bounds for their own rounding."""


@dataclass(frozen=True, slots=True, kw_only=True)
class ShrinkParams:
    """Limit of a repair.

    ``last_digits`` : units in the last place by which an entry may shrink: a product of two rows is off by three.
        More mends what is further from semidefinite, and changes it more
    """

    last_digits: int = 8


SHRINK = ShrinkParams()


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


def is_definite(matrix: FloatArray) -> bool:
    """Decide exactly whether a symmetric (d, d) matrix is positive definite, by elimination in fractions."""
    rows = [[Fraction(x) for x in row] for row in matrix.tolist()]
    for k, pivot in enumerate(rows):
        if pivot[k] <= 0:
            return False
        for row in rows[k + 1 :]:
            factor = row[k] / pivot[k]
            row[k:] = [x - factor * p for x, p in zip(row[k:], pivot[k:], strict=True)]
    return True


def negative_parts(matrices: FloatArray) -> FloatArray:
    """(...) no eigenvalue of the symmetric (..., d, d) matrices is further below zero.

    0 if a matrix is positive semidefinite and has blocks of at most two coordinates, or eigenvalues above rounding.
    """
    linked = (matrices != 0).reshape(-1, *matrices.shape[-2:]).any(axis=0)
    worst = np.zeros(matrices.shape[:-2])
    for block in _blocks(linked):
        part = matrices[..., block[:, None], block]
        if len(block) == 1:
            found = -part[..., 0, 0]
        elif len(block) == 2:
            found = _planar_negative_part(part[..., 0, 0], part[..., 0, 1], part[..., 1, 1])
        else:
            rounding = 16 * len(block) * UNIT * np.linalg.norm(part, axis=(-2, -1))
            found = rounding - np.linalg.eigvalsh(part)[..., 0]
        worst = np.maximum(worst, found)
    return worst


def shrunk_to_semidefinite(matrices: FloatArray) -> FloatArray:
    """Symmetric (..., d, d) matrices, semidefinite in blocks of two coordinates if rounding left these indefinite.

    The entries off the diagonal are smaller by some units in the last place, in matrices where that is enough.
    """
    linked = (matrices != 0).reshape(-1, *matrices.shape[-2:]).any(axis=0)
    for i, j in (block.tolist() for block in _blocks(linked) if len(block) == 2):
        a, b, c = matrices[..., i, i], matrices[..., i, j], matrices[..., j, j]
        wrong = np.nonzero(_planar_negative_part(a, b, c) > 0)
        a, given, c = a[wrong], b[wrong], c[wrong]
        shrunk = given
        for _ in range(SHRINK.last_digits):
            shrunk = np.where(_planar_negative_part(a, shrunk, c) > 0, np.nextafter(shrunk, 0.0), shrunk)
        shrunk = np.where(_planar_negative_part(a, shrunk, c) > 0, given, shrunk)
        if len(shrunk):
            matrices = matrices.copy()
            matrices[(*wrong, i, j)] = matrices[(*wrong, j, i)] = shrunk
    return matrices


def _blocks(linked: Any) -> list[IntArray]:
    """Coordinates that are linked, directly or through others, by a (d, d) relation."""
    left, blocks = set(range(len(linked))), []
    while left:
        block, new = set[int](), {min(left)}
        while new:
            block |= new
            new = {int(k) for i in new for k in np.flatnonzero(linked[i])} - block
        left -= block
        blocks.append(np.array(sorted(block), dtype=np.int64))
    return blocks


def _planar_negative_part(a: FloatArray, b: FloatArray, c: FloatArray) -> FloatArray:
    """Bound the negative part of ``[[a, b], [b, c]]``.

    It is ``(b^2 - ac) / lambda_max``, with exact products, or the bound of Gershgorin's discs. Beside 1, the square of
    a number below ``2^-480`` may lose digits to underflow: above, its last digit of 106 bits is at least
    ``2^(2 * -480 - 106) = 2^-1066``, and float64 goes down to ``2^-1074``.
    """
    largest = np.maximum(np.maximum(np.abs(a), np.abs(c)), np.abs(b))
    exponent = np.frexp(largest)[1]
    a, b, c = (np.ldexp(x, -exponent) for x in (a, b, c))
    discs = np.abs(b) - np.minimum(a, c)
    (first, first_rest), (second, second_rest) = _exact_product(b, b), _exact_product(a, c)
    rest, rest_of_rest = _exact_difference(first_rest, second_rest)
    high, low = _exact_difference(first - second, -rest)  # the first difference is exact where it matters (Sterbenz)
    missing = high + (low + rest_of_rest)  # of the right sign: what is added is less than ``high``, if that is not 0
    by_determinant = missing / np.maximum(np.maximum(a, c), 0.25) * MORE  # if a, c >= 0, one is at least |b|
    is_exact = (a >= 0) & (c >= 0) & (np.maximum(a, c) >= 0.25) & ((b == 0) | (np.abs(b) >= 2.0**-480))
    return np.asarray(np.ldexp(np.where(is_exact, np.minimum(by_determinant, discs), discs), exponent))


def _exact_product(x: FloatArray, y: FloatArray) -> tuple[FloatArray, FloatArray]:
    """The rounded product and what it lacks."""
    product = x * y
    (x_high, x_low), (y_high, y_low) = _halves(x), _halves(y)
    rest = ((x_high * y_high - product) + x_high * y_low + x_low * y_high) + x_low * y_low
    return product, rest


def _exact_difference(x: FloatArray, y: FloatArray) -> tuple[FloatArray, FloatArray]:
    """The rounded difference and what it lacks (Knuth)."""
    difference = x - y
    back = difference - x
    return difference, (x - (difference - back)) - (y + back)


def _halves(x: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Split numbers into halves whose products are exact (Dekker 1971)."""
    big = (2.0**27 + 1) * x
    high = big - (big - x)
    return high, x - high
