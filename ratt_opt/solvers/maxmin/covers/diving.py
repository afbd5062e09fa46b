"""The loops of a search in depth, compiled: covers as conditions that forbid, and what a dead end did not depend on.

A frame fixes one robot's element. In a frame, steps forbid elements. If a cover asks for as many robots as can still
meet it, each of them must choose among what the cover leaves out. Sums of covers forbid likewise. An element
that was fixed in a frame above is forbidden once that frame was a dead end.

Masks of elements, one a robot, say what each step and each dead end depends on: elements that were forbidden before. A
dead end that does not depend on what a frame fixed is one of the frame before, too. So both are left at once, and the
frames and steps on which nothing depends do not enter the proof (conflict-directed backjumping, Prosser 1993).

If one attack leaves no plan of a frame more than the level, the frame is a dead end by a new cover. The cover then
keeps as many elements more as it can, those first that were forbidden last.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from ratt_opt.compiling import numba
from ratt_opt.solvers.maxmin.covers.keeping import keep, raised, value_of

__all__ = ["FULL", "PLAN", "PROVED", "SPENT", "Record", "Stack", "Sums", "Ways", "dive"]

PROVED, SPENT, PLAN, FULL = 0, 1, 2, 3
"""How a run ends: nothing is left, its nodes are spent, one plan is left, or an array is full."""
BY_COVER, BY_SUM, TRIED = 0, 1, 2
"""What forbids an element, or ends a frame: a cover, a sum of covers, or that the element was a dead end."""
NONE = np.uint64(0)
ONE = np.uint64(1)
RECENT = 100
"""Covers by which elements are chosen."""
LACKING = 1e-6
"""What plans have to lack of a sum at least: its weights have errors of 1e-9."""


class Ways(NamedTuple):
    """Partitions ``of`` (P, S) of groups, padded by -1, in the ``order`` in which they are tried.

    ``members`` (G, N), ``inside`` (G, E) : which robots and elements are in each group
    """

    members: Any
    inside: Any
    of: Any
    order: Any


class Sums(NamedTuple):
    """Sums of covers by number: what each element counts, ``terms`` (R, E), of which plans have to count ``enough``.

    ``tried`` (A,) : those that are looked at; ``used`` (R,) : how often each was of use
    """

    terms: Any
    tried: Any
    used: Any


class Stack(NamedTuple):
    """Frames and steps.

    ``start`` (N,) : masks of what is allowed at first; ``allowed`` (N + 1, N) : in each frame
    ``strongest`` (N + 1, N, M, T) : bounds of what allowed elements tell; ``fixed`` (N + 1,) : each frame's element
    ``first`` (N + 2,) : the first step of each frame
    ``kind``, ``what``, ``robot``, ``gone`` (E + 1,), ``reason`` (E + 1, N) : steps, what they forbid, and why
    ``since`` (E,) : the frame in which an element was forbidden last; ``touched`` (N + 1, N) : the same of robots
    ``activity`` (N,) : dead ends that depended on a robot's elements
    """

    start: Any
    allowed: Any
    strongest: Any
    fixed: Any
    first: Any
    kind: Any
    what: Any
    robot: Any
    gone: Any
    reason: Any
    since: Any
    touched: Any
    activity: Any
    frame: Any
    steps: Any


class Record(NamedTuple):
    """``nodes`` (R, 5) : kind, its subject, robot, element's place, the next node; the last one is the root.

    The subject is a cover, a sum, or the node of the dead end. What ends a frame has robot -1.
    """

    nodes: Any
    size: Any


@numba.njit(cache=True)
def _bits(mask: Any) -> int:
    count = 0
    while mask:
        mask &= mask - ONE
        count += 1
    return count


@numba.njit(cache=True)
def bound_robot(team: Any, robot: int, mask: Any, out: Any) -> None:
    """``out`` (M, T) = no less than what any element of the mask tells."""
    for j in range(len(out)):
        for k in range(out.shape[1]):
            out[j, k] = 0.0
    place = 0
    while mask:
        if mask & ONE:
            e = team.element[robot, place]
            for j in range(len(out)):
                if team.sees[e, j]:
                    raised(out[j], team.information[e, j], out[j])
        mask >>= ONE
        place += 1


@numba.njit(cache=True)
def _worth(team: Any, sums: Any, values: Any) -> float:
    total = 0.0
    for j in range(len(values)):
        values[j] = value_of(team, j, sums[j])
        total += values[j]
    return total


@numba.njit(cache=True)
def _add(matrices: Any, sign: float, sums: Any) -> None:
    for j in range(len(sums)):
        for k in range(sums.shape[1]):
            sums[j, k] += sign * matrices[j, k]


@numba.njit(cache=True)
def _tells(matrices: Any, j: int) -> bool:
    return bool(matrices[j, 0] != 0.0 or matrices[j, -1] != 0.0)


@numba.njit(cache=True)
def blind(team: Any, strongest: Any, members: Any, level: float, most: int, blinded: Any) -> int:  # noqa: PLR0917
    """How many robots of a group to blind until it is worth at most the level: greedily, then by exchanges.

    More than ``most`` where that is not enough. ``blinded`` : (N,) set to these robots
    """
    robots, values, sums = len(members), np.empty(len(team.prior)), team.prior.copy()
    for i in range(robots):
        blinded[i] = False
        if members[i]:
            _add(strongest[i], 1.0, sums)
    worth, count = _worth(team, sums, values), 0
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
        _add(strongest[best], -1.0, sums)
        worth, count = _worth(team, sums, values), count + 1
    improved = count == most and most > 0
    while worth > level and improved:
        improved = False
        for a in range(robots):
            for b in range(robots):
                if blinded[a] and members[b] and not blinded[b] and not team.safe[b]:
                    left = _exchanged(team, strongest, sums, values, a, b)
                    if left < worth - 1e-9 * abs(worth):
                        _add(strongest[a], 1.0, sums)
                        _add(strongest[b], -1.0, sums)
                        blinded[a], blinded[b], improved = False, True, True
                        worth = _worth(team, sums, values)
    return count if worth <= level else most + 1


@numba.njit(cache=True)
def _exchanged(team: Any, strongest: Any, sums: Any, values: Any, back: int, blinded: int) -> float:  # noqa: PLR0917
    """What is left of a group where one more robot is blinded, in exchange for one that sees again, or N."""
    total, matrix = 0.0, np.empty(sums.shape[1])
    for j in range(len(values)):
        if _tells(strongest[blinded], j) or (back < len(strongest) and _tells(strongest[back], j)):
            for k in range(len(matrix)):
                matrix[k] = sums[j, k] - strongest[blinded, j, k]
                if back < len(strongest):
                    matrix[k] += strongest[back, j, k]
            total += value_of(team, j, matrix)
        else:
            total += values[j]
    return total


@numba.njit(cache=True)
def _counted(team: Any, allowed: Any, left_out: Any) -> float:
    """The most that plans count in a cover."""
    total = 0.0
    for i in range(len(allowed)):
        if allowed[i] & left_out[i]:
            total += team.count[i]
    return total


@numba.njit(cache=True)
def _depends_on(team: Any, stack: Any, frame: int, left_out: Any, spare: float, but: int, out: Any) -> None:  # noqa: PLR0917
    """Elements that have to be forbidden for a cover to count no more: of all robots that it does not count, but one.

    ``spare`` : how much more it may count; robots whose elements were forbidden last are spared
    """
    allowed, robots = stack.allowed[frame], len(left_out)
    for i in range(robots):
        out[i] = NONE if allowed[i] & left_out[i] or i == but else left_out[i] & stack.start[i]
    while spare >= 1.0:
        latest = -1
        for i in range(robots):
            if (
                out[i]
                and team.count[i] <= spare
                and (latest < 0 or stack.touched[frame, i] > stack.touched[frame, latest])
            ):
                latest = i
        if latest < 0:
            return
        out[latest] = NONE
        spare -= team.count[latest]


@numba.njit(cache=True)
def _forbid(team: Any, stack: Any, frame: int, robot: int, gone: Any) -> None:
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
def _most(team: Any, terms: Any, robot: int, mask: Any) -> float:
    """The largest term of a robot's elements, of a mask; -1 without any."""
    most, place = -1.0, 0
    while mask:
        if mask & ONE:
            most = max(most, terms[team.element[robot, place]])
        mask >>= ONE
        place += 1
    return most


