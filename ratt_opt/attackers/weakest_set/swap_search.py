"""Local search for a set of robots of low value: the best single exchange, again and again."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Iterable

    from ratt_opt.attackers.weakest_set.compact import CompactTeam

__all__ = ["swap_search"]


def swap_search(
    team: CompactTeam,
    start: frozenset[int],
    *,
    among: Iterable[int] | None = None,
    fixed: frozenset[int] = frozenset(),
) -> frozenset[int]:
    """Exchange one robot inside for one outside while that lowers the value; ties to the lowest robots.

    ``among`` : robots that may be in the set (all by default); ``fixed`` : robots that stay in it
    """
    inside = np.array(sorted(start - fixed), dtype=np.int64)
    allowed = range(len(team.single)) if among is None else among
    outside = np.array(sorted(set(allowed) - start), dtype=np.int64)
    if not len(inside) or not len(outside):
        return start
    kept_robots = sorted(fixed)
    sums, value = team.sums([*inside, *kept_robots]), team.value(start)
    while True:
        kept = sums - team.information[inside]
        values = np.stack([team.values(rest + team.information[outside]) for rest in kept])
        i, e = np.unravel_index(int(values.argmin()), values.shape)
        if values[i, e] >= value - 1e-12 * abs(value):
            return frozenset(inside.tolist()) | fixed
        inside[i], outside[e] = outside[e], inside[i]
        sums = team.sums([*inside, *kept_robots])
        value = float(team.values(sums))
