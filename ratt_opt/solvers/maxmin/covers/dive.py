"""A search in depth (``native/src/cover_dive.c``) that runs on and on, the plan that it meets, and its proof."""

from __future__ import annotations

from ctypes import byref, c_double, c_int, c_int64, c_void_p
from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.native.library import function
from ratt_opt.solvers.maxmin.covers.tables import Record, Stack
from ratt_opt.solvers.maxmin.levels.level_search import Outcome

if TYPE_CHECKING:
    from ratt_opt._validation import BoolArray, IntArray
    from ratt_opt.solvers.maxmin.covers.separation import Separation
    from ratt_opt.solvers.maxmin.covers.sums import CoverSums

__all__ = ["Dive"]

FIRST_RECORD, MOST_RECORDED = 4096, 4_000_000
"""Nodes of a record: it grows, to 160 MB at most."""
MOST_WAYS = 10
"""Partitions that are tried at a node, those that last led to a dead end first."""


class Dive:
    """A search over all plans."""

    def __init__(self, separation: Separation, sums: CoverSums) -> None:
        self._separation, self._sums, self._choices = separation, sums, separation.choices
        self.record, self._stack = Record(FIRST_RECORD), Stack(separation.choices)

    @property
    def frame(self) -> int:
        """The frame that it is in."""
        return self._stack.frame

    @property
    def is_long(self) -> bool:
        """Whether its record is as long as memory should hold."""
        return self.record.size >= MOST_RECORDED

    def run(self, level: float, nodes: int) -> Outcome:
        """Search on; how that ended. Makes room in what is full first."""
        pool, ways, sums = self._separation.pool, self._separation.ways(), self._sums.rows()
        if len(pool) == pool.covers.room or ways.widest > pool.covers.groups:
            pool.grow(ways.widest)
        self.record.make_room(self._choices.elements.count + 1)
        tables = self._choices, ways, pool.covers, sums, self._stack, self.record
        call = function("dive_by_covers", c_int, *[c_void_p] * 6, c_double, *[c_int64] * 2, c_void_p)
        outcome = c_int(Outcome.SPENT)
        if call(*(byref(table.record) for table in tables), level, nodes, MOST_WAYS, byref(outcome)):
            raise MemoryError
        return Outcome(outcome.value)

    def allowed(self, frame: int) -> BoolArray:
        """(E,) elements that are allowed in a frame."""
        masks = self._stack.allowed[frame][self._choices.owner]
        return np.asarray(masks >> self._choices.bit.astype(np.uint64) & np.uint64(1), dtype=np.bool_)

    def plan(self) -> IntArray:
        """(N,) the plan that is left."""
        masks, element = self._stack.allowed[self.frame], self._choices.element
        return np.array([element[i, int(mask).bit_length() - 1] for i, mask in enumerate(masks)])
