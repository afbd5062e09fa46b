"""Attacks on all plans of a frame at once, compiled: a frame that one attack ends is a dead end by a new cover.

The cover then keeps as many elements more as it can, those first that were forbidden last.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from ratt_opt.running.compiling import numba
from ratt_opt.solvers.maxmin.covers.loops.keeping import keep
from ratt_opt.solvers.maxmin.covers.loops.team import add, tells, total_of, value_of

__all__ = ["new_cover"]

NONE, ONE = np.uint64(0), np.uint64(1)


@numba.njit(cache=True)
def blind(team: Any, strongest: Any, members: Any, level: float, most: int, blinded: Any) -> int:  # noqa: PLR0917
    """How many robots of a group to blind until it is worth at most the level: greedily, then by exchanges.

    More than ``most`` if that is not enough. ``blinded`` : (N,) set to these robots
    """
    robots, values, sums = len(members), np.empty(len(team.prior)), team.prior.copy()
    for i in range(robots):
        blinded[i] = False
        if members[i]:
            add(strongest[i], 1.0, sums)
    worth, count = total_of(team, sums, values), 0
    while worth > level and count < most:
        best, lowest = -1, np.inf
        for i in range(robots):
            if members[i] and not blinded[i] and not team.safe[i]:
                left = _exchanged(team, strongest, sums, values, robots, i)
                if left < lowest:
                    best, lowest = i, left
        if best < 0:
            return most + 1
        blinded[best] = True
        add(strongest[best], -1.0, sums)
        worth, count = total_of(team, sums, values), count + 1
    improved = count == most and most > 0
    while worth > level and improved:
        improved = False
        for a in range(robots):
            for b in range(robots):
                if blinded[a] and members[b] and not blinded[b] and not team.safe[b]:
                    left = _exchanged(team, strongest, sums, values, a, b)
                    if left < worth - 1e-9 * abs(worth):
                        add(strongest[a], 1.0, sums)
                        add(strongest[b], -1.0, sums)
                        blinded[a], blinded[b], improved = False, True, True
                        worth = total_of(team, sums, values)
    return count if worth <= level else most + 1


@numba.njit(cache=True)
def _exchanged(team: Any, strongest: Any, sums: Any, values: Any, back: int, blinded: int) -> float:  # noqa: PLR0917
    """The rest of a group if one more robot is blinded, in exchange for one that sees again, or N."""
    total, matrix = 0.0, np.empty(sums.shape[1])
    for j in range(len(values)):
        if tells(strongest[blinded], j) or (back < len(strongest) and tells(strongest[back], j)):
            for k in range(len(matrix)):
                matrix[k] = sums[j, k] - strongest[blinded, j, k]
                if back < len(strongest):
                    matrix[k] += strongest[back, j, k]
            total += value_of(team, j, matrix)
        else:
            total += values[j]
    return total


@numba.njit(cache=True)
def new_cover(team: Any, ways: Any, covers: Any, stack: Any, frame: int, level: float, most: int) -> int:  # noqa: PLR0917
    """A new cover by an attack after which no plan of the frame is worth more than the level; its number, or -1."""
    alpha, strongest = int(team.enough) - 1, stack.strongest[frame]
    needs = np.full(len(ways.members), -1)
    blinded = np.zeros((ways.members.shape[0], ways.members.shape[1]), np.bool_)
    for place in range(min(len(ways.order), most)):
        p, need = ways.order[place], 0
        for g in ways.of[p]:
            if g < 0 or need > alpha:
                break
            if needs[g] < 0:
                needs[g] = blind(team, strongest, ways.members[g], level, alpha, blinded[g])
            need += needs[g]
        if need <= alpha:
            for q in range(place, 0, -1):
                ways.order[q] = ways.order[q - 1]
            ways.order[0] = p
            return _keep_more(team, ways, covers, stack, frame, level, p, blinded)
    return -1


@numba.njit(cache=True)
def _keep_more(  # noqa: PLR0917
    team: Any, ways: Any, covers: Any, stack: Any, frame: int, level: float, partition: int, blinded: Any
) -> int:
    number, allowed = covers.size[0], stack.allowed[frame]
    covers.partition[number], covers.level[number] = partition, level
    for i in range(len(allowed)):
        covers.left_out[number, i] = NONE
    price, may, kept = (
        np.empty(len(team.owner)),
        np.empty(len(team.owner), np.bool_),
        np.empty(len(team.owner), np.bool_),
    )
    for e in range(len(price)):
        may[e] = (allowed[team.owner[e]] >> np.uint64(team.bit[e])) & ONE
        price[e] = frame + 2.0 if may[e] else stack.since[e] + 2.0
    for place, g in enumerate(ways.of[partition]):
        if g < 0:
            break
        for e in range(len(kept)):
            kept[e] = may[e] and ways.inside[g, e] and not blinded[g, team.owner[e]]
        keep(team, ways.inside[g], price, level, kept, covers.sums[number, place])
        for e in range(len(kept)):
            if ways.inside[g, e] and not kept[e]:
                covers.left_out[number, team.owner[e]] |= ONE << np.uint64(team.bit[e])
    covers.size[0] = number + 1
    return int(number)
