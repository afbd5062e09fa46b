"""Regions: sets of columns of which few robots choose one, so that an attack may blind all of these.

A fractional plan spreads a robot over many sites, and an attack on one of them takes little of it. A *region* holds
sites that are near each other. If at most ``most`` robots choose there, an attack blinds them at that price, however
they are spread in the region; if more do, the plan leaves other places empty. So each fractional plan is cut off
twice by a division of a node: few robots choose in a region, or more.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.solvers.by_values.columns import WHOLE, CountedRegion

if TYPE_CHECKING:
    from ratt_opt._validation import FloatArray, IntArray
    from ratt_opt.solvers.by_values.columns import PlanNode
    from ratt_opt.solvers.by_values.mean_losses import MeanLosses
    from ratt_opt.solvers.maxmin.params import RegionParams

__all__ = ["RegionChoice"]


class RegionChoice:
    """Chooses the region by which a node is divided: balls around columns that a fractional plan uses.

    Columns are near each other if their utilities differ little.
    """

    def __init__(self, means: MeanLosses, params: RegionParams) -> None:
        self._means, self._params = means, params
        self._near: dict[int, IntArray] = {}

    def at(self, node: PlanNode, point: FloatArray, level: float, goal: float) -> CountedRegion | None:
        """The region whose both sides promise most at a fractional plan (columns,); ``None`` if none promises enough.

        ``level`` : of the plan under the rows known; ``goal`` : the best plan's
        """
        regions = [one for one in self._balls(point) if not _is_known(one, node)]
        if not regions or level <= goal:
            return None
        mass = np.array([float(point[one.columns].sum()) for one in regions])
        most = np.array([one.most for one in regions])
        drop = np.maximum(level - self._left(regions, node, point), 0.0)
        fewer = drop + self._params.beyond * (level - goal) * np.maximum(mass - most, 0.0)
        more = np.clip(most + 1 - mass, 0.0, 1.0)
        promise = np.minimum(fewer, 2 * (level - goal)) * more
        best = int(promise.argmax())
        return regions[best] if promise[best] > self._params.least * (level - goal) else None

    def _left(self, regions: list[CountedRegion], node: PlanNode, point: FloatArray) -> FloatArray:
        """(K,) values of a fractional plan if each region is blinded, with another one if that leaves less."""
        lost, others = self._means.lost, [one for one in node.within if one.most <= self._means.lost]
        pairs: list[tuple[int, CountedRegion | None]] = [(k, None) for k in range(len(regions))]
        pairs += [(k, one) for k in range(len(regions)) for one in others if regions[k].most + one.most <= lost]
        kept = np.array([~(regions[k].columns if o is None else regions[k].columns | o.columns) for k, o in pairs])
        wiped = np.array([regions[k].most + (0 if o is None else o.most) for k, o in pairs])
        values = self._means.values(point, kept, wiped)
        left: FloatArray = np.full(len(regions), np.inf)
        np.minimum.at(left, [k for k, _ in pairs], values)
        return left

    def _balls(self, point: FloatArray) -> list[CountedRegion]:
        """Balls that hold about as few robots as may be lost; one for each set of used columns and number of robots."""
        found: dict[tuple[bytes, int], CountedRegion] = {}
        for centre in np.flatnonzero(point > 0).tolist():
            if centre not in self._near:
                self._near[centre] = self._means.nearest(centre)
            near = self._near[centre]
            inside = np.cumsum(point[near])
            for most in range(1, self._means.lost + 1):
                size = int(np.searchsorted(inside, most + WHOLE))
                for count in (size, size + 1):
                    columns = np.zeros(len(point), dtype=np.bool_)
                    columns[near[:count]] = True
                    if columns.any() and not columns.all():
                        found.setdefault(
                            (np.packbits(columns & (point > 0)).tobytes(), most), CountedRegion(columns, most)
                        )
        return list(found.values())


def _is_known(region: CountedRegion, node: PlanNode) -> bool:
    """Tell whether a node's regions decide it: few choose in one around it, or more in one inside."""
    fewer = any(one.most <= region.most and not (region.columns & ~one.columns).any() for one in node.within)
    return fewer or any(one.most >= region.most and not (one.columns & ~region.columns).any() for one in node.beyond)
