"""Sets of one size that are weak along an axis of one target and pay more than a limit: ruled out, or found.

Under the max-eigenvalue criterion a set ``S`` is weak where ``v' Lambda_j(S) v`` stays below a cap for some target
``j`` and some unit vector ``v``. With ``v`` at angle ``t / 2`` that is linear in ``u(t) = (1, cos t, sin t)``. For
any multiplier >= 0 a weak set that pays more than the limit has

    height(S, u) - multiplier (price(S) - limit) < cap,

whose least left side over sets of a size is a sum of smallest terms, concave in ``u``; on an arc it is least at a
corner of a triangle around the arc (see ``weakest_set/weakest_axis.py``). A node is an arc, and robots inside and
outside; it is divided at the middle of the arc where the arc is what is lost, else by the robot that is least clear,
as in a knapsack (whose relaxation this is). At 60 robots, 40 targets, an arc or node takes some six microseconds, and
all sets of a size are mostly ruled out in a few milliseconds, where bounds on pairs of robots did not end.

Imported only where a large team is attacked: compiling takes seconds, once per machine (cached).
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from ratt_opt.attackers.by_size.family_prices.axis_nodes import (
    INSIDE,
    OPEN,
    OUTSIDE,
    SHORTEST,
    divide_by,
    halve_arc,
    join,
)
from ratt_opt.attackers.weakest_set.selection import move_least_first
from ratt_opt.running.compiling import numba

__all__ = ["search_axes"]

FINISHED, PAUSED, FOUND = 0, 1, 2
WIDE = 0.1
"""Half-width above which an arc is always divided."""
ARC_SHARE = 0.3
"""Share of what a node lacks that is lost to the width of its arc from which the arc is divided."""
STEPS, FACTOR, NEARLY = 20, 8.0, 0.05
"""Multipliers tried at a node at most, how far apart the first ones are, and what is missed then, of what is lacked."""
ROUNDING = 1e-12
"""Margin for rounding, relative to the sum of the terms of a bound."""


class _Work(NamedTuple):
    """Arrays of a node: open ``robots`` (N,), their ``heights`` (4, N) at the corners and in the middle, those of the
    robots inside (4,), ``scores`` (4, N), ``last`` and ``following`` (3,) chosen and not chosen score at each corner,
    ``bounds`` (4,) and ``row`` (N,).
    """

    robots: Any
    heights: Any
    inside: Any
    scores: Any
    last: Any
    following: Any
    bounds: Any
    row: Any


@numba.njit(cache=True)
def _fill(nodes: Any, work: Any) -> int:
    """Heights of the open robots of the last node at the corners of its arc and in the middle; how many there are."""
    node, count = nodes.position[0], 0
    middle, half = nodes.arc[node]
    for i in range(nodes.side.shape[1]):
        if nodes.side[node, i] == OPEN:
            work.robots[count] = i
            count += 1
    for c in range(4):
        angle = middle + (-half if c == 0 else half if c == 1 else 0.0)
        scale = np.cos(half) if c == 2 else 1.0
        one, two = np.cos(angle) / scale, np.sin(angle) / scale
        work.inside[c] = nodes.sums[node, 0] + nodes.sums[node, 1] * one + nodes.sums[node, 2] * two
        for x in range(count):
            i = work.robots[x]
            work.heights[c, x] = nodes.linear[i, 0] + nodes.linear[i, 1] * one + nodes.linear[i, 2] * two
    for x in range(count):
        if work.heights[2, x] < 0:
            work.heights[:3, x] = _least_height(nodes.linear[work.robots[x]], middle, half)
    return count


@numba.njit(cache=True)
def _least_height(linear: Any, middle: float, half: float) -> float:
    """The least height of a robot on an arc, at least 0: as good a minorant as the height, which is linear."""
    flat = np.arctan2(-linear[2], -linear[1])  # where it is least on the circle
    away = abs((flat - middle + np.pi) % (2 * np.pi) - np.pi)
    least = linear[0] - np.hypot(linear[1], linear[2]) * np.cos(max(away - half, 0.0))
    return float(max(least, 0.0))


@numba.njit(cache=True)
def _slack(question: Any, nodes: Any, work: Any, count: int, multiplier: float) -> Any:
    """By how much the bound surely exceeds the cap with this multiplier, and its slope; fills ``bounds``."""
    node = nodes.position[0]
    left, least, slope = nodes.left[node], np.inf, 0.0
    asked = question.limit - nodes.paid[node]
    for c in range(3):
        for x in range(count):
            work.row[x] = work.heights[c, x] - multiplier * question.prices[work.robots[x]]
        chosen = work.row[:count].copy()
        last = move_least_first(chosen, left)
        chosen = chosen[:left]
        margin = ROUNDING * (np.abs(chosen).sum() + abs(work.inside[c]) + multiplier * abs(asked) + nodes.cap)
        work.bounds[c] = chosen.sum() + work.inside[c] + multiplier * asked - nodes.cap - margin
        if work.bounds[c] < least:
            least = work.bounds[c]
            slope = asked - _price_of_least(question, work, count, left, last)
    return least, slope


@numba.njit(cache=True)
def _price_of_least(question: Any, work: Any, count: int, left: int, last: float) -> float:
    """What the robots of the ``left`` smallest entries of ``row`` pay; the largest of these is ``last``."""
    paid, tied = 0.0, left
    for x in range(count):
        if work.row[x] < last:
            paid += question.prices[work.robots[x]]
            tied -= 1
    for x in range(count):
        if work.row[x] == last and tied > 0:
            paid += question.prices[work.robots[x]]
            tied -= 1
    return paid


@numba.njit(cache=True)
def _best_slack(question: Any, nodes: Any, work: Any, count: int) -> float:
    """The same with about the best multiplier, which the node keeps: the top of a concave function, between two lines.

    Ends early where the bound reaches the cap.
    """
    node = nodes.position[0]
    low, multiplier, best, at = 0.0, nodes.multiplier[node], -np.inf, 0.0
    low_line, high_line, high = (0.0, np.inf), (0.0, 0.0), np.inf
    for _ in range(STEPS):
        slack, slope = _slack(question, nodes, work, count, multiplier)
        if slack > best:
            best, at = slack, multiplier
        if slack >= 0 or slope == 0 or (slope < 0 and multiplier == 0.0):
            break
        if slope > 0:
            low, low_line = multiplier, (slope, slack - slope * multiplier)
        else:
            high, high_line = multiplier, (slope, slack - slope * multiplier)
        if high == np.inf:
            multiplier *= FACTOR
        elif low_line[1] == np.inf:
            multiplier = 0.0
        else:
            multiplier = (high_line[1] - low_line[1]) / (low_line[0] - high_line[0])
            if not low < multiplier < high or low_line[0] * multiplier + low_line[1] - best <= NEARLY * -best:
                break
    nodes.multiplier[node] = max(at, nodes.smallest)
    return float(_slack(question, nodes, work, count, nodes.multiplier[node])[0])


@numba.njit(cache=True)
def _score(question: Any, nodes: Any, work: Any, count: int) -> None:
    """Scores at the corners and in the middle with the node's multiplier, and what is next to be chosen there."""
    node = nodes.position[0]
    left, multiplier = nodes.left[node], nodes.multiplier[node]
    for c in range(4):
        for x in range(count):
            work.scores[c, x] = work.heights[c, x] - multiplier * question.prices[work.robots[x]]
        rising = np.sort(work.scores[c, :count])
        work.last[c], work.following[c] = rising[left - 1], rising[left] if left < count else np.inf
        if c == 3:
            paid = multiplier * (nodes.paid[node] - question.limit)
            work.bounds[c] = rising[:left].sum() + work.inside[c] - paid - nodes.cap


