"""Bounds on a level's rise over contexts of allowed options, from the cuts that were found for other contexts."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ratt_opt._blocks import blocks
from ratt_opt.curvatures.planar.level_program import MARGIN
from ratt_opt.native.library import address, checked
from ratt_opt.native.loops import loops

if TYPE_CHECKING:
    from collections.abc import Sequence

    from ratt_opt._validation import BoolArray, FloatArray, IntArray
    from ratt_opt.curvatures.planar.contexts import Options
    from ratt_opt.curvatures.planar.level_program import RelaxedContext

__all__ = ["ceilings"]


def ceilings(  # noqa: PLR0917
    options: Options,
    base: FloatArray,
    own_base: FloatArray,
    target: IntArray,
    direction: FloatArray,
    known: Sequence[RelaxedContext],
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
    found, best = np.empty((2, rows, width)), np.empty(width)
    checked("levels", levels, np.float64, (rows, count))
    checked("slopes", slopes, np.float64, (rows,))
    owned = address(checked("owners", owners, np.int64, (count,)))
    place, spare = address(checked("own", own, np.float64, (count, width))), address(best)
    for first, last in blocks(rows, own.size):
        given = owned, address(levels[first:]), address(slopes[first:]), place
        sums = address(found[0, first:]), address(found[1, first:])
        loops.sum_ceilings(last - first, count, width, *given, spare, *sums)
    return found[0], found[1]
