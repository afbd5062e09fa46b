"""Whether any group pays the prices, by depth-first search over who is inside and, where it matters, who sees there.

The least cost of a group is a minimum cut but for two counts: how many more robots may see, by their weights ``w``
(:func:`_weigh`), and that at most ``budget`` are blinded, at ``mu`` each. A robot that may see pays a fee for its
weight, or as much as a blinded one, ``mu`` or more; what that is too much for ``room`` and ``budget`` is paid back:

    links cut / 2 - prices + sum of min(fee w, dear) or dear - fee room - (dear - mu) budget

bounds every group of the node. It is concave in both fees; each node climbs along two lines from its parent's, by the
lines of two cuts. There a small cut and a large one cost about the same, the whole team and nobody at first, and a
group between costs much more, as it cuts links: the search asks of the robot of most links on which the two disagree
whether it is inside. Only if weights let a cut pay, whoever sees in it, it asks who does. ``seeing_sets.py`` asks that
first.

Imported only where compiled loops are used.

Source: of the fees, Fisher, The Lagrangian relaxation method for solving integer programming problems, Management
Science 27 (1981).
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from ratt_opt.attackers.by_prices.groups.compiled import add, copy, copy_row, least_level, level_of
from ratt_opt.attackers.by_prices.groups.flow import ALWAYS, augment, open_flow
from ratt_opt.attackers.by_prices.groups.room import SURE, bound_room, close
from ratt_opt.attackers.by_prices.groups.size_forms import BLINDED, ELSE, INSIDE, OPEN, OUTSIDE, SEEING
from ratt_opt.compiling import numba

__all__ = ["MemberStack", "search_member_sets"]

FINISHED, PAUSED, FOUND = 0, 1, 2

MOST_FEES, SAME, FIRST, MOST = 6, 1e-3, 0.1, 1e3
"""Fees tried along a line, and what on it is the same, the first point above none, and the last."""

FLAT = 1e-9
"""Slope that is none."""


class MemberStack(NamedTuple):
    """Open nodes of the search; ``position`` : the last open node, nodes so far.

    For each open node: ``part`` (N,) what robots are; ``sums`` (M, T) of the seeing robots; ``worth`` (N,) value with
    one robot more, ``copies`` (N,) level with ``copied`` copies of one; ``room`` more robots that may see; ``dear``,
    the fee of a blinded robot, and the ``share`` of it that weight pays, where the parent's bound was best; ``grown``
    whether the last robot decided sees
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
        )


@numba.njit(cache=True)
def _begin(team: Any, prices: Any, stack: Any) -> None:
    """The root: every robot open."""
    copy(stack.sums[0], team.prior)
    stack.part[0], stack.room[0], stack.grown[0], stack.copied[0] = OPEN, int(prices.capacity), True, 0
    stack.share[0], stack.dear[0] = 1.0, prices.blinded
    stack.position[0] = 0


@numba.njit(cache=True)
def _weigh(team: Any, threshold: float, stack: Any, weight: Any) -> None:
    """``weight`` (N,) of robots that may see at the last node: of those that do, it adds up to the room at most.

    The level of ``k`` robots, at most the room ``K``, is at least the mean of those of ``k`` copies of each, and these
    rise from the level of none at least by ``k / K`` of what ``K`` copies add.
    """
    node = stack.position[0]
    none, enough = level_of(team, stack.sums[node]), least_level(team, threshold) * (1 + SURE)
    for i in range(len(weight)):
        weight[i] = 1.0
        if stack.room[node] > 1 and none < enough < np.inf:
            weight[i] = max((stack.copies[node, i] - none) / (enough - none), 0.0)


@numba.njit(cache=True)
def _pays(part: int, weight: float, fees: Any) -> float:
    """What a robot inside pays: the fee for its weight if it may see, but not more than one that is blinded."""
    if part == SEEING:
        return 0.0
    return float(fees[1] if part in (ELSE, BLINDED) else min(fees[0] * weight, fees[1]))


@numba.njit(cache=True)
def _cut(  # noqa: PLR0917
    links: Any, prices: Any, part: Any, weight: Any, fees: Any, lower: Any, bound: float, limit: float, work: Any
) -> float:
    """Least cost of a node's groups with these fees, or more than the limit.

    ``fees`` : of weight, and of a blinded robot; ``lower`` : others, neither higher, whose flow, of this ``bound``,
    ``work`` still holds, or (-1, -1)
    ``work`` = (cost (N,), flow, arrays of :func:`augment`, side (N,) of the minimum cut)
    """
    cost, flow, levels, side = work
    if lower[0] >= 0.0:
        for i in range(len(part)):
            flow[1][i] += max(_pays(part[i], weight[i], fees) - _pays(part[i], weight[i], lower), 0.0)
    else:
        for i in range(len(part)):
            cost[i] = _pays(part[i], weight[i], fees) - prices.robot[i]
            if part[i] == BLINDED and links.seeing[i]:  # it cannot be
                cost[i] = ALWAYS
        bound = open_flow(links, cost, flow)
        for i in range(len(part)):
            if part[i] == OUTSIDE:
                flow[1][i] = ALWAYS
            elif part[i] in (SEEING, BLINDED, INSIDE):
                flow[0][i] = ALWAYS
    bound = augment(links, flow, bound, limit, levels)
    for i in range(len(part)):
        side[i] = levels[0][i] >= 0
    return float(bound)


