"""Compiled passes over a table of all subsets; imported only if a table is checked (compiling is cached).

Every pass reads the table in its own order and makes no copy of it. The plain versions are in the tests.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from ratt_opt.running.compiling import numba

if TYPE_CHECKING:
    from ratt_opt._validation import FloatArray, IntArray
    from ratt_opt.budget import Budget

__all__ = ["disjoint_slack", "marginal_ends", "overlapping_slack", "second_differences", "smallest_gain_ratio"]

# Values are finite (checked on entry), so comparisons may assume it; no operation is reordered.
_FINITE = {"nnan", "ninf", "nsz"}
_BLOCK_BITS = 13
_BLOCK = 1 << _BLOCK_BITS
"""Differences kept in cache at once: 64 KiB, so that they stay in a core's own cache while all pairs use them."""
_WIDTH = 512
"""Entries a vector loop takes: many times the vector width, so that its overhead vanishes, and 4 KiB in cache."""


@numba.njit(cache=True, fastmath=_FINITE)
def marginal_ends(values: Any, n: int) -> Any:
    """(2, n) smallest and largest ``f(S + i) - f(S)`` over all ``S`` without ``i``."""
    ends = np.empty((2, n))
    for i in range(n):
        step = 1 << i
        low, high = np.inf, -np.inf
        for start in range(0, len(values), 2 * step):
            for s in range(start, start + step):
                marginal = values[s + step] - values[s]
                low = min(low, marginal)
                high = max(high, marginal)
        ends[0, i], ends[1, i] = low, high
    return ends


def second_differences(values: FloatArray, n: int, budget: Budget) -> FloatArray:
    """(n, n) smallest ``f(S+i) + f(S+j) - f(S+i+j) - f(S)`` over ``S``, for ``i < j``; 0 elsewhere.

    Raises ``OutOfBudget`` : asked before each ``j``, and each of the last ``i``.
    """
    ends = np.zeros((n, n))
    for j in range(1, n):
        budget.check()
        ends[:j, j] = _second_differences_by(values, j)
        for i in range(_BLOCK_BITS, j):
            budget.check()
            ends[i, j] = _smallest_far(values, 1 << i, 1 << j)
    return ends


@numba.njit(cache=True, fastmath=_FINITE)
def _second_differences_by(values: Any, j: int) -> Any:
    """(j,) smallest second differences by ``j`` and each lower ``i`` within a block; infinite for other ``i``.

    The first differences by ``j`` of a block are computed once and stay in cache for all ``i``.
    """
    ends = np.full(j, np.inf)
    half = len(values) // 2
    size = min(half, _BLOCK)
    falls = np.zeros(size + _WIDTH)
    for first in range(0, half, size):
        _first_differences(values, 1 << j, first, falls[:size])
        for i in range(j):
            step = 1 << i
            if step >= size:
                break
            if size < _WIDTH:
                ends[i] = min(ends[i], _smallest_rise(falls, size, step))
            else:
                ends[i] = min(ends[i], _smallest_wide(falls, size, step))
    return ends


@numba.njit(cache=True, fastmath=_FINITE)
def _first_differences(values: Any, top: int, first: int, falls: Any) -> None:
    """``f(S) - f(S + j)`` for the sets without ``j`` from number ``first`` on; ``top`` is the bit of ``j``."""
    if top < len(falls):
        for done in range(0, len(falls), top):
            start = 2 * (first + done)
            for s in range(top):
                falls[done + s] = values[start + s] - values[start + top + s]
    else:
        start = first // top * 2 * top + first % top
        end = start + len(falls)
        _subtract(falls, values[start:end], values[start + top : end + top])


@numba.njit(cache=True, fastmath=_FINITE)
def _smallest_rise(block: Any, size: int, step: int) -> float:
    """Smallest ``block[s + step] - block[s]`` over ``s`` below ``size`` without the bit ``step``."""
    low = np.inf
    for base in range(0, size, 2 * step):
        for s in range(base, base + step):
            low = min(low, block[s + step] - block[s])
    return low


@numba.njit(cache=True, fastmath=_FINITE)
def _smallest_wide(block: Any, size: int, step: int) -> float:
    """The same many at once, the smallest of each place in a chunk kept apart; ``block`` goes on for one chunk more.

    If ``step`` is less than a chunk, places with that bit take differences that mean nothing; they are left out.
    """
    least = np.full(_WIDTH, np.inf)
    for base in range(0, size, max(2 * step, _WIDTH)):
        for s in range(base, base + max(step, _WIDTH), _WIDTH):
            _lower(least, block[s + step : s + step + _WIDTH], block[s : s + _WIDTH])
    low = np.inf
    for s in range(_WIDTH):
        if not s & step:
            low = min(low, least[s])
    return low


