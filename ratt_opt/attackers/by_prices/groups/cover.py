"""Partitions of the team into listed groups within both budgets, by depth-first search in compiled code.

The groups' reduced costs of a partition add up to at most the limit, and none is negative, so the search is short
where the prices are good. Imported only where compiled loops are used.
"""

from __future__ import annotations

from typing import Any

from ratt_opt.running.compiling import numba

__all__ = ["next_cover"]

FINISHED, PAUSED, FOUND = 0, 1, 2


@numba.njit(cache=True)
def _fits(covered: Any, group: Any, spent: Any, cost: Any, budgets: Any) -> bool:
    """Whether the group is disjoint from what is covered, and its costs are within what is left."""
    for b in range(len(budgets)):
        if spent[b] + cost[b] > budgets[b]:
            return False
    disjoint = True
    for i in range(len(group)):
        disjoint = disjoint and not (covered[i] and group[i])
    return disjoint


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
            if _fits(covered[d], groups[k], spent[d], costs[k], budgets):
                chosen = k
                break
            k += 1
        position[d] = k
        if chosen < 0:
            depth[0] = d - 1
            continue
        for i in range(n_robots):
            covered[d + 1, i] = covered[d, i] or groups[chosen, i]
        for b in range(len(budgets)):
            spent[d + 1, b] = spent[d, b] + costs[chosen, b]
        position[d + 1] = -1
        depth[0] = d + 1
        if nodes <= 0:
            return PAUSED
    return FINISHED
