"""Brackets of the marginals of the max-eigenvalue criterion in the plane, the least certain ratio refined first.

Every element has cheap bounds at once: with ``T`` the largest smallest-level any context reaches (a linear program),
its smallest marginal is at least ``1/T - 1/(T + d)``, ``d`` the least it adds to any target in any direction; its
largest is at most ``1/p - 1/(p + D)``, ``p`` the prior level and ``D`` the most it adds. Elements whose ratio these
leave open are searched, each on the side that is the less certain.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.curvatures.marginals import MARGIN, MarginalBrackets
from ratt_opt.curvatures.planar.context_search import PlanarSearch
from ratt_opt.curvatures.planar.contexts import Options, levels
from ratt_opt.curvatures.planar.level_program import LevelProgram
from ratt_opt.curvatures.planar.regions import MarginalSide

if TYPE_CHECKING:
    from ratt_opt.budget import Stop
    from ratt_opt.curvatures.planar.level_program import RelaxedContext

__all__ = ["PlanarBrackets"]


class PlanarBrackets(MarginalBrackets):
    """Two searches an element, one for each marginal, begun when its ratio is the least certain."""

    rests_on = "smallest levels"

    def _prepare(self) -> None:
        levels_of = self._f.planar_levels()
        assert levels_of is not None
        self._data = levels_of
        self._options: dict[int, Options] = {}
        self._highest: dict[int, float] = {}
        self._searches: dict[int, tuple[PlanarSearch, PlanarSearch]] = {}
        self._pools: tuple[list[RelaxedContext], list[RelaxedContext]] = [], []

    def _begin(self) -> Stop | None:
        """Bound every element by the largest smallest-level that any context reaches."""
        parts, prior = self._data.parts, self._data.prior
        highest = self._highest_level(Options.beside(self._data, self._owners, -1))
        radius = np.hypot(parts[:, 1], parts[:, 2])
        least = np.clip(parts[:, 0] - radius, 0.0, None).min(axis=-1)
        level, most = levels(prior), parts[:, 0] + radius
        smallest = 1 / highest - 1 / (highest + least)
        largest = (1 / level - 1 / (level + most)).max(axis=-1)
        self.least = smallest * (1 - MARGIN) / self._data.scale
        if not self._against_own:
            self.most = np.maximum(largest * (1 + MARGIN) / self._data.scale, self.seen_most)
        return None

    def _attaining(self) -> tuple[list[tuple[int, ...]], list[tuple[int, ...]]]:
        smallest: list[tuple[int, ...]] = [()] * len(self.least)
        largest = smallest.copy()
        for x, (low, high) in self._searches.items():
            self._record(x)
            smallest[x] = low.side.options.context(low.attained.picks)
            largest[x] = high.side.options.context(high.attained.picks)
        return smallest, largest

    def _refine(self, x: int, target: float) -> None:
        if x in self._searches:
            self._continue(x, target)
        else:
            self._open(x)
        self._record(x)
        low, high = self._searches[x]
        self._done[x] = low.exhausted and (self._against_own or high.exhausted)

    def _open(self, x: int) -> None:
        """Start both searches from the context that lifts the smallest level most."""
        owner = int(self._owners[x])
        if owner not in self._options:
            options = Options.beside(self._data, self._owners, owner)
            self._options[owner] = options
            self._highest[owner] = self._highest_level(options)
        added, highest = self._data.parts[x], self._highest[owner]
        options, prior = self._options[owner], self._data.prior
        rounding = 2 * self._data.rounding  # a marginal is a difference of two values
        low, high = (
            MarginalSide(options, prior, added, largest=largest, highest=highest, rounding=rounding)
            for largest in (False, True)
        )
        low_pool, high_pool = self._pools
        planar = self._params.planar
        self._searches[x] = PlanarSearch(low, low_pool, planar), PlanarSearch(high, high_pool, planar)

    def _continue(self, x: int, target: float) -> None:
        """Refine the more doubtful of an element's two searches."""
        (low, high), params = self._searches[x], self._params.planar
        doubt_low = low.attained.value / low.bound if low.bound > 0 else np.inf
        doubt_high = high.bound / high.attained.value if high.attained.value > 0 else np.inf
        of_low, of_high = (_pressing(d, s.nodes, params.patience) for d, s in ((doubt_low, low), (doubt_high, high)))
        first = low.exhausted or of_high > of_low
        side = high if first and not high.exhausted and not self._against_own else low
        aim = side.attained.value * self._spare(x, target) ** (-side.side.sign / (1 if self._against_own else 2))
        ratios = self._shown()
        close = ratios[x] <= params.contender * ratios.min()
        if side.nodes >= (params.stuck if close else params.long_stuck):
            side.attained.pairs(self._budget)
        before = side.nodes
        side.refine(side.side.sign * aim, self._budget)
        self._budget.nodes += side.nodes - before
        pool = self._pools[int(side is high)]
        pool += side.found
        side.found.clear()
        del pool[: -params.pool]

    def _spare(self, x: int, target: float) -> float:
        """Return the factor (at least 1) by which an element's proved ratio may fall short of the one seen."""
        if not (self.seen_most[x] > 0 and 0 < target < np.inf):
            return 1.0
        finite = 1e100  # so that no product with an end that is 0 or infinite is undefined
        return min(max(float(self.seen_least[x] / self.seen_most[x]) / target, 1.0), finite)

    def _record(self, x: int) -> None:
        low, high = self._searches[x]
        self.seen_least[x] = min(low.attained.value / self._data.scale, self.seen_least[x])
        self.least[x] = min(max(low.bound / self._data.scale, self.least[x]), self.seen_least[x])
        if not self._against_own:
            self.seen_most[x] = max(high.attained.value / self._data.scale, self.seen_most[x])
            self.most[x] = max(min(high.bound / self._data.scale, self.most[x]), self.seen_most[x])

    def _highest_level(self, options: Options) -> float:
        """Proved upper bound on the smallest level of any context; an interrupt leaves none."""
        if self._budget.is_interrupted:
            return np.inf
        everything = np.ones(len(options.elements), dtype=np.bool_)
        program = LevelProgram(
            options, self._data.prior, self._data.prior, None, allowed=everything, params=self._params.planar
        )
        return program.bound(0.0, self._budget).ceiling


def _pressing(doubt: float, nodes: int, patience: int) -> float:
    """Return the urgency of refining a side of an element: its doubt, discounted by the nodes spent."""
    return float(np.log(doubt) / np.sqrt(nodes + patience))
