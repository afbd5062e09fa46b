"""Branch and bound for one element's smallest, or largest, marginal of the max-eigenvalue criterion in the plane.

What a part of the contexts is and how it is bounded: :mod:`ratt_opt.curvatures.planar.planar_parts`. A part is split by
halving its sector or one robot's options, whichever its bound owes more to.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.curvatures.planar.level_bounds import Average
from ratt_opt.curvatures.planar.level_program import LevelProgram
from ratt_opt.curvatures.planar.planar import along, levels
from ratt_opt.curvatures.planar.planar_descent import PlanarDescent
from ratt_opt.curvatures.planar.planar_parts import Part

if TYPE_CHECKING:
    from collections.abc import Sequence

    from ratt_opt._validation import BoolArray, FloatArray, IntArray
    from ratt_opt.curvatures.planar.level_program import Relaxed
    from ratt_opt.curvatures.planar.planar_parts import Side

__all__ = ["PlanarSearch"]

SLOPES = 4
"""Most slopes tried for one part."""
SLOPE_SHARE = 0.1
"""Another slope is tried where it could close more than this share of the gap."""
NARROWEST = 1e-3
"""Sectors narrower than this are not halved again."""
LARGEST_LEAF = 2048
"""Parts with at most this many contexts are enumerated, which takes no longer than a linear program."""
HALVING_SHARE = 0.4
"""A sector is halved where that could close this share of what its mixture leaves open."""


class PlanarSearch:
    """Claim: the element's smallest (largest) marginal lies between ``bound`` and ``attained.value``.

    Parameters
    ----------
    side : the element, and which end is sought
    averages : of cuts, from searches for the same end of other elements
    """

    def __init__(self, side: Side, averages: Sequence[Average] = ()) -> None:
        self.side = side
        self.attained = PlanarDescent(side.options, side.prior, side.added, sign=side.sign)
        self.attained.offer(self.attained.picks)
        self.nodes = 0
        self.averages: list[Average] = []
        self._last: FloatArray | None = None
        self._open = side.roots()
        side.recycle(self._open, averages)
        self._keep(self._open)

    @property
    def exhausted(self) -> bool:
        """Whether no part can hold a better marginal: the ends meet."""
        return self._weakest >= self.side.sign * self.attained.value

    @property
    def bound(self) -> float:
        """Proved end: below every smallest marginal, above every largest one."""
        return self.side.sign * min(self._weakest, self.side.sign * self.attained.value)

    def refine(self, aim: float) -> None:
        """Bound the weakest part by a linear program, or split it; an interrupt leaves every part covered."""
        if self.exhausted:
            return
        part = min(self._open, key=lambda open_: open_.key)
        counts = np.bincount(self.side.options.robot, part.allowed)
        if np.prod(counts) <= LARGEST_LEAF:
            self.nodes += 1
            self.attained.enumerate(part.allowed)
            self._keep([other for other in self._open if other is not part])
        elif part.relaxed is None:
            found = self._relax(part, aim)
            self.attained.offer(self._rounded(part.allowed, found.mixture))
            self._share(part, found)
            self._keep(self._open)
        else:
            children = self._children(part, part.relaxed)
            self._keep([other for other in self._open if other is not part] + children)

    def _share(self, part: Part, found: Relaxed) -> None:
        """Bound other parts by what bounded this one."""
        if part.allowed is not self.side.everything:
            return
        self.averages.append(Average(found.average, found.slope))
        fresh = [other for other in self._open if other.relaxed is None and other.allowed is self.side.everything]
        self.side.recycle(fresh, self.averages[-1:])

    def _keep(self, parts: list[Part]) -> None:
        """Drop the parts that hold nothing better."""
        best = self.side.sign * self.attained.value
        self._open = [part for part in parts if part.key < best]
        self._weakest = min((part.key for part in self._open), default=np.inf)

    def _relax(self, part: Part, aim: float) -> Relaxed:
        """Raise a part's bound towards an aim; the last program's solution."""
        self.nodes += 1
        side = self.side
        start = self._last if part.start is None else part.start
        program = LevelProgram(
            side.options, side.base, side.own_base, side.sector(part), allowed=part.allowed, start=start
        )
        low, high = 0.0, np.inf
        for _ in range(SLOPES):
            found = program.bound(part.slope, side.enough(part, aim, part.slope))
            key = side.key(part, found.ceiling, part.slope)
            if part.relaxed is None or key >= part.key:
                part.relaxed = found
            part.key = max(part.key, key)
            self._last = found.average
            gap = aim - key
            if gap <= 0 or not 0 < found.level < np.inf or found.own <= 0:
                break
            # The second is the key that the best slope could reach, at most.
            if 1 / found.level - 1 / found.own - key <= SLOPE_SHARE * gap:
                break
            slope, wanted = part.slope, (found.level / found.own) ** 2
            low, high = (max(low, slope), high) if wanted > slope else (low, min(high, slope))
            if not low < wanted < high:
                wanted = float(np.sqrt(low * high)) if 0 < low < high < np.inf else slope
            if abs(wanted - slope) <= 0.02 * abs(slope - 1):
                break
            part.slope = wanted
        return found

    def _rounded(self, allowed: BoolArray, mixture: FloatArray) -> IntArray:
        """The heaviest allowed option of each robot."""
        weight = np.where(allowed, mixture, -1.0)
        first = self.side.options.first
        ends = np.append(first[1:], len(weight))
        return np.array([a + int(weight[a:b].argmax()) for a, b in zip(first, ends, strict=True)], dtype=np.int64)

    def _children(self, part: Part, found: Relaxed) -> list[Part]:
        """Halve the sector, or one robot's options."""
        side = self.side
        total = side.own_base[:, part.target] + found.mixture @ side.options.parts[:, :, part.target]
        mixed = float(along(np.arctan2(-total[2], -total[1])) @ side.added[:, part.target])
        added = side.sign * max(side.sign * mixed, side.sign * part.added)
        ceiling = found.level - found.slope * float(total[0] - np.hypot(total[1], total[2]))
        # What the bound would be if the sector were just the mixture's own direction.
        exact = side.key(part, ceiling, found.slope, added)
        owed = exact - part.key > HALVING_SHARE * (side.sign * self.attained.value - exact)
        spread = self._spread(part.allowed, found)
        if part.high - part.low <= NARROWEST or not (owed or spread.max() <= 0):
            divided = self._divided(part.allowed, found, part.target, int(spread.argmax()))
            return [self._child(part, found, allowed, part.low, part.high) for allowed in divided]
        middle = (part.low + part.high) / 2
        ends = (part.low, middle), (middle, part.high)
        halves = [self._child(part, found, part.allowed, low, high) for low, high in ends]
        side.recycle(halves, [Average(found.average, found.slope)])
        return halves

    def _spread(self, allowed: BoolArray, found: Relaxed) -> FloatArray:
        """(R,) how much the mixture of each robot's options spreads over the binding cuts; -1 with one option."""
        options = self.side.options
        values = np.einsum("kpc,cp->kc", options.parts[:, :, found.cuts.targets], along(found.cuts.angles))
        mean = np.add.reduceat(found.mixture[:, None] * values, options.first)
        square = found.mixture * ((values - mean[options.robot]) ** 2 @ found.multipliers)
        counts = np.add.reduceat(allowed.astype(np.int64), options.first)
        return np.where(counts > 1, np.add.reduceat(square, options.first), -1.0)

    def _divided(self, allowed: BoolArray, found: Relaxed, target: int, robot: int) -> list[BoolArray]:
        """Options of a robot that tell a target less than the mixture does, and those that tell more."""
        mine = np.flatnonzero((self.side.options.robot == robot) & allowed)
        order = np.argsort(levels(self.side.options.parts[mine])[:, target], kind="stable")
        share = np.cumsum(found.mixture[mine][order])
        cut = int(np.clip(np.searchsorted(share, share[-1] / 2) + 1, 1, len(mine) - 1))
        divided = []
        for gone in (order[cut:], order[:cut]):
            kept = allowed.copy()
            kept[mine[gone]] = False
            divided.append(kept)
        return divided

    def _child(self, part: Part, found: Relaxed, allowed: BoolArray, low: float, high: float) -> Part:
        added = self.side.extreme_added(part.target, low, high)
        return Part(part.key, part.target, low, high, added, allowed, part.slope, found.average)
