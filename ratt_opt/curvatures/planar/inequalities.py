"""What inequalities between the smallest levels before, ``P``, and after, ``Q``, say about ``1/P - 1/Q``."""

from __future__ import annotations

from ctypes import c_int64, c_void_p
from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.native.library import address, checked, function

if TYPE_CHECKING:
    from collections.abc import Sequence

    from ratt_opt._validation import BoolArray, FloatArray, IntArray
    from ratt_opt.curvatures.planar.contexts import Options
    from ratt_opt.curvatures.planar.level_program import Relaxed

__all__ = ["MARGIN", "ceilings", "least_enough", "least_marginal", "most_enough", "most_marginal"]

MARGIN = 1e-12
"""Safety margin for rounding of a ceiling, relative to the sum of the absolute terms."""
TERMS = 4_000_000
"""Options times places that a call goes through: some milliseconds."""


def least_marginal(ceiling: FloatArray, added: FloatArray, slope: FloatArray, highest: float) -> FloatArray:
    """Smallest ``1/P - 1/Q`` with ``P <= highest``, ``Q >= P + added`` and ``P - slope Q <= ceiling``, elementwise.

    Along ``Q = P + added`` it falls with ``P``; along ``Q = (P - ceiling) / slope`` it is stationary where
    ``P - ceiling = sqrt(slope) P``. So it is smallest there, at the point
    at which the two lines meet, or at ``highest``.
    """
    with np.errstate(all="ignore"):
        end = np.full_like(ceiling, highest)
        places = [end, (ceiling + slope * added) / (1 - slope), ceiling / (1 - np.sqrt(slope))]
        values = []
        for p in places:
            value = 1 / p - 1 / np.maximum(p + added, (p - ceiling) / slope)
            values.append(np.where((p > 0) & (p <= highest), value, np.inf))
    return np.asarray(np.minimum.reduce(values))


def most_marginal(ceiling: FloatArray, added: FloatArray, slope: FloatArray, lowest: FloatArray) -> FloatArray:
    """Largest ``1/P - 1/Q`` with ``P >= lowest``, ``Q <= P + added`` and ``Q - slope P <= ceiling``, elementwise.

    Along ``Q = P + added`` it falls with ``P``; along ``Q = ceiling + slope P`` it is stationary where
    ``Q = sqrt(slope) P``. So it is largest there, at the point at which the two lines meet, or at ``lowest``.
    """
    with np.errstate(all="ignore"):
        places = [lowest, (added - ceiling) / (slope - 1), -ceiling / (slope - np.sqrt(slope))]
        values = []
        for p in places:
            value = 1 / p - 1 / np.maximum(np.minimum(p + added, ceiling + slope * p), p)
            values.append(np.where(p >= lowest, value, 0.0))
    return np.asarray(np.maximum.reduce(values))


def least_enough(target: float, added: float, slope: float, highest: float) -> float:
    """Largest ``ceiling`` for which :func:`least_marginal` is at least ``target > 0``.

    The pairs with a smaller marginal, ``Q < P / (1 - target P)``, lie between a line and a convex curve, so
    ``P - slope Q`` is smallest where these meet, or at ``highest``.
    """
    meet = _meet(target, added)
    if highest <= meet:
        return np.inf
    if target * highest >= 1:
        return -np.inf
    return min(meet - slope * (meet + added), highest - slope * highest / (1 - target * highest))


def most_enough(target: float, added: float, slope: float, lowest: float) -> float:
    """Largest ``ceiling`` for which :func:`most_marginal` is at most ``target > 0``.

    The pairs with a larger marginal lie above the convex curve ``Q = P / (1 - target P)``, on which ``Q - slope P``
    is smallest where ``Q = sqrt(slope) P``.
    """
    meet = _meet(target, added)
    if lowest >= meet:
        return np.inf
    p = min(max((1 - slope**-0.5) / target, lowest), meet)
    return float(p / (1 - target * p) - slope * p)


def _meet(target: float, added: float) -> float:
    """The ``P`` at which ``1/P - 1/(P + added)`` is ``target``."""
    product = target * added
    return 2 * added / (product + float(np.sqrt(product * (product + 4))))


def ceilings(  # noqa: PLR0917
    options: Options,
    base: FloatArray,
    own_base: FloatArray,
    target: IntArray,
    direction: FloatArray,
    known: Sequence[Relaxed],
    allowed: BoolArray,
) -> FloatArray:
    """(B, S) bounds on ``t - slope own`` over contexts of allowed options, from averages and slopes of ``known``.

    ``own`` is at least the form of ``target`` (S,) along ``direction`` (S, 3).
    """
    parts, owners = options.parts[allowed], options.owners[allowed]
    cuts, slope = np.stack([one.average for one in known]), np.array([one.slope for one in known])
    level = np.tensordot(cuts, parts, axes=((1, 2), (1, 2)))  # (B, K)
    start = np.tensordot(cuts, base, axes=((1, 2), (0, 1)))[:, None]
    own_start = slope[:, None] * np.einsum("ps,sp->s", own_base[:, target], direction)
    own = np.zeros((len(parts), len(target)))
    for p in range(3):
        own += np.take(parts[:, p], target, axis=1) * direction[:, p]
    best, size = _sums_of_largest(owners, level, slope, own)
    total, size = start - own_start + best, np.abs(start) + np.abs(own_start) + size
    return np.asarray(total + MARGIN * size)


def _sums_of_largest(
    owners: IntArray, levels: FloatArray, slopes: FloatArray, own: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """(B, S) sums over owners of the largest ``levels - slope own`` of their options, and of its absolute value.

    ``owners`` : (K,) ascending; ``levels`` : (B, K); ``slopes`` : (B,); ``own`` : (K, S)
    """
    (count, width), rows = own.shape, len(levels)
    call = function("sum_ceilings", None, *[c_int64] * 3, *[c_void_p] * 7)
    found, best = np.empty((2, rows, width)), np.empty(width)
    checked("levels", levels, np.float64, (rows, count))
    checked("slopes", slopes, np.float64, (rows,))
    owned = address(checked("owners", owners, np.int64, (count,)))
    place, spare = address(checked("own", own, np.float64, (count, width))), address(best)
    step = max(TERMS // max(own.size, 1), 1)
    for first in range(0, rows, step):
        some = map(address, (levels[first:], slopes[first:]))
        sums = map(address, (found[0, first:], found[1, first:]))
        call(min(step, rows - first), count, width, owned, *some, place, spare, *sums)
    return found[0], found[1]