@numba.njit(cache=True)
def _above(team: Any, terms: Any, robot: int, mask: Any, most: float) -> Any:
    """Those of a robot's elements whose terms are larger."""
    found, place = NONE, np.uint64(0)
    while mask >> place:
        if (mask >> place) & ONE and terms[team.element[robot, place]] > most:
            found |= ONE << place
        place += ONE
    return found


@numba.njit(cache=True)
def _sum_depends_on(team: Any, stack: Any, frame: int, terms: Any, spare: float, but: int, out: Any) -> None:  # noqa: PLR0917
    """Elements that have to be forbidden for a sum to count no more, as :func:`_depends_on`."""
    allowed, robots = stack.allowed[frame], stack.allowed.shape[1]
    more = np.zeros(robots)
    for i in range(robots):
        out[i] = NONE
        if i != but:
            most = _most(team, terms, i, allowed[i])
            out[i] = _above(team, terms, i, stack.start[i] & ~allowed[i], most)
            more[i] = _most(team, terms, i, stack.start[i]) - most
    while True:
        latest = robots
        for i in range(robots):
            if (
                out[i]
                and more[i] <= spare
                and (latest == robots or stack.touched[frame, i] > stack.touched[frame, latest])
            ):
                latest = i
        if latest == robots:
            return
        out[latest] = NONE
        spare -= more[latest]


