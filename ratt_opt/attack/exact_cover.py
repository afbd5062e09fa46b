"""Exact covers: groups of few columns that have each robot once, within the budgets."""

from __future__ import annotations

from ctypes import byref, c_int, c_int64, c_void_p
from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.native.library import address, function

if TYPE_CHECKING:
    from ratt_opt._validation import IntArray
    from ratt_opt.attack.columns import Columns
    from ratt_opt.budget import Budget

__all__ = ["ExactCover"]

LEVEL = np.dtype(
    [
        *((name, np.int64) for name in ("gap", "start", "end", "position")),
        ("left", np.uint32),
        *((name, np.int32) for name in ("robot", "blinded", "cut", "column", "unused")),
    ]
)
STEPS = 2_000_000
"""Columns looked at between two looks at the clock: some milliseconds."""
FOUND, NONE, PAUSED = 1, 0, -1


class ExactCover:
    """The search for a cover by columns, sorted by reduced cost, whose ``costs`` add up to ``gap`` at most.

    ``n_blinded``, ``most_cut`` : the budgets, links counted from both sides
    """

    def __init__(self, columns: Columns, costs: IntArray, gap: int, n_blinded: int, most_cut: int) -> None:
        self._columns, self._costs = columns, costs
        count, robots = len(columns), columns.robots
        self._levels = np.zeros(robots + 2, LEVEL)
        self._levels[0] = gap, 0, count, 0, 2**robots - 1, -1, n_blinded, most_cut, -1, 0
        self._fitting = np.empty((robots + 1) * count, np.int32)  # at most all at each level; mostly never touched
        self._fitting[:count] = np.arange(count, dtype=np.int32)
        self._depth, self._nodes = c_int64(0), c_int64(0)

    def next(self, budget: Budget, steps: int) -> list[int] | bool | None:
        """The groups of a cover; ``False`` if there is none, ``None`` once ``steps`` columns were looked at.

        Raises
        ------
        OutOfBudget : nodes or seconds are spent, or the user interrupted; the search goes on where it was.
        """
        call = function("next_cover", c_int, *[c_void_p] * 5, c_int64, *[c_void_p] * 3, c_int64)
        columns = self._columns
        arrays = columns.groups, columns.cuts, columns.blinded, self._costs, self._fitting
        places = address(self._levels), byref(self._depth), byref(self._nodes)
        answer, left = PAUSED, steps
        while answer == PAUSED and left > 0:
            budget.nodes_left(1)
            before = self._nodes.value
            answer = call(*map(address, arrays), len(self._fitting), *places, min(STEPS, left))
            left -= STEPS
            budget.nodes += self._nodes.value - before
        if answer == FOUND:
            chosen = self._levels["column"][: self._depth.value + 1]
            return [int(mask) for mask in columns.groups[chosen]]
        return False if answer == NONE else None
