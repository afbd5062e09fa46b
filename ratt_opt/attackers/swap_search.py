"""Local search for a set of robots of low value: the best single exchange, again and again."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from ratt_opt.attackers.compact import CompactTeam

__all__ = ["swap_search"]


def swap_search(team: CompactTeam, start: frozenset[int]) -> frozenset[int]:
    """Exchange one robot inside for one outside while that lowers the value; ties to the lowest robots."""
    inside = np.array(sorted(start), dtype=np.int64)
    outside = np.setdiff1d(np.arange(len(team.single)), inside)
    if not len(inside) or not len(outside):
        return start
    sums, value = team.sums(inside), team.value(inside)
    while True:
        kept = sums - team.information[inside]
        values = np.stack([team.values(rest + team.information[outside]) for rest in kept])
        i, e = np.unravel_index(int(values.argmin()), values.shape)
        if values[i, e] >= value - 1e-12 * abs(value):
            return frozenset(inside.tolist())
        inside[i], outside[e] = outside[e], inside[i]
        sums = team.sums(inside)
        value = team.value(inside)
