"""Brackets of the marginals of the max-eigenvalue criterion in the plane, the least certain ratio refined first.

Every element has cheap bounds at once: with ``T`` the largest smallest-level any context reaches (a linear program),
its smallest marginal is at least ``1/T - 1/(T + d)``, ``d`` the least it adds to any target in any direction; its
largest is at most ``1/p - 1/(p + D)``, ``p`` the prior level and ``D`` the most it adds.
Elements whose ratio these leave open are searched (:mod:`ratt_opt.curvatures.planar.eigenvalue_branching`),
each on the side that is the less certain.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.curvatures.marginals import Marginals
from ratt_opt.curvatures.planar.eigenvalue_branching import PlanarSearch
from ratt_opt.curvatures.planar.level_program import LevelProgram
from ratt_opt.curvatures.planar.planar import Options, Planar, levels
from ratt_opt.curvatures.planar.planar_parts import Side
from ratt_opt.stopping import Stop

if TYPE_CHECKING:
    from ratt_opt._validation import FloatArray, IntArray
    from ratt_opt.curvatures.brackets import Budget
    from ratt_opt.curvatures.planar.level_bounds import Average
    from ratt_opt.setfunctions.information import InformationObjective

__all__ = ["PlanarBrackets"]

POOL = 16
"""Averages of cuts kept for elements not searched yet, for each side."""
STUCK = 8
"""Parts bounded on one side before pairs of robots are tried for a better context: they take long."""
LONG_STUCK = 40
"""The same for elements whose ratio is more than ``CONTENDER`` times the smallest one seen."""
CONTENDER = 1.1
PATIENCE = 20
"""Parts bounded on one side before its number of parts counts against it."""
MARGIN = 1e-9
"""Relative safety margin for rounding."""


class PlanarBrackets:
    """(n,) ``least`` <= smallest marginals <= ``seen_least``, ``seen_most`` <= largest marginals <= ``most``.

    ``nodes`` : parts bounded so far.
    ``against_own`` : the ratio that matters is to ``f({x})``, so the largest marginals are left as they are.
    """

    def __init__(self, f: InformationObjective, owners: IntArray, budget: Budget, *, against_own: bool) -> None:
        self._f, self._owners, self._budget, self._against_own = f, owners, budget, against_own
        self._planar = Planar.of(f)
        self._options: dict[int, Options] = {}
        self._highest: dict[int, float] = {}
        self._searches: dict[int, tuple[PlanarSearch, PlanarSearch]] = {}
        self._pools: tuple[list[Average], list[Average]] = [], []
        self.nodes = 0
        self._done = np.zeros(f.n, dtype=np.bool_)
        single = f.singletons()
        self.least, self.most = self._first_bounds()
        self.most = np.maximum(self.most, single)
        self.seen_least, self.seen_most = single.copy(), single.copy()
        if against_own:
            self.most = single.copy()

    def run(self) -> Stop:
        """Search until the deciding ratio is known within the gap, or the budget is spent."""
        try:
            while True:
                if stop := self._step():
                    return stop
        except KeyboardInterrupt:
            return Stop.INTERRUPTED

    def marginals(self) -> Marginals:
        """What is known, with the contexts that attain the ends."""
        smallest: list[tuple[int, ...]] = [()] * self._f.n
        largest = smallest.copy()
        for x, (low, high) in self._searches.items():
            smallest[x] = low.side.options.context(low.attained.picks)
            largest[x] = high.side.options.context(high.attained.picks)
        return Marginals(self.least, self.seen_least, self.seen_most, self.most, tuple(smallest), tuple(largest))

    def _step(self) -> Stop | None:
        """Refine the least certain ratio; return why to stop instead."""
        most = np.where(self.most > 0, self.most, 1.0)
        safe = np.where(self.most > 0, self.least / most, np.inf)
        shown = self._shown()
        target = float(shown.min(initial=np.inf)) / (1 + self._budget.gap)
        open_ = np.flatnonzero((safe < target) & ~self._done)
        if not len(open_):
            return Stop.GAP if (safe < shown).any() else Stop.CLOSED
        if stop := self._budget.spent(self.nodes):
            return stop
        x = int(open_[safe[open_].argmin()])
        if x not in self._searches:
            self._open(x)
        else:
            self._refine(x, target)
        self._record(x)
        self._done[x] = self._closed(x)
        return None

    def _shown(self) -> FloatArray:
        seen = np.where(self.seen_most > 0, self.seen_most, 1.0)
        return np.where(self.seen_most > 0, self.seen_least / seen, np.inf)

    def _closed(self, x: int) -> bool:
        if x not in self._searches:
            return False
        low, high = self._searches[x]
        return low.exhausted and (self._against_own or high.exhausted)

    def _open(self, x: int) -> None:
        """Start both searches from the context that lifts the smallest level most."""
        owner = int(self._owners[x])
        if owner not in self._options:
            options = Options.beside(self._planar, self._owners, owner)
            self._options[owner] = options
            self._highest[owner] = _highest_level(options, self._planar.prior)
        added, highest = self._planar.parts[x], self._highest[owner]
        sides = [
            Side(self._options[owner], self._planar.prior, added, largest=largest, highest=highest)
            for largest in (False, True)
        ]
        low, high = (PlanarSearch(*start) for start in zip(sides, self._pools, strict=True))
        self._searches[x] = low, high

    def _refine(self, x: int, target: float) -> None:
        low, high = self._searches[x]
        doubt_low = low.attained.value / low.bound if low.bound > 0 else np.inf
        doubt_high = high.bound / high.attained.value if high.attained.value > 0 else np.inf
        first = low.exhausted or (_pressing(doubt_high, high.nodes) > _pressing(doubt_low, low.nodes))
        side = high if first and not high.exhausted and not self._against_own else low
        aim = side.attained.value * self._spare(x, target) ** (-side.side.sign / (1 if self._against_own else 2))
        close = self.seen_least[x] <= CONTENDER * self.seen_most[x] * self._shown().min()
        if side.nodes >= (STUCK if close else LONG_STUCK):
            side.attained.pairs()
        before = side.nodes
        side.refine(side.side.sign * aim)
        self.nodes += side.nodes - before
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
        self.seen_least[x] = min(low.attained.value / self._planar.scale, self.seen_least[x])
        self.least[x] = min(max(low.bound / self._planar.scale, self.least[x]), self.seen_least[x])
        if not self._against_own:
            self.seen_most[x] = max(high.attained.value / self._planar.scale, self.seen_most[x])
            self.most[x] = max(min(high.bound / self._planar.scale, self.most[x]), self.seen_most[x])

    def _first_bounds(self) -> tuple[FloatArray, FloatArray]:
        parts, prior = self._planar.parts, self._planar.prior
        highest = _highest_level(Options.beside(self._planar, self._owners, -1), prior)
        radius = np.hypot(parts[:, 1], parts[:, 2])
        least = np.clip(parts[:, 0] - radius, 0.0, None).min(axis=-1)
        level, most = levels(prior), parts[:, 0] + radius
        smallest = 1 / highest - 1 / (highest + least)
        largest = (1 / level - 1 / (level + most)).max(axis=-1)
        return smallest * (1 - MARGIN) / self._planar.scale, largest * (1 + MARGIN) / self._planar.scale


def _pressing(doubt: float, nodes: int) -> float:
    """Which side of an element to refine: the more doubtful one, less so the more parts it has taken."""
    return float(np.log(doubt) / np.sqrt(nodes + PATIENCE))


def _highest_level(options: Options, prior: FloatArray) -> float:
    """Proved upper bound on the smallest level of any context."""
    everything = np.ones(len(options.elements), dtype=np.bool_)
    return LevelProgram(options, prior, prior, None, allowed=everything).bound(0.0).ceiling
