"""What a group of so many robots costs at least, by convex quadratic forms, in compiled code.

Flows mix the whole team with nobody, neither of which cuts a link, where no group of a size between could. At groups
of ``low`` to ``high`` robots half the links cut are at least a convex form, equal to them at one size or two
(``forms.py``). The tangent of a convex form at any point is below it, so with the robots' prices it is a linear cost;
the cheapest group of a node that has room and budget for its robots is put together greedily, as sizes and who may
still see or be blinded are laminar. Steps towards it raise the tangents' bound.

Source: Frank and Wolfe, Naval Research Logistics Quarterly 3 (1956).
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from ratt_opt.attackers.by_prices.groups.compiled import copy, copy_row
from ratt_opt.running.compiling import numba

__all__ = [
    "BLINDED",
    "ELSE",
    "INSIDE",
    "OPEN",
    "OUTSIDE",
    "SEEING",
    "FormPoints",
    "SizeForms",
    "copy_points",
    "open_form",
]

OPEN, SEEING, ELSE, BLINDED, OUTSIDE, INSIDE = 0, 1, 2, 3, 4, 5
"""What a robot of a node is: ELSE is blinded or outside the group, INSIDE sees or is blinded (``member_sets.py``)."""

STEPS, LOOKS = 12, 2
"""Steps for a form at a node, and after how many of them it is given up if its point costs less than the limit."""

FLAT = 1e-12


class SizeForms(NamedTuple):
    """``x' form x / 2 + linear' x + constant`` is at most half the links cut, for groups of ``low`` to ``high`` robots.

    ``form`` : (K, N, N) positive semidefinite; ``linear`` : (K, N); ``constant``, ``low``, ``high`` : (K,)
    """

    form: Any
    linear: Any
    constant: Any
    low: Any
    high: Any


class FormPoints(NamedTuple):
    """For each node and form: a point ``at`` (N,), what its blinded robots ``paid``, and whether it is ``done`` with.

    Robots fixed since then are put where they are; blinded ones of the others are paid for in ``paid``.
    """

    at: Any
    paid: Any
    done: Any

    @classmethod
    def of(cls, depth: int, n_forms: int, n_robots: int) -> FormPoints:
        """At nobody."""
        shape = depth, n_forms
        return cls(at=np.zeros((*shape, n_robots)), paid=np.zeros(shape), done=np.zeros(shape, dtype=np.bool_))


@numba.njit(cache=True)
def copy_points(points: Any, source: int, target: int) -> None:
    """Copy the points of one node of a search to another."""
    copy(points.at[target], points.at[source])
    copy_row(points.paid[target], points.paid[source])
    copy_row(points.done[target], points.done[source])


@numba.njit(cache=True)
def _sort(order: Any, key: Any) -> None:
    """By rising key; hardly anything to do where the order was nearly right."""
    for k in range(1, len(order)):
        robot, place = order[k], k
        while place > 0 and key[order[place - 1]] > key[robot]:
            order[place] = order[place - 1]
            place -= 1
        order[place] = robot


@numba.njit(cache=True)
def _fixed(part: Any, cost: Any, chosen: Any) -> Any:
    """Choose the robots that are inside for sure; returns how many and what they cost."""
    count, total = 0, 0.0
    for i in range(len(part)):
        inside = part[i] == SEEING or part[i] == BLINDED
        chosen[i] = 1.0 if inside else 0.0
        if inside:
            count += 1
            total += cost[i]
    return count, total


@numba.njit(cache=True)
def _cheapest(part: Any, cost: Any, blinded: float, most: Any, order: Any, chosen: Any) -> Any:  # noqa: PLR0917
    """The least of ``cost`` (N,) of those inside and ``blinded`` of each blinded one; (that, blinded ones).

    ``most`` : that see besides, that are blinded besides, least and most robots; infinite where there is no group.
    ``order`` : (N,) is sorted; ``chosen`` : (N,) becomes 1 for robots inside
    """
    room, budget, low, high = most
    _sort(order, cost)
    count, total = _fixed(part, cost, chosen)
    n_robots, sees, other, passed, paying = len(part), 0, 0, 0, 0
    while count < high:
        while sees < n_robots and part[order[sees]] != OPEN:
            sees += 1
        while other < n_robots and (part[order[other]] != ELSE) and (part[order[other]] != OPEN or passed < most[0]):
            passed += int(part[order[other]] == OPEN)
            other += 1
        seeing = cost[order[sees]] if room > 0 and sees < n_robots else np.inf
        paid = cost[order[other]] + blinded if budget > 0 and other < n_robots else np.inf
        least = min(seeing, paid)
        if least == np.inf or (least >= 0.0 and count >= low):
            break
        if seeing <= paid:
            chosen[order[sees]] = 1.0
            room, sees = room - 1, sees + 1
        else:
            chosen[order[other]] = 1.0
            budget, other, paying = budget - 1, other + 1, paying + 1
        count, total = count + 1, total + least
    return (total if count >= low else np.inf), paying


@numba.njit(cache=True)
def _times(form: Any, x: Any, product: Any) -> None:
    """``product[:] = form x``."""
    for j in range(len(x)):
        product[j] = 0.0
    for i in range(len(x)):
        if x[i] != 0.0:
            for j in range(len(x)):
                product[j] += x[i] * form[i, j]


@numba.njit(cache=True)
def _place(part: Any, x: Any) -> None:
    """Put decided robots where they are."""
    for i in range(len(part)):
        if part[i] == SEEING or part[i] == BLINDED:
            x[i] = 1.0
        elif part[i] == OUTSIDE:
            x[i] = 0.0


@numba.njit(cache=True)
def _dot(a: Any, b: Any) -> float:
    total = 0.0
    for i in range(len(a)):
        total += a[i] * b[i]
    return total


@numba.njit(cache=True)
def _costs_more(forms: Any, k: int, prices: Any, question: Any, state: Any, work: Any) -> bool:  # noqa: PLR0917
    """Whether form ``k`` proves that no group of its sizes costs as little as the limit.

    ``state`` : what robots are (N,), room and blinded ones, the point (N,) and what its blinded robots paid (1,)
    """
    part, room, fixed, x, paid = state
    slope, chosen, turned, order = work
    _place(part, x)
    most = room, question.budget - fixed, forms.low[k], forms.high[k]
    _times(forms.form[k], x, slope)
    value = forms.constant[k] + prices.blinded * fixed
    for i in range(len(x)):
        linear = forms.linear[k, i] - prices.robot[i]
        value += x[i] * (0.5 * slope[i] + linear)
        slope[i] += linear
    for step in range(STEPS):
        cost, blinded = _cheapest(part, slope, prices.blinded, most, order, chosen)
        falls = cost - _dot(slope, x) - paid[0]
        if value + paid[0] + falls > question.limit:
            return True
        if falls >= 0.0 or (step >= LOOKS and value + paid[0] < question.limit):
            return False
        for i in range(len(x)):
            chosen[i] -= x[i]
        _times(forms.form[k], chosen, turned)
        curved, rise = _dot(chosen, turned), prices.blinded * blinded - paid[0]
        length = min(-falls / curved, 1.0) if curved > FLAT else 1.0
        value += length * (falls - rise) + 0.5 * length * length * curved
        paid[0] += length * rise
        for i in range(len(x)):
            x[i] += length * chosen[i]
            slope[i] += length * turned[i]
    return False


@numba.njit(cache=True)
def open_form(prices: Any, question: Any, points: Any, state: Any, work: Any) -> int:
    """The first form that does not prove that no group of a node pays; K where all do, -1 where there is none.

    ``state`` : the node, what its robots are (N,), how many more may see, and how many are blinded for sure
    ``work`` : three (N,), and an order (N,)
    """
    node, part, room, blinded = state
    forms, n_forms = prices.forms, len(prices.forms.constant)
    for k in range(n_forms):
        if not points.done[node, k]:
            at = part, room, blinded, points.at[node, k], points.paid[node, k : k + 1]
            points.done[node, k] = _costs_more(forms, k, prices, question, at, work)
            if not points.done[node, k]:
                return k
    return n_forms if n_forms else -1
