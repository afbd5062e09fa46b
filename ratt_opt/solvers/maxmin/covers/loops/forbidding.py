"""Elements that covers and sums of covers forbid in a frame, and what that depends on, compiled.

If a cover needs all robots that can still meet it, each of them must choose among what the cover leaves out. Sums
of covers forbid likewise. Masks of elements, one a robot, say what a step depends on: elements that were forbidden
before.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from ratt_opt.running.compiling import numba
from ratt_opt.solvers.maxmin.covers.loops.tables import BY_COVER, BY_SUM
from ratt_opt.solvers.maxmin.covers.loops.team import bound_robot

__all__ = [
    "LACKING",
    "ask_covers",
    "ask_sums",
    "cover_depends_on",
    "forbid",
    "most_counted",
    "most_of",
    "step",
    "sum_depends_on",
]

NONE, ONE = np.uint64(0), np.uint64(1)
LACKING = 1e-6
"""What plans have to lack of a sum at least: its weights have errors of 1e-9."""


@numba.njit(cache=True)
def most_counted(team: Any, allowed: Any, left_out: Any) -> float:
    """The most that plans count in a cover."""
    total = 0.0
    for i in range(len(allowed)):
        if allowed[i] & left_out[i]:
            total += team.count[i]
    return total


@numba.njit(cache=True)
def _spare_latest(stack: Any, frame: int, more: Any, spare: float, out: Any) -> None:
    """Depend on nothing of the robots whose elements were forbidden last, as far as it may count so much more.

    ``more`` : (N,) how much more each of them would count
    """
    robots = len(more)
    while True:
        latest = robots
        for i in range(robots):
            is_later = latest == robots or stack.touched[frame, i] > stack.touched[frame, latest]
            if out[i] and more[i] <= spare and is_later:
                latest = i
        if latest == robots:
            return
        out[latest] = NONE
        spare -= more[latest]


@numba.njit(cache=True)
def cover_depends_on(team: Any, stack: Any, frame: int, left_out: Any, spare: float, but: int, out: Any) -> None:  # noqa: PLR0917
    """Elements that have to be forbidden for a cover to count no more: of all robots that it does not count, but one.

    ``spare`` : how much more it may count; robots whose elements were forbidden last are spared
    """
    allowed, robots = stack.allowed[frame], len(left_out)
    for i in range(robots):
        out[i] = NONE if allowed[i] & left_out[i] or i == but else left_out[i] & stack.start[i]
    _spare_latest(stack, frame, team.count, spare, out)


@numba.njit(cache=True)
def forbid(team: Any, stack: Any, frame: int, robot: int, gone: Any) -> None:
    """Take elements from what a robot may choose in this frame."""
    stack.allowed[frame, robot] &= ~gone
    stack.touched[frame, robot] = frame
    bound_robot(team, robot, stack.allowed[frame, robot], stack.strongest[frame, robot])
    place = 0
    while gone:
        if gone & ONE:
            stack.since[team.element[robot, place]] = frame
        gone >>= ONE
        place += 1


@numba.njit(cache=True)
def most_of(team: Any, terms: Any, robot: int, mask: Any) -> float:
    """The largest term of a robot's elements, of a mask; -1 without any."""
    most, place = -1.0, 0
    while mask:
        if mask & ONE:
            most = max(most, terms[team.element[robot, place]])
        mask >>= ONE
        place += 1
    return most


@numba.njit(cache=True)
def above(team: Any, terms: Any, robot: int, mask: Any, most: float) -> Any:
    """Those of a robot's elements whose terms are larger."""
    found, place = NONE, np.uint64(0)
    while mask >> place:
        if (mask >> place) & ONE and terms[team.element[robot, place]] > most:
            found |= ONE << place
        place += ONE
    return found


@numba.njit(cache=True)
def sum_depends_on(team: Any, stack: Any, frame: int, terms: Any, spare: float, but: int, out: Any) -> None:  # noqa: PLR0917
    """Elements that have to be forbidden for a sum to count no more, as :func:`cover_depends_on`."""
    allowed, robots = stack.allowed[frame], stack.allowed.shape[1]
    more = np.zeros(robots)
    for i in range(robots):
        out[i] = NONE
        if i != but:
            most = most_of(team, terms, i, allowed[i])
            out[i] = above(team, terms, i, stack.start[i] & ~allowed[i], most)
            more[i] = most_of(team, terms, i, stack.start[i]) - most
    _spare_latest(stack, frame, more, spare, out)


@numba.njit(cache=True)
def step(team: Any, stack: Any, frame: int, kind: int, what: int, robot: int, gone: Any) -> None:  # noqa: PLR0917
    """Forbid elements of a robot; why is written by the caller."""
    s = stack.steps[0]
    stack.kind[s], stack.what[s], stack.robot[s], stack.gone[s] = kind, what, robot, gone
    stack.steps[0] = s + 1
    forbid(team, stack, frame, robot, gone)


@numba.njit(cache=True)
def ask_covers(team: Any, covers: Any, stack: Any, frame: int, level: float) -> int:
    """Forbid what covers forbid: how many times; or -1 - the number of one that no plan of the frame meets."""
    allowed, steps = stack.allowed[frame], 0
    for k in range(covers.size[0]):
        left_out = covers.left_out[k]
        if covers.level[k] > level:
            continue
        counted = most_counted(team, allowed, left_out)
        if counted < team.enough:
            return -1 - k
        if counted >= team.enough + team.enough:
            continue
        for i in range(len(allowed)):
            hit = allowed[i] & left_out[i]
            if hit and hit != allowed[i] and counted - team.count[i] < team.enough:
                spare = team.enough - 1.0 - (counted - team.count[i])
                cover_depends_on(team, stack, frame, left_out, spare, i, stack.reason[stack.steps[0]])
                step(team, stack, frame, BY_COVER, k, i, allowed[i] & ~hit)
                steps += 1
    return steps


@numba.njit(cache=True)
def ask_sums(team: Any, sums: Any, stack: Any, frame: int) -> int:
    """The same by sums of covers."""
    allowed, steps, enough = stack.allowed[frame], 0, team.enough - LACKING
    most = np.empty(len(allowed))
    for r in sums.tried:
        terms, total = sums.terms[r], 0.0
        for i in range(len(allowed)):
            most[i] = most_of(team, terms, i, allowed[i])
            total += most[i]
        if total < enough:
            sums.used[r] += 1
            return -1 - int(r)
        for i in range(len(allowed)):
            least = enough - (total - most[i])
            if least > 0.0:
                gone = allowed[i] & ~above(team, terms, i, allowed[i], least)
                if gone:
                    reached = total - most[i] + most_of(team, terms, i, gone)
                    if reached < enough:
                        sum_depends_on(team, stack, frame, terms, enough - reached, i, stack.reason[stack.steps[0]])
                        step(team, stack, frame, BY_SUM, r, i, gone)
                        sums.used[r] += 1
                        steps += 1
    return steps