@numba.njit(cache=True)
def _counts(part: Any, weight: Any, fees: Any, side: Any) -> Any:
    """Of a cut: the weight of those that pay for it, how many pay as if blinded, and what all of them pay."""
    weighed, dear, paid = 0.0, 0, 0.0
    for i in range(len(part)):
        if side[i] and part[i] != SEEING:
            pays = _pays(part[i], weight[i], fees)
            paid += pays
            if part[i] in (OPEN, INSIDE) and pays < fees[1]:
                weighed += weight[i]
            else:
                dear += 1
    return weighed, dear, paid


@numba.njit(cache=True)
def _least_blinded(part: Any, weight: Any, room: int, side: Any) -> int:
    """How many of a cut must be blinded, by the weights of the others alone."""
    lightest, n_open, blinded = np.empty(len(part)), 0, 0
    for i in range(len(part)):
        if side[i] and part[i] in (OPEN, INSIDE):
            place = n_open
            while place > 0 and lightest[place - 1] > weight[i]:
                lightest[place] = lightest[place - 1]
                place -= 1
            lightest[place] = weight[i]
            n_open += 1
        elif side[i] and part[i] != SEEING:
            blinded += 1
    seeing, total = 0, 0.0
    while seeing < min(n_open, room) and total + lightest[seeing] <= room:
        total += lightest[seeing]
        seeing += 1
    return int(blinded + n_open - seeing)


@numba.njit(cache=True)
def _next(x: float, least: float, low: Any, high: Any) -> float:
    """Where the lines of the cuts below and above the best point cross; each = (point, bound, slope)."""
    if high[0] == np.inf:
        return max(2.0 * x, FIRST)
    if low[0] < 0.0:
        return least
    return float((high[1] - high[2] * high[0] - low[1] + low[2] * low[0]) / (low[2] - high[2]))


@numba.njit(cache=True)
def _climb(  # noqa: PLR0917
    links: Any, prices: Any, question: Any, stack: Any, weight: Any, by_share: bool, work: Any, sides: Any
) -> Any:
    """The best bound of the last node along a line of fees, and whether weights let the cut ``sides[0]`` pay.

    On the line the fee of weight rises (``by_share``), or both fees in proportion. ``sides`` (2, N) become the cuts
    below and above the best point.
    """
    node, mu, limit, side = stack.position[0], prices.blinded, question.limit, work[3]
    part, room, budget = stack.part[node], stack.room[node], question.budget
    share, dear = stack.share[node], stack.dear[node]
    x, least = (share, 0.0) if by_share else (dear, mu)
    best, cost, lower = -np.inf, 0.0, (-1.0, -1.0)
    low, high = (-1.0, 0.0, 0.0), (np.inf, 0.0, 0.0)
    for _ in range(MOST_FEES):
        share, dear = (x, dear) if by_share else (share, x)
        fees = share * dear, dear
        back = -fees[0] * room - (dear - mu) * budget
        cost = _cut(links, prices, part, weight, fees, lower, cost, limit - back, work)
        lower, bound = fees, cost + back
        if bound > best:
            best, stack.share[node], stack.dear[node] = bound, share, dear
        if bound > limit:
            return best, False
        weighed, n_dear, paid = _counts(part, weight, fees, side)
        if cost - paid <= limit:
            blinded = _least_blinded(part, weight, room, side)
            if blinded <= budget and cost - paid + mu * blinded <= limit:
                copy_row(sides[0], side)
                return best, True
        slope = dear * (weighed - room) if by_share else share * (weighed - room) + n_dear - budget
        if slope > FLAT:
            low = (x, bound, slope)
            copy_row(sides[0], side)
        elif slope < -FLAT and x > least:
            high = (x, bound, slope)
            copy_row(sides[1], side)
        else:
            break
        before, x = x, _next(x, least, low, high)
        if x <= low[0] + SAME or x >= high[0] - SAME or x > MOST:
            break
        lower = lower if x > before else (-1.0, -1.0)
    return best, False


@numba.njit(cache=True)
def _bound(links: Any, prices: Any, question: Any, stack: Any, weight: Any, work: Any, sides: Any) -> Any:  # noqa: PLR0917
    """Reduced cost that no group of the last node falls below, and whether weights let the cut ``sides[0]`` pay."""
    sides[:] = False
    bound, may_pay = _climb(links, prices, question, stack, weight, True, work, sides)
    if bound <= question.limit and not may_pay:
        more, may_pay = _climb(links, prices, question, stack, weight, False, work, sides)
        bound = max(bound, more)
    return bound, may_pay


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
        _weigh(team, question.threshold, stack, weight)
        bound, may_pay = _bound(links, prices, question, stack, weight, work, sides)
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
