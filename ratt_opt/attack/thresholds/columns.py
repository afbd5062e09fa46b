"""The groups of robots that an attack may leave, as columns, and what covers of the team by them cost at least.

A group is connected, and cut off by no more links than the budget has. The linear program over groups is

    minimise    sum cut(C) x_C
    subject to  each robot in exactly one chosen group   [duals u_i]
                sum blinded(C) x_C <= alpha_s            [dual -m]

HiGHS suggests ``u`` and ``m``. Rounded to integers they are a bound by themselves: of groups that cover the team each
costs at least ``u(C) - m blinded(C)`` plus the least reduced cost of all columns. If all columns are listed
(:func:`best_duals`), these are looked through; otherwise pricing bounds them (``dual_prices.py``).

Source: Johnson, Mehrotra and Nemhauser, Min-cut clustering, Mathematical Programming 62 (1993).
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from math import inf
from typing import TYPE_CHECKING, Any

import numpy as np

from ratt_opt.attack.thresholds.exact_cover import ExactCover
from ratt_opt.graph.communication import mask_of, robots_of, sums_of_subsets
from ratt_opt.graph.group_list import NARROW
from ratt_opt.highs import LinearProgram, rows_of
from ratt_opt.native.library import address, checked
from ratt_opt.native.loops import ColumnsRecord, DualsRecord, loops

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from numpy.typing import ArrayLike, NDArray

    from ratt_opt._validation import FloatArray, IntArray
    from ratt_opt.attack.params.groups import MasterParams
    from ratt_opt.attack.thresholds.sets_below import SetsBelow
    from ratt_opt.budget import Budget
    from ratt_opt.graph.threat import Threat
    from ratt_opt.highs import Rows

__all__ = ["UNIT", "Column", "Columns", "DualBound", "IntegerDuals", "best_duals", "dual_program", "reduced_cost_rows"]


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


@dataclass(frozen=True, slots=True)
class DualBound:
    """``duals`` : under which no column has a negative reduced cost; ``columns`` : of the program.

    ``used`` : columns of which the last solution takes a part
    """

    duals: IntegerDuals
    columns: list[Column]
    used: list[Column]


def best_duals(  # noqa: PLR0917
    columns: Columns, n_blinded: int, most_cut: int, budget: Budget, params: MasterParams, first: Iterable[Column] = ()
) -> DualBound:
    """The best duals under which no column has a negative reduced cost, or some that claim more than ``most_cut``.

    ``first`` : columns that the program begins with

    Raises
    ------
    OutOfBudget : the time is up, or the user interrupted.
    """
    n = columns.robots
    program = dual_program(n, n_blinded, 4.0 * (most_cut + n**2))
    best, known, parts = IntegerDuals(np.zeros(n, np.int64), 0), dict.fromkeys(first), np.zeros(0)
    program.add_rows(_rows(list(known), n))
    while best.claim(n_blinded) <= most_cut * UNIT:
        budget.check()
        claimed = program.solve()
        duals, parts = _rounded(claimed.x, n), np.abs(claimed.duals)
        if duals is None:
            break  # HiGHS has nothing to say; what is known stays true
        least, cheapest = columns.cheapest(duals)
        if least < 0:  # every group has a robot, so that this makes up for it
            duals = IntegerDuals(duals.robots + least, duals.blinding)
        if duals.claim(n_blinded) > best.claim(n_blinded):
            best = duals
        fresh = [one for one in columns.some(cheapest) if one not in known]
        if not fresh:
            break
        known.update(dict.fromkeys(fresh))
        program.add_rows(_rows(fresh, n))
    entered = list(known)
    return DualBound(best, entered, [entered[k] for k in np.flatnonzero(parts > params.used)])


def _rounded(claimed: FloatArray, n: int) -> IntegerDuals | None:
    if len(claimed) != n + 1 or not np.isfinite(claimed).all():
        return None
    return IntegerDuals(np.floor(claimed[:n] * UNIT).astype(np.int64), max(int(np.ceil(claimed[n] * UNIT)), 0))


def _rows(columns: Sequence[Column], robots: int) -> Rows:
    groups = [(robots_of(column.group), column.blinded) for column in columns]
    return reduced_cost_rows(groups, [column.cut for column in columns], robots)


def dual_program(robots: int, n_blinded: int, largest: float) -> LinearProgram:
    """The dual without a column: prices of robots, of either sign, and of a blinded one, up to ``largest`` in size."""
    lower = np.append(np.full(robots, -largest), 0.0)
    return LinearProgram(np.append(np.ones(robots), -float(n_blinded)), lower, largest, maximise=True)


def reduced_cost_rows(groups: Iterable[tuple[list[int], int]], cuts: ArrayLike, robots: int) -> Rows:
    """Build the rows that no group has a negative reduced cost.

    ``groups`` : robots of each group, and how many of them are blinded
    """
    entries = [([*members, robots], [*[1.0] * len(members), -float(need)]) for members, need in groups]
    return rows_of(entries, -inf, cuts)
