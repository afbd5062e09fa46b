"""Covers: conditions that every plan worth more than a level meets, and those found so far.

Cut some links. Of each group that is left keep elements such that no choice of kept ones is worth more than the level.
Take a plan of which at most ``alpha_s`` robots choose an element that is left out. Blind these robots: what the
others choose is kept, and robots that are blinded add nothing, so no group is worth more than the level. Hence

    a plan worth more has at least ``alpha_s + 1`` robots with an element that is left out.

A robot that is protected cannot be blinded, so one such robot with an element left out is enough: its elements count
``alpha_s + 1`` times. That a group is worth no more is shown by one tangent: a constant and, robot by robot, the
largest score of a kept element, or 0.

Source: combinatorial Benders cuts (Codato and Fischetti 2006), lifted.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.bounds.cuts import ROUNDING, tangent_cut
from ratt_opt.native.library import address
from ratt_opt.native.loops import CoversRecord

if TYPE_CHECKING:
    from ratt_opt._validation import BoolArray, FloatArray
    from ratt_opt.problem import Problem
    from ratt_opt.solvers.maxmin.covers.choices import CoverChoices
    from ratt_opt.solvers.maxmin.params import SeparationParams
    from ratt_opt.solvers.maxmin.proof import Cover

__all__ = ["CoverPool", "cover_bound"]


def cover_bound(problem: Problem, cover: Cover) -> float:
    """No plan that fails the cover is worth more under the attacks that it stands for."""
    kept = np.ones(problem.objective.n, dtype=np.bool_)
    kept[list(cover.left_out)] = False
    groups = sorted(map(sorted, problem.groups_left(cover.attack)))
    return max(_kept_bound(problem, group, kept, point) for group, point in zip(groups, cover.points, strict=True))


def _kept_bound(problem: Problem, group: list[int], kept: BoolArray, point: FloatArray) -> float:
    """No choice of kept elements of a group is worth more."""
    cut = tangent_cut(problem, tuple(group), point)
    largest = np.zeros(problem.n_robots)
    np.maximum.at(largest, problem.robot[kept], cut.scores[kept])
    total = float(largest.sum())
    return cut.constant + total + ROUNDING * (abs(cut.constant) + total)


class CoverPool:
    """Covers over the elements of one problem, in arrays that grow: compiled loops read them and add to them.

    ``masks`` : (K, N) of the elements left out; ``partition`` : (K,) its number
    ``sums`` : (K, S, M, T) posterior information at which the tangents of the partition's groups touch
    ``level`` : (K,) the least level that the cover is true for
    """

    def __init__(self, choices: CoverChoices, params: SeparationParams) -> None:
        self._choices, self._params = choices, params
        self._known: dict[tuple[int, bytes], int] = {}
        self._counted = 0
        self._dense = np.zeros((0, choices.elements.count))
        self._hold(params.room, 1)

    def _hold(self, room: int, groups: int) -> None:
        """Begin empty arrays for that many covers, of partitions into that many groups at most."""
        self.masks = np.zeros((room, len(self._choices.safe)), np.uint64)
        self.partition, self.level = np.zeros(room, np.int64), np.zeros(room)
        self.sums = np.zeros((room, groups, *self._choices.elements.prior.shape))
        self._arrays = self.masks, self.partition, self.sums, self.level
        self.record = CoversRecord(
            size=0,
            room=room,
            groups=groups,
            left_out=address(self.masks),
            partition=address(self.partition),
            sums=address(self.sums),
            level=address(self.level),
        )

    def __len__(self) -> int:
        return int(self.record.size)

    def make_room(self, groups: int) -> None:
        """Grow if there is no room for another cover, or for partitions into that many groups."""
        size, room, widest = len(self), int(self.record.room), int(self.record.groups)
        if size < room and groups <= widest:
            return
        old = self._arrays
        self._hold(room if size < room else 2 * room, max(groups, widest))
        self.record.size = size
        for new, was in zip(self._arrays, old, strict=True):
            new[tuple(map(slice, was.shape))] = was

    def add(self, partition: int, left_out: BoolArray, sums: list[FloatArray], level: float) -> int:
        """Add a cover unless it is known; its number. ``left_out`` : (E,)"""
        masks = self._choices.masks_of(left_out)
        self._count()
        if (known := self._known.get((partition, masks.tobytes()))) is not None:
            if level < self.level[known]:
                self.level[known], self.sums[known, : len(sums)] = level, sums
            return known
        self.make_room(len(sums))
        k = len(self)
        self.masks[k], self.partition[k], self.level[k] = masks, partition, level
        self.sums[k, : len(sums)] = sums
        self.record.size = k + 1
        self._count()
        return k

    def left_out(self, cover: int) -> BoolArray:
        """(E,) which elements a cover leaves out."""
        return self._choices.in_masks(self.masks[cover])

    def violated(self, price: FloatArray, enough: float, level: float, most: int) -> list[int]:
        """The ``most`` worst covers, true for a level, of which less than ``enough`` is paid.

        ``price`` : (E,) paid
        """
        self._count()
        counted = self._dense[: len(self)] @ price
        found = np.flatnonzero((counted < enough - self._params.negligible) & (self.level[: len(self)] <= level))
        return [int(k) for k in found[np.argsort(counted[found], kind="stable")][:most]]

    def keep_latest(self, count: int) -> None:
        """Forget all but the covers that were found last; they are numbered anew."""
        first = max(len(self) - count, 0)
        for array in self._arrays:
            array[: len(self) - first] = array[first : len(self)].copy()
        self.record.size = len(self) - first
        self._known.clear()
        self._counted = 0
        self._count()

    def _count(self) -> None:
        """Number the covers that compiled loops added."""
        for k in range(self._counted, len(self)):
            self._known.setdefault((int(self.partition[k]), self.masks[k].tobytes()), k)
        if self._counted < len(self):
            fresh = np.array([self.left_out(k) for k in range(self._counted, len(self))], dtype=np.float64)
            self._dense = np.concatenate([self._dense[: self._counted], fresh])
        self._counted = len(self)
