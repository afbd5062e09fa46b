"""Passes over a table of all subsets, in C (``native/src/lattice.c``), in parts of some milliseconds.

Every pass reads the table in its own order; second differences are first ones of a table of half the size.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from ratt_opt._blocks import blocks
from ratt_opt.errors import InputError
from ratt_opt.native.library import address, checked
from ratt_opt.native.loops import loops

if TYPE_CHECKING:
    from ratt_opt._validation import FloatArray, IntArray
    from ratt_opt.budget import Budget

__all__ = [
    "GainRatio",
    "disjoint_slack",
    "marginal_ends",
    "overlapping_slack",
    "second_differences",
    "smallest_gain_ratio",
]


def marginal_ends(values: FloatArray, n: int) -> FloatArray:
    """(2, n) smallest and largest ``f(S + i) - f(S)`` over all ``S`` without ``i``.

    Raises ``InputError`` : ``values`` is no contiguous array of 2**n floats.
    """
    checked("values", values, np.float64, (1 << n,))
    return np.array([_ends_by(values, i) for i in range(n)]).reshape(n, 2).T


def _ends_by(values: FloatArray, i: int) -> tuple[float, float]:
    """Smallest and largest ``f(S + i) - f(S)``, by parts that fit a processor's cache: 2^15 sets."""
    by_i, ends = values.reshape(-1, 2, 1 << i), []
    for first, last in blocks(len(by_i), 128 << i):
        rises = by_i[first:last, 1] - by_i[first:last, 0]
        ends += [rises.min(), rises.max()]
    return float(min(ends)), float(max(ends))


def second_differences(values: FloatArray, n: int, budget: Budget) -> FloatArray:
    """(n, n) smallest ``f(S+i) + f(S+j) - f(S+i+j) - f(S)`` over ``S``, for ``i < j``; 0 elsewhere.

    Raises ``OutOfBudget``, and ``InputError`` : ``values`` is no contiguous array of 2**n floats.
    """
    checked("values", values, np.float64, (1 << n,))
    ends = np.zeros((n, n))
    for j in range(1, n):
        by_j = values.reshape(-1, 2, 1 << j)
        falls = np.subtract(by_j[:, 0], by_j[:, 1]).ravel()
        for i in range(j):
            budget.check()
            ends[i, j] = _ends_by(falls, i)[0]
    return ends


def disjoint_slack(values: FloatArray, budget: Budget) -> tuple[float, int, int]:
    """Smallest ``f(A) + f(B) - f(A + B)`` over disjoint ``A``, ``B`` (3**n pairs), with its ``A`` and ``B``.

    Raises ``OutOfBudget``, and ``InputError`` : ``values`` is no contiguous array of floats.
    """
    table = address(checked("values", values, np.float64, (len(values),)))
    slack, sets = np.full(1, np.inf), np.zeros(2, dtype=np.int64)
    for first, last in blocks(len(values), len(values)):
        budget.check()
        loops.disjoint_slack(table, first, last, address(slack), address(sets))
    return float(slack[0]), int(sets[0]), int(sets[1])


def overlapping_slack(values: FloatArray, budget: Budget) -> tuple[float, int, int]:
    """Smallest ``f(A) + f(B) - f(A | B)`` over all pairs (4**n), with its ``A`` and ``B``.

    Raises ``OutOfBudget``, and ``InputError`` : ``values`` is no contiguous array of floats.
    """
    checked("values", values, np.float64, (len(values),))
    sets, found = np.arange(len(values)), (np.inf, 0, 0)
    for a in range(len(values)):
        budget.check()
        slack = values[a] + values[a:] - values[a | sets[a:]]
        b = int(slack.argmin())
        if slack[b] < found[0]:
            found = float(slack[b]), a, a + b
    return found


@dataclass(frozen=True, slots=True)
class GainRatio:
    """Ends of a smallest ratio of gains; ``top`` (a position) and ``part`` (a mask over its axes) attain ``upper``."""

    lower: float
    upper: float
    top: int
    part: int


def smallest_gain_ratio(values: FloatArray, sizes: IntArray, budget: Budget, noise: float = 0.0) -> GainRatio:
    """Smallest ``(sum of f(S + w) - f(S) over w in T - S) / (f(T) - f(S))``, ``S`` in ``T``, if the gain is not 0.

    ``values`` : flat, in C order, one axis of ``sizes[a]`` options an owner, option 0 being none of its elements.
    ``noise`` : by how much a difference of two values may be off; gains up to it lower only the lower end.
    Returns the ends (infinite if no gain is positive), the position of ``T``, and ``S`` as a mask over the axes
    where ``T`` takes part, the last axis first. Looks at ``prod(2 * sizes - 1)`` pairs, or (spent budget) some.

    Raises ``InputError`` : ``values`` is no contiguous array of as many floats, or a size is less than 1.
    """
    options = checked("sizes", sizes, np.int64, (len(sizes),))
    if len(sizes) and sizes.min() < 1:
        raise InputError("sizes", "must be at least 1", sizes.min())
    table = address(checked("values", values, np.float64, (int(sizes.prod()),)))
    ratios, sets = np.full(2, np.inf), np.zeros(2, dtype=np.int64)
    positions = np.empty(1 << len(sizes), dtype=np.int64)
    found = address(positions), address(ratios), address(sets)
    for first, last in blocks(len(values), 1 << len(sizes)):
        if budget.is_over:
            break
        loops.gain_ratio(table, len(sizes), address(options), first, last, noise, *found)
    return GainRatio(float(ratios[1]), float(ratios[0]), int(sets[0]), int(sets[1]))
