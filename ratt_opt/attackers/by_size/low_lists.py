"""All sets of one size whose value is below a threshold, as bit masks.

A depth-first search over the robots in the order given. With ``q`` robots still to choose, the information of a set is
the average, over the robots ``i`` chosen, of what ``q`` copies of ``i`` would give; the value is concave in the
information, so it is at least the average ``(1/q) sum_i value(q copies of i)``. With the next robot fixed the others
contribute at least the smallest of the rest.
"""

from __future__ import annotations

from ctypes import POINTER, Structure, byref, c_double, c_int, c_int64, c_void_p
from dataclasses import dataclass
from typing import TYPE_CHECKING, ClassVar

import numpy as np

from ratt_opt.attack.team import TeamRecord
from ratt_opt.budget import OutOfBudget, Stop
from ratt_opt.native.library import address, checked, function

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from ratt_opt._validation import BoolArray, FloatArray, IntArray
    from ratt_opt.attackers.weakest_set.packed_team import PackedTeam
    from ratt_opt.budget import Budget

    MaskArray = NDArray[np.uint64]

__all__ = ["MOST_ROBOTS", "Filter", "LowList", "list_low_sets", "spend_look"]

MOST_ROBOTS = 63
"""A set is one 64-bit mask."""
WORK = 10_000_000
"""Criteria of single targets between two looks at the clock: a tenth of a second or less."""
QUICK = 4_000_000
"""The same for a list that is wanted only if it is short."""
NODES_OF_A_LOOK = 10_000
"""Nodes that the work between two looks counts as: about as many partial sets are looked at."""
LONGEST = 200
"""Looks at the clock before a list is given up, ten seconds or so: what is that long to list is longer to search."""
MOST_SETS = 2_000_000
"""Sets listed at most: 32 MiB, and about a second for each bound that goes through them."""


@dataclass(frozen=True, slots=True)
class LowList:
    """``masks`` (K,) of the sets of ``size`` robots found, and their ``values`` (K,), lowest first."""

    size: int
    masks: MaskArray
    values: FloatArray

    def where(self, kept: BoolArray) -> LowList:
        """Those that are kept (K,)."""
        return LowList(self.size, self.masks[kept], self.values[kept])

    def below(self, threshold: float) -> LowList:
        """Those worth less than a threshold."""
        count = int(np.searchsorted(self.values, threshold))
        return LowList(self.size, self.masks[:count], self.values[:count])


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


def list_low_sets(
    team: PackedTeam, order: IntArray, size: int, wanted: Filter, budget: Budget, *, quick: bool = False
) -> LowList | None:
    """Every set of ``size`` robots that is wanted, or ``None`` where they are too many or too long to find.

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
        spend_look(budget)
        if listing.go_on(QUICK if quick else WORK):
            return listing.found()
        if listing.count > MOST_SETS:
            return None
    return None


class LowSetsRecord(Structure):
    """``LowSets`` of ``native/src/records.h``."""

    _fields_: ClassVar = [
        *((name, c_double) for name in ("threshold", "room")),
        *((name, c_int64) for name in ("size", "capacity")),
        *((name, c_void_p) for name in ("costs", "position", "counters", "sums", "worths", "smallest", "spent")),
        *((name, c_void_p) for name in ("sets", "values")),
    ]


class _Listing:
    """A search that goes on where it ended; its first robot is the last of ``order``."""

    def __init__(self, team: PackedTeam, order: IntArray, size: int, wanted: Filter) -> None:
        self._team = team.native(order[::-1])
        n_robots, self._size = len(order), size
        costs = np.ascontiguousarray(wanted.costs[::-1], dtype=np.float64)
        sums = np.zeros((size + 1, *team.prior.shape))
        sums[0] = team.prior
        self._counters = np.zeros(2, np.int64)
        self._state = (
            checked("costs", costs, np.float64, (n_robots,)),
            np.zeros(size + 1, np.int64),
            self._counters,
            sums,
            np.zeros((size + 1, n_robots + 1)),
            np.zeros((size + 1, n_robots + 1)),
            np.zeros(size + 1),
        )
        self._spare = np.zeros(size + 1), np.zeros(team.prior.shape)
        self._masks, self._values = np.zeros(4096, np.uint64), np.zeros(4096)
        self._limits = float(wanted.threshold), float(wanted.room)

    @property
    def count(self) -> int:
        """Sets found."""
        return int(self._counters[1])

    def go_on(self, work: int) -> bool:
        """Whether every set is decided."""
        if self.count + self._team.robots >= len(self._masks):
            self._masks = np.concatenate([self._masks, np.zeros_like(self._masks)])
            self._values = np.concatenate([self._values, np.zeros_like(self._values)])
        places = *map(address, self._state), address(self._masks), address(self._values)
        record = LowSetsRecord(*self._limits, self._size, len(self._masks), *places)
        call = function(
            "list_low_sets", c_int, POINTER(TeamRecord), POINTER(LowSetsRecord), c_int64, c_void_p, c_void_p
        )
        return bool(call(self._team.reference, byref(record), work, *map(address, self._spare)))

    def found(self) -> LowList:
        """The sets, lowest first."""
        ranked = np.argsort(self._values[: self.count], kind="stable")
        return LowList(self._size, self._masks[ranked], self._values[ranked])


def spend_look(budget: Budget) -> None:
    """Count the nodes of the work until the next look at the clock.

    Raises
    ------
    OutOfBudget : the time is up, or so many nodes are not left.
    """
    if budget.nodes_left(NODES_OF_A_LOOK) < NODES_OF_A_LOOK:
        raise OutOfBudget(Stop.NODES)
    budget.spend(NODES_OF_A_LOOK)
