"""Partitions of the team into listed groups within both budgets, by depth-first search in compiled code.

The groups' reduced costs of a partition add up to at most the limit, and none is negative, so the search is short
where the prices are good. Imported only where compiled loops are used.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from ratt_opt.compiling import numba

__all__ = ["next_cover"]

FINISHED, PAUSED, FOUND = 0, 1, 2


@numba.njit(cache=True)
def next_cover(groups: Any, costs: Any, budgets: Any, state: Any, nodes: int) -> int:
    """Continue to the next partition: FINISHED, PAUSED after so many nodes, or FOUND.

    Parameters
    ----------
    groups : (C, N) sorted by first robot
    costs : (C, 3) reduced cost, blinded robots, half the links cut, each >= 0; budgets : (3,) most of each
    state : position (N + 1,) next group at each depth, -1 to begin; covered (N + 1, N); spent (N + 1, 3);
        depth (1,); first (N + 1,) groups ``first[i]:first[i + 1]`` start with robot ``i``
    """
    position, covered, spent, depth, first = state
    n_robots = groups.shape[1]
    while depth[0] >= 0:
        d = depth[0]
        lowest = 0
        while lowest < n_robots and covered[d, lowest]:
            lowest += 1
        if lowest == n_robots:
            depth[0] = d - 1
            return FOUND
        k = first[lowest] if position[d] < 0 else position[d] + 1
        chosen = -1
        while k < first[lowest + 1]:
            nodes -= 1
            if np.all(spent[d] + costs[k] <= budgets) and not np.any(covered[d] & groups[k]):
                chosen = k
                break
            k += 1
        position[d] = k
        if chosen < 0:
            depth[0] = d - 1
            continue
        covered[d + 1] = covered[d] | groups[chosen]
        spent[d + 1] = spent[d] + costs[chosen]
        position[d + 1] = -1
        depth[0] = d + 1
        if nodes <= 0:
            return PAUSED
    return FINISHED
