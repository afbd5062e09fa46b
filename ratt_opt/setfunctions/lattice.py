"""Compiled passes over a table of all subsets; imported only where a table is checked (compiling is cached).

Every pass reads the table in its own order and makes no copy of it. The plain versions are in the tests.
"""

from __future__ import annotations

from typing import Any

import numba
import numpy as np

__all__ = ["disjoint_slack", "marginal_ends", "overlapping_slack", "second_differences", "smallest_gain_ratio"]

# Values are finite (checked on entry), so comparisons may assume it; no operation is reordered.
_FINITE = {"nnan", "ninf", "nsz"}
_BLOCK_BITS = 13
_BLOCK = 1 << _BLOCK_BITS  # 64 KiB of differences


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


@numba.njit(cache=True, fastmath=_FINITE)
def second_differences(values: Any, n: int) -> Any:
    """(n, n) smallest ``f(S+i) + f(S+j) - f(S+i+j) - f(S)`` over ``S``, for ``i < j``; 0 elsewhere.

    The first differences by ``j`` of a block are computed once and stay in cache for all ``i`` within the block.
    """
    ends = np.zeros((n, n))
    for j in range(1, n):
        for i in range(j):
            ends[i, j] = np.inf
    for j in range(1, n):
        top = 1 << j
        size = min(top, _BLOCK)
        falls = np.empty(size)
        for start in range(0, len(values), 2 * top):
            for part in range(start, start + top, size):
                for s in range(size):
                    falls[s] = values[part + s] - values[part + s + top]
                for i in range(j):
                    step = 1 << i
                    if step >= size:
                        break
                    ends[i, j] = min(ends[i, j], _smallest_rise(falls, step))
            for i in range(_BLOCK_BITS, j):
                step = 1 << i
                low = ends[i, j]
                for base in range(start, start + top, 2 * step):
                    for s in range(base, base + step):
                        slack = (values[s + step] - values[s + top + step]) - (values[s] - values[s + top])
                        low = min(low, slack)
                ends[i, j] = low
    return ends


@numba.njit(cache=True, fastmath=_FINITE)
def _smallest_rise(block: Any, step: int) -> Any:
    """Smallest ``block[s + step] - block[s]`` over ``s`` without the bit ``step``."""
    low = np.inf
    for base in range(0, len(block), 2 * step):
        for s in range(base, base + step):
            low = min(low, block[s + step] - block[s])
    return low


@numba.njit(cache=True)
def disjoint_slack(values: Any) -> Any:
    """Smallest ``f(A) + f(B) - f(A + B)`` over disjoint ``A``, ``B`` (3**n pairs), with its ``A`` and ``B``."""
    worst, first, second = np.inf, 0, 0
    for union in range(len(values)):
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
def overlapping_slack(values: Any) -> Any:
    """Smallest ``f(A) + f(B) - f(A | B)`` over all pairs (4**n), with its ``A`` and ``B``."""
    worst, first, second = np.inf, 0, 0
    for a in range(len(values)):
        for b in range(a, len(values)):
            slack = values[a] + values[b] - values[a | b]
            if slack < worst:
                worst, first, second = slack, a, b
    return worst, first, second


@numba.njit(cache=True)
def smallest_gain_ratio(values: Any, sizes: Any) -> Any:
    """Smallest ``(sum of f(S + w) - f(S) over w in T - S) / (f(T) - f(S))``, ``S`` in ``T``, where the gain is not 0.

    ``values`` : flat, in C order, one axis of ``sizes[a]`` options an owner, option 0 being none of its elements.
    Returns the ratio (infinite if no gain is positive), the position of ``T``, and ``S`` as a mask over the axes
    where ``T`` takes part, the last axis first. Looks at ``prod(2 * sizes - 1)`` pairs.
    """
    axes = len(sizes)
    best, best_top, best_part = np.inf, 0, 0
    position = np.empty(1 << axes, np.int64)
    for top in range(len(values)):
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
