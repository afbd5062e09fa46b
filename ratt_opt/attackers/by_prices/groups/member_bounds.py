"""What every group of a node costs at least, where it is asked who is inside: flows with a fee for those that may see.

The least cost of a group is a minimum cut but for two counts: how many more robots may see, by their weights ``w``
(:func:`weigh`), and that at most ``budget`` are blinded, at ``mu`` each. A robot that may see pays a fee for its
weight, or as much as a blinded one, ``mu`` or more; what that is too much for ``room`` and ``budget`` is paid back:

    links cut / 2 - prices + sum of min(fee w, dear) or dear - fee room - (dear - mu) budget

bounds every group of the node. It is concave in both fees; each node climbs along two lines from its parent's, by the
lines of two cuts.

Imported only where compiled loops are used.

Source: of the fees, Fisher, The Lagrangian relaxation method for solving integer programming problems, Management
Science 27 (1981).
"""

from __future__ import annotations

from typing import Any

import numpy as np

from ratt_opt.attackers.by_prices.groups.compiled import copy_row, least_level, level_of
from ratt_opt.attackers.by_prices.groups.flow import ALWAYS, augment, open_flow
from ratt_opt.attackers.by_prices.groups.room import SURE
from ratt_opt.attackers.by_prices.groups.size_forms import BLINDED, ELSE, INSIDE, OPEN, OUTSIDE, SEEING
from ratt_opt.running.compiling import numba

__all__ = ["bound_members", "weigh"]

MOST_FEES, SAME, FIRST, MOST = 6, 1e-3, 0.1, 1e3
"""Fees tried along a line, and what on it is the same, the first point above none, and the last."""

FLAT = 1e-9
"""Slope that is none."""


@numba.njit(cache=True)
def weigh(team: Any, threshold: float, stack: Any, weight: Any) -> None:
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
def bound_members(links: Any, prices: Any, question: Any, stack: Any, weight: Any, work: Any, sides: Any) -> Any:  # noqa: PLR0917
    """Reduced cost that no group of the last node falls below, and whether weights let the cut ``sides[0]`` pay."""
    sides[:] = False
    bound, may_pay = _climb(links, prices, question, stack, weight, True, work, sides)
    if bound <= question.limit and not may_pay:
        more, may_pay = _climb(links, prices, question, stack, weight, False, work, sides)
        bound = max(bound, more)
    return bound, may_pay
