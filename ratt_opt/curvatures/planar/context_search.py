"""Branch and bound for one element's smallest, or largest, marginal of the max-eigenvalue criterion in the plane.

What a region of the contexts is and how it is bounded: :mod:`ratt_opt.curvatures.planar.regions`. A region is split by
halving its sector or one owner's options: the one that its bound depends on more.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.curvatures.params import DEFAULT
from ratt_opt.curvatures.planar.contexts import PlanarDescent, along, levels
from ratt_opt.curvatures.planar.level_program import LevelProgram
from ratt_opt.curvatures.planar.regions import Region

if TYPE_CHECKING:
    from collections.abc import Sequence

    from ratt_opt._validation import BoolArray, FloatArray, IntArray
    from ratt_opt.budget import Budget
    from ratt_opt.curvatures.params import PlanarParams
    from ratt_opt.curvatures.planar.level_program import RelaxedContext
    from ratt_opt.curvatures.planar.regions import MarginalSide

__all__ = ["PlanarSearch"]


class PlanarSearch:
    """Claim: the element's smallest (largest) marginal lies between ``bound`` and ``attained.value``.

    ``known`` : what the program found in searches for the same end of other elements; ``found`` : in this one.

    The loop over regions is its own, not that of ``search/branch_and_bound.py``: what one program finds raises the
    bounds of other open regions, too, so their order changes in place, and the regions of one set are bounded together.
    """

    def __init__(
        self, side: MarginalSide, known: Sequence[RelaxedContext] = (), params: PlanarParams = DEFAULT.planar
    ) -> None:
        self.side, self._params = side, params
        self.attained = PlanarDescent(side.options, side.prior, side.added, sign=side.sign, rounding=side.rounding)
        self.attained.offer(self.attained.picks)
        self.nodes = 0
        self.found: list[RelaxedContext] = []
        self._last: FloatArray | None = None
        self._open = side.roots(params.sectors)
        side.recycle(self._open, known)
        self._keep(self._open)

    @property
    def exhausted(self) -> bool:
        """Tell whether no region can hold a better marginal: the bounds meet."""
        return self._weakest >= self.side.sign * self.attained.value

    @property
    def bound(self) -> float:
        """Proved end: below every smallest marginal, above every largest one."""
        return self.side.sign * min(self._weakest, self.side.sign * self.attained.value)

    def refine(self, aim: float, budget: Budget) -> None:
        """Bound the weakest region by a linear program, or split it; an interrupt leaves every region covered."""
        if self.exhausted:
            return
        region = min(self._open, key=lambda open_: open_.key)
        counts = np.bincount(self.side.options.owners, region.allowed)
        if np.prod(counts) <= self._params.largest_leaf:
            self.nodes += 1
            self.attained.enumerate(region.allowed)
            self._keep([other for other in self._open if other is not region])
        elif region.relaxed is None:
            found = self._relax(region, aim, budget)
            self.attained.offer(self._rounded(region.allowed, found.mixture))
            if region.allowed is self.side.everything:
                self.found.append(found)
                fresh = [other for other in self._open if other.relaxed is None and other.allowed is region.allowed]
                self.side.recycle(fresh, [found])
            self._keep(self._open)
        else:
            children = self._children(region, region.relaxed)
            self._keep([other for other in self._open if other is not region] + children)

    def _keep(self, regions: list[Region]) -> None:
        """Drop the regions that hold nothing better."""
        best = self.side.sign * self.attained.value
        self._open = [region for region in regions if region.key < best]
        self._weakest = min((region.key for region in self._open), default=np.inf)

    def _relax(self, region: Region, aim: float, budget: Budget) -> RelaxedContext:
        """Raise a region's bound towards an aim; the last program's solution."""
        self.nodes += 1
        side = self.side
        start = self._last if region.start is None else region.start
        program = LevelProgram(
            side.options,
            side.base,
            side.own_base,
            side.sector(region),
            allowed=region.allowed,
            start=start,
            params=self._params,
        )
        low, high = 0.0, np.inf
        for _ in range(self._params.slopes):
            found = program.bound(region.slope, budget, side.enough(region, aim, region.slope))
            key = side.key(region, found.ceiling, region.slope)
            if region.relaxed is None or key >= region.key:
                region.relaxed = found
            region.key = max(region.key, key)
            self._last = found.average
            gap = aim - key
            if gap <= 0 or not 0 < found.level < np.inf or found.own <= 0 or budget.is_over:
                break
            # The second is the key that the best slope could reach, at most.
            if 1 / found.level - 1 / found.own - key <= self._params.slope_share * gap:
                break
            slope, wanted = region.slope, (found.level / found.own) ** 2
            low, high = (max(low, slope), high) if wanted > slope else (low, min(high, slope))
            if not low < wanted < high:
                wanted = float(np.sqrt(low * high)) if 0 < low < high < np.inf else slope
            if abs(wanted - slope) <= 0.02 * abs(slope - 1):
                break
            region.slope = wanted
        return found

    def _rounded(self, allowed: BoolArray, mixture: FloatArray) -> IntArray:
        """The heaviest allowed option of each owner."""
        weight = np.where(allowed, mixture, -1.0)
        first = self.side.options.first
        ends = np.append(first[1:], len(weight))
        return np.array([a + int(weight[a:b].argmax()) for a, b in zip(first, ends, strict=True)], dtype=np.int64)

    def _children(self, region: Region, found: RelaxedContext) -> list[Region]:
        """Halve the sector, or one owner's options."""
        side = self.side
        total = side.own_base[:, region.target] + found.mixture @ side.options.parts[:, :, region.target]
        mixed = float(along(np.arctan2(-total[2], -total[1])) @ side.added[:, region.target])
        added = side.sign * max(side.sign * mixed, side.sign * region.added)
        ceiling = found.level - found.slope * float(total[0] - np.hypot(total[1], total[2]))
        # Bound for a sector reduced to the mixture's own direction.
        exact = side.key(region, ceiling, found.slope, added)
        owed = exact - region.key > self._params.halving_share * (side.sign * self.attained.value - exact)
        spread = self._spread(region.allowed, found)
        if region.high - region.low <= self._params.narrowest or not (owed or spread.max() <= 0):
            divided = self._divided(region.allowed, found, region.target, int(spread.argmax()))
            return [self._child(region, found, allowed, region.low, region.high) for allowed in divided]
        middle = (region.low + region.high) / 2
        ends = (region.low, middle), (middle, region.high)
        halves = [self._child(region, found, region.allowed, low, high) for low, high in ends]
        side.recycle(halves, [found])
        return halves

    def _spread(self, allowed: BoolArray, found: RelaxedContext) -> FloatArray:
        """(R,) how much the mixture of each owner's options spreads over the binding cuts; -1 with one option."""
        options = self.side.options
        values = np.einsum("kpc,cp->kc", options.parts[:, :, found.cuts.targets], along(found.cuts.angles))
        mean = np.add.reduceat(found.mixture[:, None] * values, options.first)
        square = found.mixture * ((values - mean[options.owners]) ** 2 @ found.multipliers)
        counts = np.add.reduceat(allowed.astype(np.int64), options.first)
        return np.where(counts > 1, np.add.reduceat(square, options.first), -1.0)

    def _divided(self, allowed: BoolArray, found: RelaxedContext, target: int, owner: int) -> list[BoolArray]:
        """Options of an owner that tell a target less than the mixture does, and those that tell more."""
        mine = np.flatnonzero((self.side.options.owners == owner) & allowed)
        order = np.argsort(levels(self.side.options.parts[mine])[:, target], kind="stable")
        share = np.cumsum(found.mixture[mine][order])
        cut = int(np.clip(np.searchsorted(share, share[-1] / 2) + 1, 1, len(mine) - 1))
        divided = []
        for gone in (order[cut:], order[:cut]):
            kept = allowed.copy()
            kept[mine[gone]] = False
            divided.append(kept)
        return divided

    def _child(self, region: Region, found: RelaxedContext, allowed: BoolArray, low: float, high: float) -> Region:
        added = self.side.extreme_added(region.target, low, high)
        return Region(region.key, region.target, low, high, added, allowed, region.slope, found.average)
