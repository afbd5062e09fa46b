"""Dominated elements are dropped: another one of the same robot tells at least as much, by a proof in exact arithmetic.

Information of two rows differs by ``[[a, b], [b, c]]``, positive semidefinite if ``a >= 0``, ``c >= 0`` and
``a c >= b^2``. The difference of two floats has the exact difference's sign, and is off by one rounding; so are both
products by three roundings more. If ``a c`` and ``b^2`` are farther apart than that, floats decide and
are right; if they are not, fractions do.
"""

from __future__ import annotations

from fractions import Fraction
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from ratt_opt._validation import BoolArray, FloatArray, IntArray

__all__ = ["undominated"]

ROUNDINGS = 5 * np.finfo(np.float64).eps
"""More than eight roundings of half of that: two differences and a product on either side, and the comparison's own."""
SMALLEST = 2.0**60 * np.finfo(np.float64).tiny
"""Products below this lose digits (they are subnormal, or nearly)."""
FIRST = 4
"""Rows whose diagonals are compared first: they refute most pairs."""
NO, OPEN, YES = range(3)


def undominated(information: FloatArray, owner: IntArray) -> tuple[IntArray, dict[int, int]]:
    """Drop dominated elements; no plan loses value by that.

    Element ``e`` is dominated by ``f`` if ``information[f] - information[e]`` is positive semidefinite for every
    target and step: criteria do not decrease, so ``f`` in the place of ``e`` keeps any plan's value under any
    attack. Of equal elements the first stays. Semidefiniteness is decided exactly, on the floats as they are.

    Parameters
    ----------
    information : (E, M, H, 2, 2) about the positions, step by step
    owner : (E,)

    Returns
    -------
    the elements kept, ascending, and for each dropped one the kept one that dominates it
    """
    by: dict[int, int] = {}
    entries = np.stack([information[..., 0, 0], information[..., 0, 1], information[..., 1, 1]], axis=-1)
    entries = np.ascontiguousarray(entries.reshape(len(owner), -1, 3))
    for robot in np.unique(owner):
        own = np.flatnonzero(owner == robot)
        found = _compared(entries[own])
        for f in range(len(own)):
            if int(own[f]) in by:
                continue
            for e in np.flatnonzero(found[f]):
                pair = int(own[e]), int(own[f])
                if pair[0] not in by and (found[f, e] == YES or _dominates(entries[pair[1]], entries[pair[0]])):
                    by[pair[0]] = pair[1]
    kept = np.array([e for e in range(len(owner)) if e not in by], dtype=np.int64)
    # A dominating element may have been dropped later: by transitivity, its own dominator takes its place.
    return kept, {e: _last(by, f) for e, f in by.items()}


def _compared(entries: FloatArray) -> NDArray[np.int8]:
    """(K, K) whether the first of a pair dominates the second, as far as floats tell; of equal ones the first does."""
    found = np.full((len(entries),) * 2, NO, dtype=np.int8)
    diagonals = entries[:, :FIRST, ::2]
    for f in range(len(entries)):
        some = np.flatnonzero((diagonals[f] >= diagonals).all(axis=(1, 2)))
        some = some[some != f]
        found[f, some] = _compared_with(entries[f], entries[some], some < f)
    return found


def _compared_with(more: FloatArray, less: FloatArray, comes_first: BoolArray) -> NDArray[np.int64]:
    """(L,) the same of one element, (rows, 3), and others, (L, rows, 3)."""
    a, b, c = np.moveaxis(more - less, -1, 0)
    product, square = a * c, b * b
    is_large = square > SMALLEST
    is_refuted = (a < 0) | (c < 0) | ((product < square * (1 - ROUNDINGS)) & is_large)
    is_open = (b != 0) & ~((product > square * (1 + ROUNDINGS)) & is_large)
    is_same = (more == less).all(axis=(1, 2))
    found = np.where(is_open.any(axis=1), OPEN, YES)
    found[is_refuted.any(axis=1) | (is_same & comes_first)] = NO
    return found


def _dominates(more: FloatArray, less: FloatArray) -> bool:
    """Decide one pair exactly: (K, 3) entries."""
    for row, other in zip(more.tolist(), less.tolist(), strict=True):
        a, b, c = (Fraction(x) - Fraction(y) for x, y in zip(row, other, strict=True))
        if a < 0 or c < 0 or a * c < b * b:
            return False
    return True


def _last(by: dict[int, int], element: int) -> int:
    while element in by:
        element = by[element]
    return element
