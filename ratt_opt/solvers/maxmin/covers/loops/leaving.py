"""Dead ends, and what they did not depend on, compiled.

A dead end that does not depend on what a frame fixed is one of the frame before, too. So both are left at once, and the
frames and steps on which nothing depends do not enter the proof (conflict-directed backjumping, Prosser 1993).
"""

from __future__ import annotations

from typing import Any

import numpy as np

from ratt_opt.running.compiling import numba
from ratt_opt.solvers.maxmin.covers.loops.forbidding import (
    LACKING,
    cover_depends_on,
    most_counted,
    most_of,
    step,
    sum_depends_on,
)
from ratt_opt.solvers.maxmin.covers.loops.tables import BY_COVER, BY_SUM, TRIED

__all__ = ["leave"]

ONE = np.uint64(1)


@numba.njit(cache=True)
def _write(record: Any, what: int, subject: int, robot: int, place: int, following: int) -> int:  # noqa: PLR0917
    number = record.size[0]
    node = record.nodes[number]
    node[0], node[1], node[2], node[3], node[4] = what, subject, robot, place, following
    record.size[0] = number + 1
    return int(number)


@numba.njit(cache=True)
def _write_step(team: Any, sums: Any, stack: Any, record: Any, s: int, following: int) -> int:  # noqa: PLR0917
    """Write what forbade elements; of a sum, the one that counts most."""
    mask, robot, place, best = stack.gone[s], stack.robot[s], 0, 0
    most = -1.0
    while mask:
        if mask & ONE:
            term = sums.terms[stack.what[s], team.element[robot, place]] if stack.kind[s] == BY_SUM else 0.0
            if term > most:
                best, most = place, term
        mask >>= ONE
        place += 1
    return _write(record, stack.kind[s], stack.what[s], robot, best, following)


@numba.njit(cache=True)
def leave(team: Any, covers: Any, sums: Any, stack: Any, record: Any, kind: int, what: int) -> bool:  # noqa: PLR0917
    """Leave a dead end, and the frames before it that are dead ends for the same reason; whether all are."""
    frame = stack.frame[0]
    allowed, conflict = stack.allowed[frame], np.empty(stack.allowed.shape[1], np.uint64)
    robots = len(conflict)
    if kind == BY_COVER:
        spare = team.enough - 1.0 - most_counted(team, allowed, covers.left_out[what])
        cover_depends_on(team, stack, frame, covers.left_out[what], spare, robots, conflict)
    else:
        spare = team.enough - LACKING
        for i in range(robots):
            spare -= most_of(team, sums.terms[what], i, allowed[i])
        sum_depends_on(team, stack, frame, sums.terms[what], spare, robots, conflict)
    for i in range(robots):
        if conflict[i]:
            stack.activity[i] += 1.0
    proof = _write(record, kind, what, -1, 0, -1)
    while True:
        while stack.steps[0] > stack.first[frame]:
            s = stack.steps[0] - 1
            stack.steps[0] = s
            i = stack.robot[s]
            if conflict[i] & stack.gone[s]:
                conflict[i] &= ~stack.gone[s]
                for r in range(robots):
                    conflict[r] |= stack.reason[s, r]
                proof = _write_step(team, sums, stack, record, s, proof)
        if frame == 0:
            return True
        frame -= 1
        e = stack.fixed[frame + 1]
        i = team.owner[e]
        own = ONE << np.uint64(team.bit[e])
        others = stack.allowed[frame, i] & ~own
        if conflict[i] & others:
            conflict[i] &= ~others
            for r in range(robots):
                stack.reason[stack.steps[0], r] = conflict[r]
            step(team, stack, frame, TRIED, proof, i, own)
            stack.frame[0] = frame
            return False