@numba.njit(cache=True, fastmath=_FINITE)
def _smallest_far(values: Any, step: int, top: int) -> float:
    """Smallest second difference by two high bits, ``step`` below ``top``, straight from the table."""
    least, high, low = np.full(_WIDTH, np.inf), np.empty(_WIDTH), np.empty(_WIDTH)
    for start in range(0, len(values), 2 * top):
        for base in range(start, start + top, 2 * step):
            for s in range(base, base + step, _WIDTH):
                t = s + step
                _subtract(low, values[s : s + _WIDTH], values[s + top : s + top + _WIDTH])
                _subtract(high, values[t : t + _WIDTH], values[t + top : t + top + _WIDTH])
                _lower(least, high, low)
    return float(least.min())


# Loops of their own, which the compiler turns into vector instructions; a running minimum it does not.


@numba.njit(cache=True, fastmath=_FINITE)
def _lower(least: Any, high: Any, low: Any) -> None:
    for s in range(len(least)):
        least[s] = min(least[s], high[s] - low[s])


@numba.njit(cache=True, fastmath=_FINITE)
def _subtract(result: Any, left: Any, right: Any) -> None:
    for s in range(len(result)):
        result[s] = left[s] - right[s]


_PAIRS = 1 << 24
"""Pairs that compiled loops look at between two looks at the clock: some hundredths of a second."""


def disjoint_slack(values: FloatArray, budget: Budget) -> tuple[float, int, int]:
    """Smallest ``f(A) + f(B) - f(A + B)`` over disjoint ``A``, ``B`` (3**n pairs), with its ``A`` and ``B``.

    Raises ``OutOfBudget``.
    """
    worst, step = (np.inf, 0, 0), max(_PAIRS // len(values), 1)
    for first in range(0, len(values), step):
        budget.check()
        worst = _disjoint(values, first, min(first + step, len(values)), worst)
    return float(worst[0]), int(worst[1]), int(worst[2])


def overlapping_slack(values: FloatArray, budget: Budget) -> tuple[float, int, int]:
    """Smallest ``f(A) + f(B) - f(A | B)`` over all pairs (4**n), with its ``A`` and ``B``; raises ``OutOfBudget``."""
    worst, step = (np.inf, 0, 0), max(_PAIRS // len(values), 1)
    for first in range(0, len(values), step):
        budget.check()
        worst = _overlapping(values, first, min(first + step, len(values)), worst)
    return float(worst[0]), int(worst[1]), int(worst[2])


@numba.njit(cache=True)
def _disjoint(values: Any, start: int, end: int, known: Any) -> Any:
    worst, first, second = known
    for union in range(start, end):
        part = union
        while True:
            slack = values[part] + values[union ^ part] - values[union]
            if slack < worst:
                worst, first, second = slack, part, union ^ part
            if 2 * part <= union:  # the other half are the same pairs, swapped
                break
            part = (part - 1) & union
    return worst, first, second


@numba.njit(cache=True)
def _overlapping(values: Any, start: int, end: int, known: Any) -> Any:
    worst, first, second = known
    for a in range(start, end):
        for b in range(a, len(values)):
            slack = values[a] + values[b] - values[a | b]
            if slack < worst:
                worst, first, second = slack, a, b
    return worst, first, second


def smallest_gain_ratio(values: FloatArray, sizes: IntArray, budget: Budget) -> tuple[float, int, int]:
    """Smallest ``(sum of f(S + w) - f(S) over w in T - S) / (f(T) - f(S))``, ``S`` in ``T``, if the gain is not 0.

    ``values`` : flat, in C order, one axis of ``sizes[a]`` options an owner, option 0 being none of its elements.
    Returns the ratio (infinite if no gain is positive), the position of ``T``, and ``S`` as a mask over the axes
    where ``T`` takes part, the last axis first. Looks at ``prod(2 * sizes - 1)`` pairs, or (spent budget) some.
    """
    best, step = (np.inf, 0, 0), max(_PAIRS >> len(sizes), 1)
    for first in range(0, len(values), step):
        if budget.is_over:
            break
        best = _gain_ratio(values, sizes, first, min(first + step, len(values)), best)
    return float(best[0]), int(best[1]), int(best[2])


@numba.njit(cache=True)
def _gain_ratio(values: Any, sizes: Any, start: int, end: int, known: Any) -> Any:
    axes = len(sizes)
    best, best_top, best_part = known
    position = np.empty(1 << axes, np.int64)
    for top in range(start, end):
        rest, stride, count = top, 1, 0
        position[0] = 0
        for a in range(axes - 1, -1, -1):
            pick = rest % sizes[a]
            rest //= sizes[a]
            if pick > 0:
                for s in range(1 << count):
                    position[s + (1 << count)] = position[s] + pick * stride
                count += 1
            stride *= sizes[a]
        full = 1 << count
        for part in range(full - 1):
            base = values[position[part]]
            gain = values[top] - base
            if gain <= 0:
                continue
            total = 0.0
            for i in range(count):
                if not part >> i & 1:
                    total += values[position[part | 1 << i]] - base
            if total < best * gain:
                best, best_top, best_part = total / gain, top, part
    return best, best_top, best_part
