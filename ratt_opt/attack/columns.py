"""The groups of robots that an attack may leave: connected, and cut off by no more links than the budget has."""

from __future__ import annotations

from ctypes import POINTER, Structure, byref, c_int, c_int64, c_void_p
from dataclasses import dataclass
from functools import cached_property, lru_cache
from typing import TYPE_CHECKING, ClassVar

import numpy as np

from ratt_opt.graph.group_list import GroupList
from ratt_opt.native.library import address, function

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from ratt_opt._validation import IntArray
    from ratt_opt.attack.sets_below import SetsBelow
    from ratt_opt.graph.communication import CommunicationGraph, Link
    from ratt_opt.graph.threat import Threat

__all__ = ["UNIT", "Columns", "Duals", "groups_of"]


def groups_of(threat: Threat) -> GroupList:
    """The list of a threat's groups, of at most 32 robots; the last few graphs' are kept."""
    return _kept(threat.graph, threat.alpha_c, threat.protected_links)


@lru_cache(maxsize=2)
def _kept(graph: CommunicationGraph, most_cut: int, protected_links: frozenset[Link]) -> GroupList:
    return GroupList(graph, most_cut, protected_links, (np.uint32, np.uint8))


UNIT = 1 << 20
"""Of integer duals, one link: with them reduced costs are exact."""
HALF = 12


class _DualsRecord(Structure):
    _fields_: ClassVar = [("low", c_void_p), ("high", c_void_p), ("unit", c_int64), ("blinding", c_int64)]


class Duals:
    """Integer duals, in units of ``1 / UNIT`` links: ``robots`` (N,) of each robot, ``blinding >= 0`` of one blinded.

    Robots of a group count their links from both sides: an attack's groups have two for each link that is cut.
    """

    def __init__(self, robots: IntArray, blinding: int) -> None:
        self.robots, self.blinding = robots, blinding

    @cached_property
    def _sums(self) -> tuple[IntArray, IntArray]:
        return _sums_of_sets(self.robots[:HALF]), _sums_of_sets(self.robots[HALF:])

    @property
    def record(self) -> _DualsRecord:
        """As C reads it, for teams of up to 32 robots."""
        return _DualsRecord(*map(address, self._sums), UNIT, self.blinding)

    def claim(self, n_blinded: int) -> int:
        """What groups that cover the team cost at least, if no column has a negative reduced cost."""
        return int(self.robots.sum()) - n_blinded * self.blinding


def _sums_of_sets(values: IntArray) -> IntArray:
    sums = np.zeros(1 << len(values), np.int64)
    for i, value in enumerate(values):
        sums[1 << i : 2 << i] = sums[: 1 << i] + value
    return sums


@dataclass(frozen=True, slots=True)
class Columns:
    """``groups`` : (C,) bit masks; ``cuts``, ``blinded`` : (C,) links that leave each, and robots to blind in it."""

    robots: int
    groups: NDArray[np.uint32]
    cuts: NDArray[np.uint8]
    blinded: NDArray[np.uint8]

    @classmethod
    def of(cls, groups: NDArray[np.uint32], cuts: NDArray[np.uint8], below: SetsBelow, n_blinded: int) -> Columns:
        """The groups in which blinding at most ``n_blinded`` robots leaves less than the threshold."""
        call = function("keep_reachable", c_int64, c_void_p, c_int64, *[c_void_p] * 2, c_int, *[c_void_p] * 3)
        kept = np.empty_like(groups), np.empty_like(cuts), np.empty_like(cuts)
        given = address(groups), address(cuts)
        count = call(address(below.sizes), len(groups), *given, n_blinded, *map(address, kept))
        return cls(below.robots, kept[0][:count], kept[1][:count], kept[2][:count])

    def __len__(self) -> int:
        return len(self.groups)

    def cheapest(self, duals: Duals) -> tuple[int, IntArray]:
        """The least reduced cost, and the columns, of one robot each, that have the least and a negative one."""
        call = function("price", c_int64, c_int, c_int64, *[c_void_p] * 3, POINTER(_DualsRecord), c_void_p)
        cheapest = np.empty(self.robots, np.int64)
        least = call(self.robots, len(self), *self._addresses, byref(duals.record), address(cheapest))
        return (int(least) if len(self) else 0), np.unique(cheapest[cheapest >= 0])

    def within(self, duals: Duals, gap: int, most: int) -> tuple[Columns, IntArray] | None:
        """The columns of reduced cost at most ``gap``, by reduced cost, and these; ``None`` : more than ``most``."""
        call = function(
            "within_gap", c_int64, c_int64, *[c_void_p] * 3, POINTER(_DualsRecord), *[c_int64] * 2, *[c_void_p] * 2
        )
        room = min(most, len(self))
        columns, costs = np.empty(room, np.int64), np.empty(room, np.int64)
        given = len(self), *self._addresses, byref(duals.record), gap, room
        count = call(*given, address(columns), address(costs))
        if count > room:
            return None
        order = np.argsort(costs[:count], kind="stable")
        kept = columns[:count][order]
        return Columns(self.robots, self.groups[kept], self.cuts[kept], self.blinded[kept]), costs[:count][order]

    @property
    def _addresses(self) -> tuple[int, int, int]:
        return address(self.groups), address(self.cuts), address(self.blinded)
