"""Partitions of a team into groups of small reduced cost."""

from __future__ import annotations

from ctypes import byref, c_int, c_int64, c_void_p
from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.native.library import address, function

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from ratt_opt.attack.pricing import Column
    from ratt_opt.budget import Budget
    from ratt_opt.graph.threat import Threat

__all__ = ["partitions_into"]

COVERS = 100_000
"""Groups tried between two looks at the clock."""
PAUSED, FOUND = 1, 2


def partitions_into(columns: Sequence[Column], threat: Threat, gap: int, budget: Budget) -> Iterator[list[int]]:
    """Places of the groups of each partition within both of the adversary's budgets.

    ``gap`` : reduced costs that the groups of one partition may have together

    Raises
    ------
    OutOfBudget : the time is up.
    """
    if not columns:
        return
    n_robots, groups = threat.graph.n_robots, np.array([column.robots for column in columns])
    links = np.array(sorted(threat.graph.links), dtype=np.int64).reshape(-1, 2)
    half_cuts = 0.5 * (groups[:, links[:, 0]] != groups[:, links[:, 1]]).sum(axis=1)
    busy = np.argsort(-groups.sum(axis=0), kind="stable")
    robots = np.ascontiguousarray(groups[:, busy])
    lowest = robots.argmax(axis=1)
    order = np.argsort(lowest, kind="stable")
    robots = np.ascontiguousarray(robots[order])
    paid = np.array([[max(column.cost, 0), column.need] for column in columns])
    costs = np.ascontiguousarray(np.column_stack([paid, half_cuts])[order])
    first = np.searchsorted(lowest[order], np.arange(n_robots + 1)).astype(np.int64)
    position, depth = np.full(n_robots + 2, -1, dtype=np.int64), c_int64(0)
    covered, spent = np.zeros((n_robots + 2, n_robots), dtype=np.bool_), np.zeros((n_robots + 2, 3))
    budgets = np.array([gap, threat.n_blinded, threat.alpha_c], dtype=np.float64)
    call = function("next_partition", c_int, c_int64, *[c_void_p] * 8, c_int64)
    arrays = [address(one) for one in (robots, costs, budgets, first, position, covered, spent)]
    while True:
        budget.check()
        code = call(n_robots, *arrays, byref(depth), COVERS)
        if code == FOUND:
            yield order[position[: depth.value + 1]].tolist()
        elif code != PAUSED:
            return
