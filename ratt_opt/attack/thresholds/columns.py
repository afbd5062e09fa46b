"""The groups of robots that an attack may leave: connected, and cut off by no more links than the budget has."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np

from ratt_opt.attack.thresholds.exact_cover import ExactCover
from ratt_opt.graph.communication import mask_of, sums_of_subsets
from ratt_opt.graph.group_list import NARROW
from ratt_opt.native.library import address, checked
from ratt_opt.native.loops import ColumnsRecord, DualsRecord, loops

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from ratt_opt._validation import IntArray
    from ratt_opt.attack.thresholds.sets_below import SetsBelow
    from ratt_opt.graph.threat import Threat

__all__ = ["UNIT", "Column", "Columns", "IntegerDuals"]


UNIT = 1 << 20
"""Unit of integer duals: one link. Reduced costs are exact with them."""


class IntegerDuals:
    """Integer duals, in units of ``1 / UNIT`` links: ``robots`` (N,) of each robot, ``blinding >= 0`` of one blinded.

    Robots of a group count their links from both sides: an attack's groups have two for each link that is cut.
    """

    def __init__(self, robots: IntArray, blinding: int) -> None:
        self.robots, self.blinding = robots, blinding

    @cached_property
    def _sums(self) -> IntArray:
        part = 12  # robots of a table of sums, as in native/src/groups.h
        padded = np.zeros((-(-len(self.robots) // part), part), np.int64)
        padded.flat[: len(self.robots)] = self.robots
        return np.ascontiguousarray([sums_of_subsets(duals) for duals in padded])

    @property
    def record(self) -> DualsRecord:
        """Record that the C code reads."""
        return DualsRecord(sums=address(self._sums), unit=UNIT, blinding=self.blinding)

    def claim(self, n_blinded: int) -> int:
        """Return the dual bound: the least cost of a cover of the team, if no column has a negative reduced cost."""
        return int(self.robots.sum()) - n_blinded * self.blinding


@dataclass(frozen=True, slots=True)
class Column:
    """A group by bit mask, the links that leave it, and the robots to blind in it."""

    group: int
    cut: int
    blinded: int


class Columns:
    """``groups`` : (C,) bit masks; ``cuts``, ``blinded`` : (C,) links that leave each, and robots to blind in it.

    Raises ``InputError`` : an array has another type or shape.
    """

    def __init__(self, robots: int, groups: NDArray[Any], cuts: NDArray[np.uint8], blinded: NDArray[np.uint8]) -> None:
        self.robots, self.groups, self.cuts, self.blinded = robots, groups, cuts, blinded
        kind, shape = np.uint32 if robots <= NARROW else np.int64, (len(groups),)
        self._record = ColumnsRecord(
            count=len(groups),
            wide=robots > NARROW,
            groups=address(checked("groups", groups, kind, shape)),
            cuts=address(checked("cuts", cuts, np.uint8, shape)),
            blinded=address(checked("blinded", blinded, np.uint8, shape)),
        )

    @classmethod
    def of(cls, groups: NDArray[np.uint32], cuts: NDArray[np.uint8], below: SetsBelow, n_blinded: int) -> Columns:
        """The groups in which blinding at most ``n_blinded`` robots leaves less than the threshold."""
        left = below.sizes[groups]  # plus one, or 0
        blinded = np.bitwise_count(groups) + np.uint8(1) - left
        kept = (left > 0) & (blinded <= n_blinded)
        return cls(below.robots, groups[kept], cuts[kept], blinded[kept])

    def __len__(self) -> int:
        return len(self.groups)

    def some(self, places: IntArray | list[int]) -> list[Column]:
        """Return the columns at some places."""
        arrays = self.groups[places], self.cuts[places], self.blinded[places]
        return [Column(*of_one) for of_one in zip(*(array.tolist() for array in arrays), strict=True)]

    def cheapest(self, duals: IntegerDuals) -> tuple[int, IntArray]:
        """The least reduced cost, and the columns, of one robot each, that have the least and a negative one."""
        cheapest = np.empty(self.robots, np.int64)
        least = loops.price(self.robots, self._record, duals.record, address(cheapest))
        return (least if len(self) else 0), np.unique(cheapest[cheapest >= 0])

    def within(self, duals: IntegerDuals, gap: int, most: int) -> tuple[Columns, IntArray] | None:
        """The columns of reduced cost at most ``gap``, by reduced cost, and these; ``None`` : more than ``most``."""
        room = min(most, len(self))
        columns, costs = np.empty(room, np.int64), np.empty(room, np.int64)
        count = loops.within_gap(self._record, duals.record, gap, room, address(columns), address(costs))
        if count > room:
            return None
        order = np.argsort(costs[:count], kind="stable")
        kept = columns[:count][order]
        return Columns(self.robots, self.groups[kept], self.cuts[kept], self.blinded[kept]), costs[:count][order]

    def covers(self, costs: IntArray, most: tuple[int, int, int]) -> ExactCover:
        """The search for attacks that leave some of these, which are sorted by reduced costs (C,).

        ``most`` : reduced costs, robots to blind and links that leave, of all groups together
        """
        paid = np.column_stack([costs, self.blinded, self.cuts]).astype(np.int64)
        return ExactCover(self.robots, self.groups[:, None].astype(np.uint64), paid, most)

    def restrict(self, robots: int, most: int, threat: Threat) -> None:
        """Know that at most ``most`` of some robots (bit mask) sense in groups that have the protected ones of these.

        Drops groups with too many robots to blind, in place.
        """
        protected = mask_of(threat.protected_robots)
        count = loops.restrict_columns(self._record, robots, most, protected, threat.n_blinded)
        self.groups, self.cuts, self.blinded = self.groups[:count], self.cuts[:count], self.blinded[:count]
