"""Brackets of the marginals of every element, the least certain ratio refined first."""

from __future__ import annotations

from abc import ABC, abstractmethod
from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.curvatures.marginals import Marginals
from ratt_opt.stopping import Stop

if TYPE_CHECKING:
    from ratt_opt._validation import BoolArray, FloatArray
    from ratt_opt.budget import Budget

__all__ = ["MarginalBrackets"]

TOUCHING = 1e-9
"""Ratios that differ by less, relatively, meet: the safety margins for rounding keep them apart."""


class MarginalBrackets(ABC):
    """(n,) ``least`` <= smallest marginals <= ``seen_least``, ``seen_most`` <= largest marginals <= ``most``.

    The element whose ratio ``least / most`` is the smallest decides the curvature: it is refined until the smallest
    ratio of all is known within the gap, or the budget is spent. Parts bounded count as the budget's nodes.

    Parameters
    ----------
    single : (n,) values alone, which every marginal without context attains
    gap : the search stops once the smallest ratio seen is at most ``1 + gap`` times the smallest proved
    """

    def __init__(self, single: FloatArray, gap: float, budget: Budget) -> None:
        self._gap, self._budget = gap, budget
        self.least, self.most = np.zeros(len(single)), single.copy()
        self.seen_least, self.seen_most = single.copy(), single.copy()
        self._done: BoolArray = np.zeros(len(single), dtype=np.bool_)

    def run(self) -> Stop:
        """Search until the deciding ratio is known within the gap, or the budget is spent."""
        try:
            stop = self._begin()
            while stop is None:
                stop = self._step()
        except KeyboardInterrupt:
            return self._budget.interrupt()
        return stop

    def marginals(self) -> Marginals:
        """What is known, with the contexts that attain the ends."""
        smallest, largest = self._attaining()
        return Marginals(self.least, self.seen_least, self.seen_most, self.most, tuple(smallest), tuple(largest))

    def _begin(self) -> Stop | None:
        """What to do for all elements before the first is refined; why to stop already, if at all."""
        return None

    @abstractmethod
    def _refine(self, x: int, target: float) -> None:
        """Raise the ratio proved of ``x`` towards a target, or show it to be smaller; record both and the nodes."""

    @abstractmethod
    def _attaining(self) -> tuple[list[tuple[int, ...]], list[tuple[int, ...]]]:
        """Contexts that attain ``seen_least`` and ``seen_most``, once what an interrupt left unrecorded is recorded."""

    def _step(self) -> Stop | None:
        """Refine the least certain ratio; return why to stop instead."""
        safe, shown = _ratios(self.least, self.most), self._shown()
        target = float(shown.min(initial=np.inf)) / (1 + self._gap)
        open_ = np.flatnonzero((safe < target) & ~self._done)
        if not len(open_):
            if (safe >= shown * (1 - TOUCHING)).all():
                return Stop.CLOSED
            return Stop.GAP if safe.min() >= target * (1 - TOUCHING) else Stop.EXHAUSTED
        if stop := self._budget.stop():
            return stop
        self._refine(int(open_[safe[open_].argmin()]), target)
        return None

    def _shown(self) -> FloatArray:
        """(n,) ratios attained."""
        return _ratios(self.seen_least, self.seen_most)


def _ratios(small: FloatArray, large: FloatArray) -> FloatArray:
    """Infinite where the large one is 0: such elements restrict nothing."""
    useful = large > 0
    return np.where(useful, small / np.where(useful, large, 1.0), np.inf)
