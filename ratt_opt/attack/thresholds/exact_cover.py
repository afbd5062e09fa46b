"""Exact covers: groups of few columns that have each robot once, within the budgets."""

from __future__ import annotations

from enum import IntEnum
from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.native.library import address, checked
from ratt_opt.native.loops import CoverRecord, LevelRecord, loops

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from ratt_opt._validation import BoolArray, IntArray
    from ratt_opt.budget import Budget

__all__ = ["ExactCover", "packed"]

STEPS = 2_000_000
"""Columns looked at between two looks at the clock: some milliseconds."""


class CoverVerdict(IntEnum):
    """Answer to the search for a cover."""

    PAUSED = -1
    NONE = 0
    FOUND = 1


def packed(groups: BoolArray) -> NDArray[np.uint64]:
    """(K, W) the groups (K, N) as masks of W words, robot ``i`` bit ``i % 64`` of word ``i // 64``."""
    count, robots = groups.shape
    wide = np.zeros((count, -(-robots // 64) * 64), np.uint8)
    wide[:, :robots] = groups
    return np.packbits(wide, axis=1, bitorder="little").view("<u8").astype(np.uint64)


class ExactCover:
    """The search for a cover of ``robots`` robots by columns that are sorted by reduced cost.

    ``groups`` : (K, W) masks, as of :func:`packed`; ``costs`` : (K, 3) reduced costs, robots to blind and links that
    leave, each >= 0; ``most`` : (3,) these of a cover
    """

    def __init__(self, robots: int, groups: NDArray[np.uint64], costs: IntArray, most: tuple[int, int, int]) -> None:
        count, words = groups.shape
        self._levels, self._left = np.zeros(robots + 2, LevelRecord), np.zeros((robots + 2, words), np.uint64)
        self._levels[0] = most, 0, count, 0, -1, -1
        self._left[0] = packed(np.ones((1, robots), dtype=np.bool_))
        fitting = np.empty((robots + 1) * count, np.int32)  # at most all at each level; mostly never touched
        fitting[:count] = np.arange(count, dtype=np.int32)
        groups, costs, counts = np.ascontiguousarray(groups), np.ascontiguousarray(costs), np.zeros(robots, np.int64)
        self._arrays = groups, costs, fitting, counts  # the record has their addresses only
        self._record = CoverRecord(
            robots=robots,
            words=words,
            room=len(fitting),
            groups=address(checked("groups", groups, np.uint64, (count, words))),
            costs=address(checked("costs", costs, np.int64, (count, 3))),
            fitting=address(fitting),
            levels=address(self._levels),
            left=address(self._left),
            counts=address(counts),
            depth=0,
            nodes=0,
            most_nodes=0,
        )

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
        record, left = self._record, steps
        answer: int = CoverVerdict.PAUSED
        while answer == CoverVerdict.PAUSED and left > 0:
            before = record.nodes
            record.most_nodes = before + budget.nodes_left(STEPS)
            answer = loops.next_cover(record, min(STEPS, left))
            left -= STEPS
            budget.nodes += record.nodes - before
        if answer == CoverVerdict.FOUND:
            return [int(k) for k in self._levels["column"][: record.depth + 1]]
        return False if answer == CoverVerdict.NONE else None