@numba.njit(cache=True)
def _find(question: Any, nodes: Any, work: Any, count: int, members: Any) -> bool:
    """Whether the best set in the middle of the arc is weak there and pays; ``members`` is that set."""
    node = nodes.position[0]
    height, paid, chosen = work.inside[3], nodes.paid[node], 0
    for x in range(count):
        if work.scores[3, x] <= work.last[3] and chosen < nodes.left[node]:
            chosen += 1
            height += work.heights[3, x]
            paid += question.prices[work.robots[x]]
    if chosen < nodes.left[node] or not (height < nodes.cap and paid > question.limit):
        return False
    members[:] = nodes.side[node] == INSIDE
    chosen = 0
    for x in range(count):
        if work.scores[3, x] <= work.last[3] and chosen < nodes.left[node]:
            chosen += 1
            members[work.robots[x]] = True
    return True


@numba.njit(cache=True)
def _decide_robots(question: Any, nodes: Any, work: Any, count: int) -> int:
    """Decide robots with or without which the bound reaches the cap at every corner; the least clear other one, or -1.

    A robot decided now does not count for those after it, which only keeps them open.
    """
    node, pick, clearness = nodes.position[0], -1, np.inf
    for x in range(count):
        with_it, without = np.inf, np.inf
        for c in range(3):
            score = work.scores[c, x]
            with_it = min(with_it, work.bounds[c] + max(score - work.last[c], 0.0))
            without = min(without, work.bounds[c] + max(work.following[c] - score, 0.0))
        if with_it >= 0:
            nodes.side[node, work.robots[x]] = OUTSIDE
        elif without >= 0:
            join(question, nodes, node, work.robots[x])
        else:
            score = work.scores[3, x]
            clear = max(score - work.last[3], work.following[3] - score)
            if clear < clearness:
                pick, clearness = work.robots[x], clear
    return pick


