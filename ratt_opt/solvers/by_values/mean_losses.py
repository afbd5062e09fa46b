"""Mean values of plans over all sets of robots that an attack may blind, bounded at fractional plans.

Of a plan of ``N`` robots each set of ``A`` is lost alike. The best element of a part is left with probability ``w_1``,
the second best is the best one left with ``w_2``, and so on: ``w_k = C(N - k, A - k + 1) / C(N, A)``. So the mean is a
sum of ``w_k - w_(k+1)`` times the ``k`` largest utilities, and for any level ``p`` these add up to at most ``k p`` and
the sum of ``(u_e - p)^+``. That level is best at which the shares of better elements add up to ``k``.

An attack may also blind all robots that choose in some columns, if there are at most ``B <= A`` of them, and lose
``A - B`` of the other ``N - B`` alike. If fewer than ``B`` choose there, more of the others can be blinded, so that no
plan is worth more than with ``B``: losing ``A - b`` of ``N - b`` alike hurts the more, the smaller ``b`` is.

Source: expected costs of facilities that fail (Snyder and Daskin 2005).
"""

from __future__ import annotations

from functools import cached_property
from math import comb
from typing import TYPE_CHECKING

import numpy as np

from ratt_opt._blocks import blocks

if TYPE_CHECKING:
    from ratt_opt._validation import BoolArray, FloatArray, IntArray

__all__ = ["MeanLosses"]


class MeanLosses:
    """Bounds of the mean, part by part, for sums of best elements.

    ``utility`` : (P, columns) of each column for each part, weighted
    ``lost`` : robots that an attack may blind, of ``robots``
    ``block`` : numbers computed at once
    """

    def __init__(self, utility: FloatArray, robots: int, lost: int, block: int) -> None:
        self.utility, self.lost, self._block = utility, lost, block
        self._drops = [_drops(robots - wiped, lost - wiped) for wiped in range(lost + 1)]
        self._order = np.argsort(-utility, axis=1, kind="stable")
        padded = np.zeros((utility.shape[0], utility.shape[1] + 1))
        padded[:, :-1] = np.take_along_axis(utility, self._order, axis=1)
        self._falling = padded

    def bounds(self, point: FloatArray, kept: BoolArray | None = None, wiped: int = 0) -> tuple[FloatArray, FloatArray]:
        """Constants (P,) and gains (P, columns): no plan's mean part is worth more; least at a point (columns,).

        ``kept`` : (columns,) columns whose robots are not blinded; ``wiped`` : robots that choose others, at most
        """
        share = point if kept is None else point * kept
        inside = np.cumsum(share[self._order], axis=1)
        constants, gains = np.zeros(len(inside)), np.zeros(self.utility.shape)
        for k, drop in self._drops[wiped]:
            place = (inside < k * (1 - 1e-9)).sum(axis=1)  # shares are sums of some hundred, as the solver rounds them
            level = np.take_along_axis(self._falling, place[:, None], axis=1)
            constants += drop * k * level[:, 0]
            gains += drop * np.maximum(self.utility - level, 0.0)
        slack = 1 + 8 * (self.lost + 3) * np.finfo(np.float64).eps
        return constants * slack, gains * slack if kept is None else gains * (slack * kept)

    def values(self, point: FloatArray, kept: BoolArray, wiped: IntArray) -> FloatArray:
        """(K,) the least bound of the sum at a point if the columns that are not ``kept`` (K, columns) are blinded.

        Rounded as computed: to choose by, not to claim.
        """
        used = np.flatnonzero(point > 0)
        utility = self.utility[:, used]
        order = np.argsort(-utility, axis=1, kind="stable")
        falling, found = np.take_along_axis(utility, order, axis=1), np.zeros(len(kept))
        for first, last in blocks(len(kept), order.size, self._block):
            inside = np.cumsum((kept[first:last, used] * point[used])[:, order], axis=2)
            for budget in np.unique(wiped[first:last]).tolist():
                own = np.flatnonzero(wiped[first:last] == budget)
                for k, drop in self._drops[budget]:
                    taken = np.diff(np.minimum(inside[own], k), axis=2, prepend=0.0)
                    found[first + own] += drop * np.einsum("rpc,pc->r", taken, falling)
        return found

    def nearest(self, column: int) -> IntArray:
        """(columns,) all columns, those whose utilities differ least from one column's first."""
        product = self.utility.T @ self.utility[:, column]
        return np.argsort(self._squares - 2 * product, kind="stable")

    @cached_property
    def _squares(self) -> FloatArray:
        return np.asarray((self.utility**2).sum(axis=0))


def _drops(robots: int, lost: int) -> list[tuple[int, float]]:
    """``k`` and ``w_k - w_(k+1)``, if that is more than 0."""
    last = min(lost + 1, robots)
    ways = [comb(robots - k, lost - k + 1) for k in range(1, last + 1)] + [0]
    falls = [(ways[k - 1] - ways[k]) / comb(robots, lost) for k in range(1, last + 1)]
    return [(k, fall) for k, fall in enumerate(falls, start=1) if fall > 0]
