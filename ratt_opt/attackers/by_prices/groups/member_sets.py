"""Whether any group pays the prices, by depth-first search over who is inside and, where it matters, who sees there.

With the fees of ``member_bounds.py`` a small cut and a large one cost about the same, the whole team and nobody at
first, and a group between costs much more, as it cuts links: the search asks of the robot of most links on which the
two disagree whether it is inside. Only if weights let a cut pay, whoever sees in it, it asks who does.
``seeing_sets.py`` asks that first.

Imported only where compiled loops are used.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from ratt_opt.attackers.by_prices.groups.compiled import add, copy, copy_row
from ratt_opt.attackers.by_prices.groups.member_bounds import bound_members, weigh
from ratt_opt.attackers.by_prices.groups.room import bound_room, close
from ratt_opt.attackers.by_prices.groups.size_forms import BLINDED, ELSE, INSIDE, OPEN, OUTSIDE, SEEING
from ratt_opt.running.compiling import numba

__all__ = ["MemberStack", "search_member_sets"]

FINISHED, PAUSED, FOUND = 0, 1, 2


class MemberStack(NamedTuple):
    """Open nodes of the search; ``position`` : the last open node, nodes so far.

    For each open node: ``part`` (N,) what robots are; ``sums`` (M, T) of the seeing robots; ``worth`` (N,) value with
    one robot more, ``copies`` (N,) level with ``copied`` copies of one; ``room`` more robots that may see; ``dear``,
    the fee of a blinded robot, and the ``share`` of it that weight pays, where the parent's bound was best; ``grown``
    whether the last robot decided sees; ``weight``, halved at every decision, of 1 at the root
    """

    position: Any
    part: Any
    sums: Any
    worth: Any
    copies: Any
    copied: Any
    room: Any
    share: Any
    dear: Any
    grown: Any
    weight: Any

    @classmethod
    def of(cls, prior: Any, n_robots: int) -> MemberStack:
        """A search that has not begun."""
        depth = 2 * n_robots + 2
        return cls(
            position=np.array([-1, 0], dtype=np.int64),
            part=np.zeros((depth, n_robots), dtype=np.int8),
            sums=np.zeros((depth, *prior.shape)),
            worth=np.zeros((depth, n_robots)),
            copies=np.zeros((depth, n_robots)),
            copied=np.zeros(depth, dtype=np.int64),
            room=np.zeros(depth, dtype=np.int64),
            share=np.zeros(depth),
            dear=np.zeros(depth),
            grown=np.zeros(depth, dtype=np.bool_),
            weight=np.zeros(depth),
        )


@numba.njit(cache=True)
def _begin(team: Any, prices: Any, stack: Any) -> None:
    """The root: every robot open."""
    copy(stack.sums[0], team.prior)
    stack.part[0], stack.room[0], stack.grown[0], stack.copied[0] = OPEN, int(prices.capacity), True, 0
    stack.share[0], stack.dear[0] = 1.0, prices.blinded
    stack.weight[0], stack.position[0] = 1.0, 0


@numba.njit(cache=True)
def _hub(links: Any, part: Any, sides: Any) -> int:
    """The robot of most links that is inside one of the two cuts only; if there is none, in both or neither."""
    chosen, most = -1, -1
    for i in range(len(part)):
        if part[i] == OPEN or part[i] == ELSE:
            score = links.start[i + 1] - links.start[i]
            if sides[0, i] != sides[1, i]:
                score += len(links.robot)
            if score > most:
                chosen, most = i, score
    return int(chosen)


@numba.njit(cache=True)
def _seer(stack: Any, side: Any) -> int:
    """The robot of a cut that may see and is worth most (or is inside for sure); -1 where there is none."""
    node, chosen = stack.position[0], -1
    part, worth = stack.part[node], stack.worth[node]
    for i in range(len(part)):
        can = part[i] == INSIDE or (part[i] == OPEN and side[i])
        if can and (chosen < 0 or worth[i] > worth[chosen]):
            chosen = i
    return int(chosen)


@numba.njit(cache=True)
def _child(stack: Any) -> int:
    """A copy of the last node, after it."""
    node = stack.position[0]
    child = node + 1
    copy(stack.sums[child], stack.sums[node])
    copy_row(stack.part[child], stack.part[node])
    copy_row(stack.worth[child], stack.worth[node])
    copy_row(stack.copies[child], stack.copies[node])
    stack.copied[child], stack.room[child] = stack.copied[node], stack.room[node]
    stack.share[child], stack.dear[child] = stack.share[node], stack.dear[node]
    stack.grown[child], stack.grown[node] = False, False
    stack.weight[node] *= 0.5
    stack.weight[child] = stack.weight[node]
    stack.position[0] = child
    return int(child)


@numba.njit(cache=True)
def _decide_seeing(team: Any, links: Any, stack: Any, robot: int) -> None:
    """Two nodes instead of the last: the robot sees (looked at first), or not."""
    child = _child(stack)
    add(stack.sums[child], stack.sums[child], 1.0, team, robot)
    stack.grown[child], stack.copied[child] = True, 0
    stack.room[child] -= 1
    stack.part[child, robot] = SEEING
    close(links, stack.part[child - 1], robot)


@numba.njit(cache=True)
def _decide_inside(stack: Any, robot: int) -> None:
    """Two nodes instead of the last: the robot is inside (looked at first), or not."""
    child = _child(stack)
    stack.part[child, robot] = INSIDE if stack.part[child, robot] == OPEN else BLINDED
    stack.part[child - 1, robot] = OUTSIDE


@numba.njit(cache=True)
def search_member_sets(team: Any, links: Any, prices: Any, question: Any, stack: Any, nodes: int, found: Any) -> int:  # noqa: PLR0917
    """Continue for at most so many nodes: FINISHED, PAUSED, or FOUND, as ``search_seeing_sets``, with the same prices.

    They may be lowered in place between two calls: what is closed stays closed.
    """
    n_robots, position = len(prices.robot), stack.position
    flow = np.empty(n_robots), np.empty(n_robots), np.empty(len(links.robot))
    levels = np.empty(n_robots, np.int64), np.empty(n_robots, np.int64), np.empty(n_robots, np.int64)
    closed, sides = np.zeros(n_robots, dtype=np.bool_), np.zeros((2, n_robots), dtype=np.bool_)
    weight = np.empty(n_robots)
    work = np.empty(n_robots), flow, levels, np.zeros(n_robots, dtype=np.bool_)
    if position[0] < 0 and position[1] == 0:
        _begin(team, prices, stack)
    for _ in range(nodes):
        node = position[0]
        if node < 0:
            return FINISHED
        position[1] += 1
        part = stack.part[node]
        bound_room(team, links, question.threshold, stack, node, closed)
        weigh(team, question.threshold, stack, weight)
        bound, may_pay = bound_members(links, prices, question, stack, weight, work, sides)
        if bound > question.limit:
            position[0] -= 1
            continue
        hub = -1 if may_pay else _hub(links, part, sides)
        seer = _seer(stack, sides[0]) if hub < 0 else -1
        if hub >= 0:
            _decide_inside(stack, hub)
        elif seer >= 0:
            _decide_seeing(team, links, stack, seer)
        elif may_pay:
            for i in range(n_robots):
                found[0][i] = sides[0, i]
                found[1][i] = sides[0, i] and part[i] != SEEING
            return FOUND
        else:
            position[0] -= 1
    return PAUSED if position[0] >= 0 else FINISHED