@numba.njit(cache=True)
def _is_wide(half: float, slack: float, in_the_middle: float) -> bool:
    """Whether the arc is to be divided rather than the robots."""
    return half > WIDE or (half > SHORTEST and in_the_middle - slack >= ARC_SHARE * -slack)


@numba.njit(cache=True)
def _most_paid(question: Any, nodes: Any, work: Any, count: int) -> float:
    """What the sets of the last node pay at most."""
    node = nodes.position[0]
    prices = np.sort(question.prices[work.robots[:count]])
    return float(nodes.paid[node] + prices[count - nodes.left[node] :].sum())


@numba.njit(cache=True)
def search_axes(view: Any, question: Any, nodes: Any, most: int, members: Any) -> int:  # noqa: ARG001
    """Continue for at most so many nodes: FINISHED, PAUSED, or FOUND with a set in ``members`` (N,).

    The node in which a set is found stays open: the caller has to raise the question's limit.
    """
    n, position = len(question.prices), nodes.position
    work = _Work(
        np.empty(n, dtype=np.int64),
        np.empty((4, n)),
        np.empty(4),
        np.empty((4, n)),
        np.empty(4),
        np.empty(4),
        np.empty(4),
        np.empty(n),
    )
    for _ in range(most):
        node = position[0]
        if node < 0:
            return FINISHED
        position[1] += 1
        count, left = _fill(nodes, work), nodes.left[node]
        if count < left or left < 0 or _most_paid(question, nodes, work, count) <= question.limit:
            position[0] -= 1
            continue
        if left == 0:
            position[0] -= 1
            sums = nodes.sums[node]
            if sums[0] - np.hypot(sums[1], sums[2]) < nodes.cap:
                members[:] = nodes.side[node] == INSIDE
                return FOUND
            continue
        slack = _best_slack(question, nodes, work, count)
        if slack >= 0:
            position[0] -= 1
            continue
        _score(question, nodes, work, count)
        if _find(question, nodes, work, count, members):
            return FOUND
        robot = _decide_robots(question, nodes, work, count)
        if robot >= 0 and _is_wide(nodes.arc[node, 1], slack, work.bounds[3]):
            halve_arc(nodes)
        elif robot >= 0:
            divide_by(question, nodes, robot)
    return FINISHED if position[0] < 0 else PAUSED
