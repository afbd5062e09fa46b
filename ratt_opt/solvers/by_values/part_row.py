"""One row of modular bounds, and the one that multipliers combine several to."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from ratt_opt.bounds.cuts import ROUNDING

if TYPE_CHECKING:
    from ratt_opt._validation import FloatArray
    from ratt_opt.solvers.by_values.columns import CountedRegion

__all__ = ["NUMBER", "SUM", "CombinedRow", "PartRow", "combine", "down_to_multiple"]

SUM, WHOLE, NUMBER = -1, -2, -3
"""Numbers in the place of a part's: of the row that adds up the values of all parts, of rows that bound the sum, and of
rows that state how many robots choose in a region."""


class PartRow(NamedTuple):
    """``value <= constant + sum of scores``, if no more robots than they say choose in the ``regions``.

    ``scores`` : of the elements, or of the columns; ``part`` : whose value it bounds in the mean of all losses, or
        ``SUM``, ``WHOLE``, or ``NUMBER`` if ``0`` takes the place of the value
    """

    constant: float
    scores: FloatArray
    regions: tuple[CountedRegion, ...] = ()
    part: int = WHOLE


class CombinedRow(NamedTuple):
    """``value <= constant + sum of scores``; ``size`` : of the constants that were added up."""

    constant: float
    scores: FloatArray
    size: float


def combine(rows: list[PartRow], duals: FloatArray, n_parts: int = 0) -> CombinedRow | None:
    """Combine rows in proportion to some duals; ``None`` if these bound nothing.

    Multipliers of each part add up to that of the sum; that one and those of whole rows add up to 1. Numbers of robots
    may have any.
    """
    part = np.array([row.part for row in rows], dtype=np.int64)
    added = float(duals[part == SUM].sum())
    whole = added + float(duals[part == WHOLE].sum())
    if whole <= 0:
        return None
    weights, own = duals / whole, part >= 0
    weights[own] = 0.0
    if added > 0:
        total = np.bincount(part[own], duals[own], n_parts)
        if (total <= 0).any():
            return None
        weights[own] = duals[own] / total[part[own]] * (added / whole)
    constants = np.array([row.constant for row in rows])
    scores = np.asarray(weights @ np.array([row.scores for row in rows]))
    return CombinedRow(float(weights @ constants), scores, float(np.abs(weights * constants).sum()))


def down_to_multiple(bound: float, spacing: float) -> float:
    """The largest value that is at most a bound, if all are multiples of a spacing that is not 0."""
    if spacing <= 0 or not np.isfinite(bound):
        return bound
    return spacing * float(np.floor(bound / spacing * (1 + ROUNDING)))
