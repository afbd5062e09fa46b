"""Sets of robots worth less than a threshold, and the largest of these inside every set."""

from __future__ import annotations

from ctypes import byref, c_double, c_int64
from math import inf
from typing import TYPE_CHECKING, Any

import numpy as np

from ratt_opt.attack.team import Team
from ratt_opt.errors import InputError
from ratt_opt.native.library import address, checked
from ratt_opt.native.loops import loops

if TYPE_CHECKING:
    from collections.abc import Iterable

    from numpy.typing import NDArray

    from ratt_opt._validation import FloatArray
    from ratt_opt.budget import Budget

__all__ = ["SetsBelow"]

BLOCK = 12
"""Robots whose sets make a block, as in native/src/thresholds.c."""


class SetsBelow:
    """Size of the largest subset worth less than a threshold, for each set of robots (bit mask).

    ``source`` : a :class:`Team`, whose sets are worth no less than those inside them, or (2**N,) the values of all sets
    ``protected`` : robots that cannot be blinded, and so are in every set inside
    ``groups`` : bit masks; only sets matter that blinding at most ``n_blinded`` robots leaves of one of them
    ``at_once`` : values of a table between two looks at the clock, some milliseconds
    ``sizes`` : (2**N,) these sizes, plus one; 0 for none, or if it does not matter
    """

    def __init__(
        self,
        source: Team | FloatArray,
        protected: Iterable[int] = (),
        groups: NDArray[np.uint32] | None = None,
        n_blinded: int | None = None,
        at_once: int = 1 << 18,
    ) -> None:
        self.source, self._protected = source, frozenset(protected)
        if isinstance(source, Team):
            self.robots = source.robots
        else:
            self.robots = len(source).bit_length() - 1
            checked("values", source, np.float64, (2**self.robots,))
        if not self.robots <= 32:  # bits of a mask
            raise InputError("values", "must be of at most 32 robots", self.robots)
        self.sizes = np.empty(2**self.robots, np.uint8)
        self._outside, self._inside = _fewest_blinded(self.robots, groups)
        self._at_once = at_once
        self._n_blinded = self.robots if n_blinded is None else n_blinded

    def mark(self, threshold: float, budget: Budget) -> tuple[float, int | None]:
        """Set ``sizes``; the least value met that is not below, and its set: infinite and ``None`` if all are below.

        Raises
        ------
        OutOfBudget : the time is up, or the user interrupted; ``sizes`` is then of no threshold.
        """
        following = self._mark_sets(float(threshold), budget)
        for robot in range(self.robots):
            budget.check()
            if robot not in self._protected:
                _spread(self.sizes, robot)
        return following

    def _mark_sets(self, threshold: float, budget: Budget) -> tuple[float, int | None]:
        if not isinstance(self.source, Team):
            return self._mark_values(self.source, threshold, budget)
        value, following = c_double(inf), c_int64(-1)
        kept = address(self.sizes), byref(value), byref(following)
        matters = address(self._outside), address(self._inside), self._n_blinded
        blocks, at_once = len(self._outside), 16  # some milliseconds between two looks at the clock
        for first in range(0, blocks, at_once):
            budget.check()
            last = min(first + at_once, blocks)
            if loops.mark_below(self.source.record, threshold, first, last, *matters, *kept):
                raise MemoryError
        return value.value, None if following.value < 0 else following.value

    def _mark_values(self, values: FloatArray, threshold: float, budget: Budget) -> tuple[float, int | None]:
        least, following, at_once = inf, None, self._at_once
        for first in range(0, len(values), at_once):
            budget.check()
            some = values[first : first + at_once]
            is_below, masks = some < threshold, np.arange(first, first + len(some), dtype=np.uint32)
            self.sizes[first : first + at_once] = np.where(is_below, np.bitwise_count(masks) + np.uint8(1), np.uint8(0))
            others = np.where(is_below, inf, some)
            k = int(others.argmin())
            if others[k] < least:
                least, following = float(others[k]), first + k
        return least, following

    def largest_inside(self, group: int) -> int:
        """The largest set below the threshold inside a group that has one, by mask, protected robots included."""
        inside, size = group, int(self.sizes[group]) - 1
        while inside.bit_count() > size:
            free = (i for i in range(self.robots) if inside >> i & 1 and i not in self._protected)
            inside = next(inside ^ 1 << i for i in free if self.sizes[inside ^ 1 << i] == size + 1)
        return inside


def _spread(sizes: NDArray[np.uint8], robot: int) -> None:
    """Let every set with a robot have at least what it has without it."""
    without, having = sizes.reshape(-1, 2, 1 << robot).transpose(1, 2, 0)
    columns = range(len(without)) if robot < 5 else [slice(None)]  # NumPy is slow along short rows
    for k in columns:
        np.maximum(without[k], having[k], out=having[k])


def _fewest_blinded(robots: int, groups: NDArray[np.uint32] | None) -> tuple[NDArray[np.uint8], NDArray[np.uint8]]:
    """``outside`` and ``inside`` of ``mark_below``: the robots of a block and those outside it, each by itself."""
    bits = min(robots, BLOCK)
    outside, inside = np.zeros(1 << (robots - bits), np.uint8), np.zeros((BLOCK + 1, 1 << BLOCK), np.uint8)
    if groups is not None:
        outside = _distances(robots - bits, groups >> bits)
        inside[0, : 1 << bits] = _distances(bits, groups & ((1 << bits) - 1))
        for b in range(bits):
            pairs = inside[b, : 1 << (bits - b)].reshape(-1, 2)
            inside[b + 1, : len(pairs)] = pairs.min(axis=1)
    return outside, inside


def _distances(robots: int, parts: NDArray[Any]) -> NDArray[np.uint8]:
    """(2**robots,) robots that each set lacks of the nearest of ``parts`` around it; 100 or more without one."""
    lacking = np.full(1 << robots, 100, np.uint8)
    lacking[parts] = 0
    for robot in range(robots):
        pairs = lacking.reshape(-1, 2, 1 << robot)
        np.minimum(pairs[:, 0], pairs[:, 1] + np.uint8(1), out=pairs[:, 0])
    return lacking
