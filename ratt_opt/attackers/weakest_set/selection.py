"""The smallest of some numbers, for compiled loops: NumPy's partition takes seven times as long there.

Imported only where a large team is attacked: compiling takes seconds, once per machine (cached).
"""

from __future__ import annotations

from typing import Any

from ratt_opt.running.compiling import numba

__all__ = ["move_least_first"]


@numba.njit(cache=True)
def move_least_first(values: Any, count: int) -> float:
    """Reorder values (n,) so that the ``count`` smallest come first, the largest of them last; which is returned.

    Hoare's FIND (Communications of the ACM 4 (1961)); 0 < ``count`` <= n.
    """
    low, high, last = 0, len(values) - 1, count - 1
    while low < high:
        pivot, i, j = values[last], low, high
        while i <= j:
            while values[i] < pivot:
                i += 1
            while pivot < values[j]:
                j -= 1
            if i <= j:
                values[i], values[j] = values[j], values[i]
                i += 1
                j -= 1
        if j < last:
            low = i
        if last < i:
            high = j
    return float(values[last])
