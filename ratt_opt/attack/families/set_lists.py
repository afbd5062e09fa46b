"""All sets of one size whose value is below a threshold, as bit masks.

Found by the search in depth of ``least_sets/sets_of_size.py``.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.attack.least_sets.sets_of_size import SetSearch

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from ratt_opt._validation import BoolArray, FloatArray, IntArray
    from ratt_opt.attack.least_sets.packed_team import PackedTeam
    from ratt_opt.budget import Budget

    MaskArray = NDArray[np.uint64]

__all__ = ["MOST_ROBOTS", "Filter", "SetList", "list_sets"]

MOST_ROBOTS = 63
"""A set is one 64-bit mask."""
QUICK = 2_000
"""Partial sets looked at for a list that is wanted only if it is short."""
NODES_OF_A_LOOK = 10_000
"""Partial sets between two looks at the clock: some hundredths of a second."""
LONGEST = 200
"""Looks at the clock before a list is given up, ten seconds or so: what is that long to list is longer to search."""
MOST_SETS = 2_000_000
"""Sets listed at most: 32 MiB, and about a second for each bound that goes through them."""


@dataclass(frozen=True, slots=True)
class SetList:
    """``masks`` (K,) of the sets of ``size`` robots found, and their ``values`` (K,), lowest first."""

    size: int
    masks: MaskArray
    values: FloatArray

    def where(self, kept: BoolArray) -> SetList:
        """Those that are kept (K,)."""
        return SetList(self.size, self.masks[kept], self.values[kept])

    def below(self, threshold: float) -> SetList:
        """Those worth less than a threshold."""
        count = int(np.searchsorted(self.values, threshold))
        return SetList(self.size, self.masks[:count], self.values[:count])


@dataclass(frozen=True, slots=True)
class Filter:
    """Only sets worth less than ``threshold`` whose robots' ``costs`` (F,) add up to less than ``room`` are listed."""

    threshold: float
    costs: FloatArray
    room: float = np.inf

    @classmethod
    def below(cls, threshold: float, n_robots: int) -> Filter:
        """No costs."""
        return cls(threshold, np.zeros(n_robots))


def list_sets(
    team: PackedTeam, order: IntArray, size: int, wanted: Filter, budget: Budget, *, quick: bool = False
) -> SetList | None:
    """Every set of ``size`` robots that is wanted, or ``None`` if they are too many or too long to find.

    Parameters
    ----------
    order : (F,) robots to choose from, F <= 63; bit ``k`` of a mask is ``order[k]``; strongest first is best, as
        the search goes from the last to the first
    quick : give up before the first look at the clock, after a few milliseconds

    Raises
    ------
    OutOfBudget : the time is up, or too few nodes are left for the next look at the clock.
    """
    listing = _Listing(team, order, size, wanted)
    for _ in range(1 if quick else LONGEST):
        most = budget.nodes_left(QUICK if quick else NODES_OF_A_LOOK)
        before = listing.nodes
        finished = listing.go_on(most)
        budget.nodes += listing.nodes - before
        if finished:
            return listing.found()
        if listing.count > MOST_SETS:
            return None
    return None


class _Listing:
    """A search that goes on from where it ended."""

    def __init__(self, team: PackedTeam, order: IntArray, size: int, wanted: Filter) -> None:
        costs = np.ascontiguousarray(wanted.costs, dtype=np.float64) if np.isfinite(wanted.room) else None
        self._search = SetSearch(team.native(order), size, wanted.threshold, costs=costs, limit=wanted.room)
        self._size, self.count = size, 0
        self._masks, self._values = np.zeros(4096, np.uint64), np.zeros(4096)

    @property
    def nodes(self) -> int:
        """Partial sets looked at."""
        return self._search.nodes

    def go_on(self, nodes: int) -> bool:
        """Whether every set is decided."""
        stop = self._search.nodes + nodes
        while self._search.nodes < stop and self.count <= MOST_SETS:
            if self.count == len(self._masks):
                self._masks = np.concatenate([self._masks, np.zeros_like(self._masks)])
                self._values = np.concatenate([self._values, np.zeros_like(self._values)])
            left = stop - self._search.nodes
            self.count, is_finished = self._search.fill(left, self._masks, self._values, self.count)
            if is_finished:
                return True
        return False

    def found(self) -> SetList:
        """The sets, lowest first."""
        ranked = np.argsort(self._values[: self.count], kind="stable")
        return SetList(self._size, self._masks[ranked], self._values[ranked])
