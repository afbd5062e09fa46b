"""Brackets of the marginals of the max-eigenvalue criterion in the plane, the least certain ratio refined first.

Every element has cheap bounds at once: with ``T`` the largest smallest-level any context reaches (a linear program),
its smallest marginal is at least ``1/T - 1/(T + d)``, ``d`` the least it adds to any target in any direction; its
largest is at most ``1/p - 1/(p + D)``, ``p`` the prior level and ``D`` the most it adds.
Elements whose ratio these leave open are searched (:mod:`ratt_opt.curvatures.planar.context_search`),
each on the side that is the less certain.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.curvatures.least_certain import MarginalBrackets
from ratt_opt.curvatures.planar.context_search import PlanarSearch
from ratt_opt.curvatures.planar.level_program import LevelProgram
from ratt_opt.curvatures.planar.options import Options, levels
from ratt_opt.curvatures.planar.regions import Side

if TYPE_CHECKING:
    from ratt_opt._validation import FloatArray, IntArray
    from ratt_opt.budget import Budget
    from ratt_opt.curvatures.planar.level_inequalities import Average
    from ratt_opt.setfunctions.criteria.planar_levels import PlanarLevels
    from ratt_opt.stopping import Stop

__all__ = ["PlanarBrackets"]

POOL = 16
"""Averages of cuts kept for elements not searched yet, for each side."""
STUCK = 8
"""Parts bounded on one side before pairs of owners are tried for a better context: they take long."""
LONG_STUCK = 40
"""The same for elements whose ratio is more than ``CONTENDER`` times the smallest one seen."""
CONTENDER = 1.1
PATIENCE = 20
"""Parts bounded on one side before its number of parts counts against it."""
MARGIN = 1e-9
"""Relative safety margin for rounding."""


class PlanarBrackets(MarginalBrackets):
    """Two searches an element, one for each marginal, begun when its ratio is the least certain.

    ``against_own`` : the ratio that matters is to ``f({x})``, so the largest marginals are left as they are.
    """

    def __init__(
        self,
        data: PlanarLevels,
        owners: IntArray,
        single: FloatArray,
        *,
        gap: float,
        budget: Budget,
        against_own: bool,
    ) -> None:
        super().__init__(single, gap, budget)
        self._data, self._owners, self._against_own = data, owners, against_own
        self._options: dict[int, Options] = {}
        self._highest: dict[int, float] = {}
        self._searches: dict[int, tuple[PlanarSearch, PlanarSearch]] = {}
        self._pools: tuple[list[Average], list[Average]] = [], []

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
        self._done[x] = self._closed(x)

    def _closed(self, x: int) -> bool:
        low, high = self._searches[x]
        return low.exhausted and (self._against_own or high.exhausted)

    def _open(self, x: int) -> None:
        """Start both searches from the context that lifts the smallest level most."""
        owner = int(self._owners[x])
        if owner not in self._options:
            options = Options.beside(self._data, self._owners, owner)
            self._options[owner] = options
            self._highest[owner] = self._highest_level(options)
        added, highest = self._data.parts[x], self._highest[owner]
        sides = [
            Side(self._options[owner], self._data.prior, added, largest=largest, highest=highest)
            for largest in (False, True)
        ]
        low, high = (PlanarSearch(*start) for start in zip(sides, self._pools, strict=True))
        self._searches[x] = low, high

    def _continue(self, x: int, target: float) -> None:
        """Refine the more doubtful of an element's two searches."""
        low, high = self._searches[x]
        doubt_low = low.attained.value / low.bound if low.bound > 0 else np.inf
        doubt_high = high.bound / high.attained.value if high.attained.value > 0 else np.inf
        first = low.exhausted or (_pressing(doubt_high, high.nodes) > _pressing(doubt_low, low.nodes))
        side = high if first and not high.exhausted and not self._against_own else low
        aim = side.attained.value * self._spare(x, target) ** (-side.side.sign / (1 if self._against_own else 2))
        close = self.seen_least[x] <= CONTENDER * self.seen_most[x] * self._shown().min()
        if side.nodes >= (STUCK if close else LONG_STUCK):
            side.attained.pairs(self._budget)
        before = side.nodes
        side.refine(side.side.sign * aim, self._budget)
        self._budget.nodes += side.nodes - before
        pool = self._pools[int(side is high)]
        pool += side.averages
        side.averages.clear()
        del pool[:-POOL]

    def _spare(self, x: int, target: float) -> float:
        """How many times what is proved of an element may fall short of what is seen: at least 1."""
        if not (self.seen_most[x] > 0 and 0 < target < np.inf):
            return 1.0
        return max(float(self.seen_least[x] / self.seen_most[x]) / target, 1.0)

    def _record(self, x: int) -> None:
        low, high = self._searches[x]
        self.seen_least[x] = min(low.attained.value / self._data.scale, self.seen_least[x])
        self.least[x] = min(max(low.bound / self._data.scale, self.least[x]), self.seen_least[x])
        if not self._against_own:
            self.seen_most[x] = max(high.attained.value / self._data.scale, self.seen_most[x])
            self.most[x] = max(min(high.bound / self._data.scale, self.most[x]), self.seen_most[x])

    def _highest_level(self, options: Options) -> float:
        """Proved upper bound on the smallest level of any context."""
        everything = np.ones(len(options.elements), dtype=np.bool_)
        program = LevelProgram(options, self._data.prior, self._data.prior, None, allowed=everything)
        return program.bound(0.0, self._budget).ceiling


def _pressing(doubt: float, nodes: int) -> float:
    """Which side of an element to refine: the more doubtful one, less so the more parts it has taken."""
    return float(np.log(doubt) / np.sqrt(nodes + PATIENCE))
