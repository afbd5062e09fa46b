"""Regions of the contexts of one element, and what is proved about its max-eigenvalue marginal in each.

With levels as in ``criteria/maxeig.py``, ``P`` the smallest level of a context and ``Q`` the smallest once
``x`` is added, the marginal is ``1/P - 1/Q``. A region is: the target ``j`` that is the worst one (after ``x`` is added
for the smallest marginal, before for the largest), the sector its weakest direction lies in, and the options each
other owner has left. With ``d`` the least (most) that ``x`` adds to ``j`` along a direction of the sector:

- smallest: ``Q >= P + d`` as ``P`` is at most ``j``'s form before ``x``; and ``P - s Q <= V`` for any ``s > 0``.
- largest: ``Q <= P + d``, and ``Q - s P <= V``.

``V`` comes from :mod:`ratt_opt.curvatures.planar.level_program`. The averages of cuts that gave one region its ``V``
also bound every other region, of any element.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.curvatures.marginals import MARGIN
from ratt_opt.curvatures.planar.ceilings import ceilings
from ratt_opt.curvatures.planar.contexts import levels
from ratt_opt.curvatures.planar.inequalities import least_enough, least_marginal, most_enough, most_marginal
from ratt_opt.curvatures.planar.level_program import Sector, own_direction

if TYPE_CHECKING:
    from collections.abc import Sequence

    from ratt_opt._validation import BoolArray, FloatArray, IntArray
    from ratt_opt.curvatures.planar.contexts import Options
    from ratt_opt.curvatures.planar.level_program import RelaxedContext

__all__ = ["MarginalSide", "Region"]


@dataclass(slots=True, eq=False)
class Region:
    """``key`` : its bound, negated for the largest marginal; sector ``low`` to ``high`` off the target's reference.

    ``added`` : ``d`` above. ``slope``, ``start`` : what to start from: the slope, and the average (3, M) of cuts, that
    bounded the region so far. ``relaxed`` : what the linear program said, once there was one.
    """

    key: float
    target: int
    low: float
    high: float
    added: float
    allowed: BoolArray
    slope: float
    start: FloatArray | None = None
    relaxed: RelaxedContext | None = None


class MarginalSide:
    """One element and which of its marginals is bounded: the smallest, or the largest.

    ``prior``, ``added`` : (3, M) parts; ``highest`` : proved upper bound on the smallest level of any context;
    ``rounding`` : of a marginal, in its own unit
    """

    def __init__(
        self,
        options: Options,
        prior: FloatArray,
        added: FloatArray,
        *,
        largest: bool,
        highest: float = np.inf,
        rounding: float = 0.0,
    ) -> None:
        self.rounding = rounding
        self.options, self.prior, self.added, self.largest, self.highest = options, prior, added, largest, highest
        self.sign = -1.0 if largest else 1.0
        self.base, self.own_base = (prior + added, prior) if largest else (prior, prior + added)
        self.everything: BoolArray = np.ones(len(options.elements), dtype=np.bool_)
        self._radius = np.hypot(added[1], added[2])
        weakest = np.arctan2(-added[2], -added[1])
        self._reference = weakest + np.pi if largest else weakest
        self._lowest = levels(prior)

    def sector(self, region: Region) -> Sector:
        """A region's directions."""
        middle = float(self._reference[region.target]) + (region.low + region.high) / 2
        return Sector(region.target, middle, (region.high - region.low) / 2)

    def extreme_added(self, target: int, low: float, high: float) -> float:
        """The least (most) that ``x`` adds along a direction of a sector."""
        nearest = 0.0 if low <= 0 <= high else min(abs(low), abs(high))
        return float(self.added[0, target] - self.sign * self._radius[target] * np.cos(nearest))

    def key(self, region: Region, ceiling: float, slope: float, added: float | None = None) -> float:
        """A region's bound by both inequalities (negated for the largest marginal)."""
        numbers = np.array([[ceiling], [region.added if added is None else added], [slope]])
        return float(self._keys(np.array([region.target]), *numbers)[0])

    def enough(self, region: Region, target: float, slope: float) -> float:
        """The ceiling at which a region's key reaches a target."""
        if self.sign * target <= 0 or region.added <= 0:
            return -np.inf
        if self.largest:
            return most_enough(-target * (1 - 2 * MARGIN), region.added, slope, float(self._lowest[region.target]))
        return least_enough(target * (1 + 2 * MARGIN), region.added, slope, self.highest)

    def roots(self, sectors: tuple[float, ...]) -> list[Region]:
        """Regions that cover every context, bounded by ``d`` alone."""
        ends = [(-sectors[0], sectors[0])]
        for low, high in pairwise(sectors):
            ends += [(low, high), (-high, -low)]
        return [self._alone(j, low, high) for j in range(len(self._lowest)) for low, high in ends]

    def recycle(self, regions: Sequence[Region], known: Sequence[RelaxedContext]) -> None:
        """Raise the bounds of regions with the same options left, by what the program found elsewhere."""
        if not regions or not known:
            return
        target = np.array([region.target for region in regions])
        ends = np.array([(region.low, region.high) for region in regions])
        middle, half = self._reference[target] + ends.mean(axis=1), (ends[:, 1] - ends[:, 0]) / 2
        direction, allowed = own_direction(middle, half), regions[0].allowed
        ceiling = ceilings(self.options, self.base, self.own_base, target, direction, known, allowed)
        added = np.broadcast_to([region.added for region in regions], ceiling.shape)
        slope = np.broadcast_to([[one.slope] for one in known], ceiling.shape)
        keys = self._keys(target, ceiling, added, slope)
        for region, key, best in zip(regions, keys.max(axis=0).tolist(), keys.argmax(axis=0).tolist(), strict=True):
            if key > region.key:
                region.key, region.start, region.slope = key, known[best].average, known[best].slope

    def _alone(self, target: int, low: float, high: float) -> Region:
        added = self.extreme_added(target, low, high)
        level = float(self._lowest[target]) if self.largest else self.highest
        key = self.sign * (1 / level - 1 / (level + added)) * (1 - self.sign * MARGIN)
        slope = ((level + added) / level) ** (-2 * self.sign)
        return Region(key, target, low, high, added, self.everything, slope)

    def _keys(self, target: IntArray, ceiling: FloatArray, added: FloatArray, slope: FloatArray) -> FloatArray:
        """The least (most) marginals that both inequalities of some regions leave."""
        if self.largest:
            return -most_marginal(ceiling, added, slope, self._lowest[target]) * (1 + MARGIN)
        return least_marginal(ceiling, added, slope, self.highest) * (1 - MARGIN)