@numba.njit(cache=True)
def _step(team: Any, stack: Any, frame: int, kind: int, what: int, robot: int, gone: Any) -> None:  # noqa: PLR0917
    """Forbid elements of a robot; why is written by the caller."""
    s = stack.steps[0]
    stack.kind[s], stack.what[s], stack.robot[s], stack.gone[s] = kind, what, robot, gone
    stack.steps[0] = s + 1
    _forbid(team, stack, frame, robot, gone)


@numba.njit(cache=True)
def _ask_covers(team: Any, covers: Any, stack: Any, frame: int, level: float) -> int:
    """Forbid what covers forbid: how many times; or -1 - the number of one that no plan of the frame meets."""
    allowed, steps = stack.allowed[frame], 0
    for k in range(covers.size[0]):
        left_out = covers.left_out[k]
        if covers.level[k] > level:
            continue
        counted = _counted(team, allowed, left_out)
        if counted < team.enough:
            return -1 - k
        if counted >= team.enough + team.enough:
            continue
        for i in range(len(allowed)):
            hit = allowed[i] & left_out[i]
            if hit and hit != allowed[i] and counted - team.count[i] < team.enough:
                spare = team.enough - 1.0 - (counted - team.count[i])
                _depends_on(team, stack, frame, left_out, spare, i, stack.reason[stack.steps[0]])
                _step(team, stack, frame, BY_COVER, k, i, allowed[i] & ~hit)
                steps += 1
    return steps


@numba.njit(cache=True)
def _ask_sums(team: Any, sums: Any, stack: Any, frame: int) -> int:
    """The same by sums of covers."""
    allowed, steps, enough = stack.allowed[frame], 0, team.enough - LACKING
    most = np.empty(len(allowed))
    for r in sums.tried:
        terms, total = sums.terms[r], 0.0
        for i in range(len(allowed)):
            most[i] = _most(team, terms, i, allowed[i])
            total += most[i]
        if total < enough:
            sums.used[r] += 1
            return -1 - int(r)
        for i in range(len(allowed)):
            least = enough - (total - most[i])
            if least > 0.0:
                gone = allowed[i] & ~_above(team, terms, i, allowed[i], least)
                if gone:
                    reached = total - most[i] + _most(team, terms, i, gone)
                    if reached < enough:
                        _sum_depends_on(team, stack, frame, terms, enough - reached, i, stack.reason[stack.steps[0]])
                        _step(team, stack, frame, BY_SUM, r, i, gone)
                        sums.used[r] += 1
                        steps += 1
    return steps


@numba.njit(cache=True)
def _attack(team: Any, ways: Any, covers: Any, stack: Any, frame: int, level: float, most: int) -> int:  # noqa: PLR0917
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
def _leave(team: Any, covers: Any, sums: Any, stack: Any, record: Any, kind: int, what: int) -> bool:  # noqa: PLR0917
    """Leave a dead end, and the frames before it that are dead ends for the same reason; whether all are."""
    frame = stack.frame[0]
    allowed, conflict = stack.allowed[frame], np.empty(stack.allowed.shape[1], np.uint64)
    robots = len(conflict)
    if kind == BY_COVER:
        spare = team.enough - 1.0 - _counted(team, allowed, covers.left_out[what])
        _depends_on(team, stack, frame, covers.left_out[what], spare, robots, conflict)
    else:
        spare = team.enough - LACKING
        for i in range(robots):
            spare -= _most(team, sums.terms[what], i, allowed[i])
        _sum_depends_on(team, stack, frame, sums.terms[what], spare, robots, conflict)
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
            _step(team, stack, frame, TRIED, proof, i, own)
            stack.frame[0] = frame
            return False


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
    _forbid(team, stack, frame + 1, robot, allowed[robot] & ~(ONE << np.uint64(best)))
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
            found, kind = _ask_covers(team, covers, stack, frame, level), BY_COVER
            if found == 0:
                found, kind = _ask_sums(team, sums, stack, frame), BY_SUM
        what = -1 - found
        if found == 0:
            what, kind = _attack(team, ways, covers, stack, frame, level, most), BY_COVER
        if what >= 0:
            if _leave(team, covers, sums, stack, record, kind, what):
                return PROVED
        elif not _fix(team, covers, stack):
            return PLAN
    return SPENT
