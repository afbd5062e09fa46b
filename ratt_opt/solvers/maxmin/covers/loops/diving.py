"""The loop of a search in depth, compiled: covers as conditions that forbid, then frames that each fix an element.

In a frame, steps forbid elements. An element that was fixed in a frame above is forbidden once that frame was a dead
end.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from ratt_opt.running.compiling import numba
from ratt_opt.solvers.maxmin.covers.loops.attacking import new_cover
from ratt_opt.solvers.maxmin.covers.loops.forbidding import ask_covers, ask_sums, forbid
from ratt_opt.solvers.maxmin.covers.loops.leaving import leave
from ratt_opt.solvers.maxmin.covers.loops.tables import BY_COVER, BY_SUM
from ratt_opt.solvers.maxmin.levels.level_search import Outcome

__all__ = ["dive"]

PROVED, SPENT, PLAN, FULL = (int(outcome) for outcome in Outcome)
ONE = np.uint64(1)
RECENT = 100
"""Covers by which elements are chosen."""


@numba.njit(cache=True)
def _bits(mask: Any) -> int:
    count = 0
    while mask:
        mask &= mask - ONE
        count += 1
    return count


@numba.njit(cache=True)
def _fix(team: Any, covers: Any, stack: Any) -> bool:
    """Fix an element of the robot that took part in most dead ends for each of its elements; whether one was left."""
    frame = stack.frame[0]
    allowed, most = stack.allowed[frame], -1.0
    robot = len(allowed)
    for i in range(len(allowed)):
        count = _bits(allowed[i])
        if count > 1 and (stack.activity[i] + 1.0) / count > most:
            robot, most = i, (stack.activity[i] + 1.0) / count
    if robot == len(allowed):
        return False
    best, asked = -1, -1
    for place in range(team.element.shape[1]):
        if (allowed[robot] >> np.uint64(place)) & ONE:
            count = 0
            for k in range(max(0, covers.size[0] - RECENT), covers.size[0]):
                count += (covers.left_out[k, robot] >> np.uint64(place)) & ONE
            if count > asked:
                best, asked = place, count
    stack.frame[0] = frame + 1
    stack.fixed[frame + 1] = team.element[robot, best]
    stack.first[frame + 1] = stack.steps[0]
    for i in range(len(allowed)):
        stack.allowed[frame + 1, i] = allowed[i]
        stack.touched[frame + 1, i] = stack.touched[frame, i]
        for j in range(stack.strongest.shape[2]):
            for k in range(stack.strongest.shape[3]):
                stack.strongest[frame + 1, i, j, k] = stack.strongest[frame, i, j, k]
    forbid(team, stack, frame + 1, robot, allowed[robot] & ~(ONE << np.uint64(best)))
    return True


@numba.njit(cache=True)
def dive(  # noqa: PLR0917
    team: Any, ways: Any, covers: Any, sums: Any, stack: Any, record: Any, level: float, nodes: int, most: int
) -> int:
    """Search on for some nodes; how that ended. ``most`` : partitions that are tried at a node."""
    for _ in range(nodes):
        if covers.size[0] == len(covers.left_out) or record.size[0] + len(stack.kind) >= len(record.nodes):
            return FULL
        frame, kind, found = stack.frame[0], BY_COVER, 1
        while found > 0:
            found, kind = ask_covers(team, covers, stack, frame, level), BY_COVER
            if found == 0:
                found, kind = ask_sums(team, sums, stack, frame), BY_SUM
        what = -1 - found
        if found == 0:
            what, kind = new_cover(team, ways, covers, stack, frame, level, most), BY_COVER
        if what >= 0:
            if leave(team, covers, sums, stack, record, kind, what):
                return PROVED
        elif not _fix(team, covers, stack):
            return PLAN
    return SPENT
