"""Exact covers: groups of few columns that have each robot once, within the budgets."""

from __future__ import annotations

from ctypes import POINTER, Structure, byref, c_int, c_int64, c_void_p
from typing import TYPE_CHECKING, ClassVar

import numpy as np

from ratt_opt.native.library import address, checked, function

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from ratt_opt._validation import BoolArray, IntArray
    from ratt_opt.budget import Budget

__all__ = ["ExactCover", "packed"]

LEVEL = np.dtype(
    [
        ("room", np.int64, 3),
        *((name, np.int64) for name in ("start", "end", "position")),
        *((name, np.int32) for name in ("robot", "column")),
    ]
)
STEPS = 2_000_000
"""Columns looked at between two looks at the clock: some milliseconds."""
FOUND, NONE, PAUSED = 1, 0, -1
WORD = 64


class CoverRecord(Structure):
    """``Cover`` of ``native/src/records.h``."""

    _fields_: ClassVar = [
        *((name, c_int64) for name in ("robots", "words", "room")),
        *((name, c_void_p) for name in ("groups", "costs", "fitting", "levels", "left", "counts")),
        *((name, c_int64) for name in ("depth", "nodes", "most_nodes")),
    ]


def packed(groups: BoolArray) -> NDArray[np.uint64]:
    """(K, W) the groups (K, N) as masks of W words, robot ``i`` bit ``i % 64`` of word ``i // 64``."""
    count, robots = groups.shape
    wide = np.zeros((count, -(-robots // WORD) * WORD), np.uint8)
    wide[:, :robots] = groups
    return np.packbits(wide, axis=1, bitorder="little").view("<u8").astype(np.uint64)


class ExactCover:
    """The search for a cover of ``robots`` robots by columns that are sorted by reduced cost.

    ``groups`` : (K, W) masks, as of :func:`packed`; ``costs`` : (K, 3) reduced costs, robots to blind and links that
    leave, each >= 0; ``most`` : (3,) these of a cover
    """

    def __init__(self, robots: int, groups: NDArray[np.uint64], costs: IntArray, most: tuple[int, int, int]) -> None:
        count, words = len(groups), -(-robots // WORD)
        self._levels, self._left = np.zeros(robots + 2, LEVEL), np.zeros((robots + 2, words), np.uint64)
        self._levels[0] = most, 0, count, 0, -1, -1
        self._left[0] = packed(np.ones((1, robots), dtype=np.bool_))
        fitting = np.empty((robots + 1) * count, np.int32)  # at most all at each level; mostly never touched
        fitting[:count] = np.arange(count, dtype=np.int32)
        self._arrays = (  # the record has their addresses only
            checked("groups", np.ascontiguousarray(groups), np.uint64, (count, words)),
            checked("costs", np.ascontiguousarray(costs), np.int64, (count, 3)),
            *(fitting, self._levels, self._left, np.zeros(robots, np.int64)),
        )
        self._record = CoverRecord(robots, words, len(fitting), *map(address, self._arrays), 0, 0, 0)

    def found(self, budget: Budget) -> list[int]:
        """Places of the columns of the next cover, none if there is none; raises ``OutOfBudget`` as :meth:`next`."""
        places = None
        while places is None:
            places = self.next(budget, STEPS)
        return places if isinstance(places, list) else []

    def next(self, budget: Budget, steps: int) -> list[int] | bool | None:
        """Places of the columns of a cover; ``False`` if there is none, ``None`` once ``steps`` were looked at.

        Raises
        ------
        OutOfBudget : nodes or seconds are spent, or the user interrupted; the search goes on where it was.
        """
        call, record = function("next_cover", c_int, POINTER(CoverRecord), c_int64), self._record
        answer, left = PAUSED, steps
        while answer == PAUSED and left > 0:
            before = record.nodes
            record.most_nodes = before + budget.nodes_left(STEPS)
            answer = call(byref(record), min(STEPS, left))
            left -= STEPS
            budget.nodes += record.nodes - before
        if answer == FOUND:
            return [int(k) for k in self._levels["column"][: record.depth + 1]]
        return False if answer == NONE else None
