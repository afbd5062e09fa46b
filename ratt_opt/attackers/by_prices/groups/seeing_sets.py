"""Whether any group pays the prices, by depth-first search over the robots left seeing in it, in compiled code.

A group ``g`` whose seeing robots are ``S`` costs ``cut(g) / 2 + mu |g - S| - pi(g)``. Of a node some robots see, some
do not (they are blinded or outside, as a minimum cut finds best), and some are open. At most ``room`` open robots can
still see, or the group would be worth the threshold, and at most ``budget`` are blinded. A flow bounds all groups of
the node: a blinded robot pays ``mu`` and a surcharge, which is paid back ``budget`` times; an open robot pays a share
of both, which is paid back ``room`` times. Convex forms bound the groups of a few sizes each (``size_forms.py``), with
room and budget kept exactly. Seeing robots are few where values saturate early, while groups may be large:
``columns.py`` decides who is inside instead.

Imported only where compiled loops are used.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from ratt_opt.attackers.by_prices.groups.compiled import add, copy, copy_row
from ratt_opt.attackers.by_prices.groups.connections import connected_bound
from ratt_opt.attackers.by_prices.groups.flow import ALWAYS, always, augment, copy_flows, open_flow
from ratt_opt.attackers.by_prices.groups.room import bound_room, close, count
from ratt_opt.attackers.by_prices.groups.size_forms import (
    BLINDED,
    ELSE,
    OPEN,
    OUTSIDE,
    SEEING,
    FormPoints,
    copy_points,
    open_form,
)
from ratt_opt.running.compiling import numba

__all__ = ["Flows", "SeeingStack", "leave_node", "lower_prices", "search_seeing_sets"]

FINISHED, PAUSED, FOUND = 0, 1, 2

UNLIKELY = 1e-3
"""Added to the share of a robot that is inside at a form's point."""


class Flows(NamedTuple):
    """What bounds a node: ``share`` (K,) in [0, 1] that open robots pay, ``blinded`` (K,) price of a blinded robot.

    The last is (0, mu), whose minimum cut is a group that costs what it says.
    """

    share: Any
    blinded: Any


class SeeingStack(NamedTuple):
    """Open nodes of the search; ``position`` : the last open node, nodes so far.

    For each open node: ``part`` (N,) what robots are; K flows; ``sums`` (M, T) of the seeing robots; ``worth`` (N,)
    value with one robot more, ``copies`` (N,) level with ``copied`` copies of one; ``room`` more robots that may see;
    ``bound`` (K,) of the flows; ``grown`` whether the last robot decided sees; ``points`` of the forms;
    ``weight``, halved at every decision, of 1 at the root
    """

    position: Any
    part: Any
    into: Any
    out: Any
    along: Any
    sums: Any
    worth: Any
    copies: Any
    copied: Any
    room: Any
    bound: Any
    grown: Any
    points: Any
    weight: Any

    @classmethod
    def of(cls, n_arcs: int, n_bounds: tuple[int, int], prior: Any, n_robots: int) -> SeeingStack:
        """A search that has not begun; ``n_bounds`` : flows, and forms at most."""
        depth, (n_flows, n_forms) = n_robots + 2, n_bounds
        return cls(
            position=np.array([-1, 0], dtype=np.int64),
            part=np.zeros((depth, n_robots), dtype=np.int8),
            into=np.zeros((depth, n_flows, n_robots)),
            out=np.zeros((depth, n_flows, n_robots)),
            along=np.zeros((depth, n_flows, n_arcs)),
            sums=np.zeros((depth, *prior.shape)),
            worth=np.zeros((depth, n_robots)),
            copies=np.zeros((depth, n_robots)),
            copied=np.zeros(depth, dtype=np.int64),
            room=np.zeros(depth, dtype=np.int64),
            bound=np.zeros((depth, n_flows)),
            grown=np.zeros(depth, dtype=np.bool_),
            points=FormPoints.of(depth, n_forms, n_robots),
            weight=np.zeros(depth),
        )


@numba.njit(cache=True)
def _begin(team: Any, links: Any, prices: Any, flows: Any, stack: Any) -> None:
    """The root: every robot open."""
    copy(stack.sums[0], team.prior)
    stack.part[0], stack.room[0], stack.grown[0], stack.copied[0] = OPEN, int(prices.capacity), True, 0
    cost = np.empty(len(prices.robot))
    for kind in range(len(flows.share)):
        for i in range(len(cost)):
            cost[i] = flows.share[kind] * flows.blinded[kind] - prices.robot[i]
        stack.bound[0, kind] = open_flow(links, cost, (stack.into[0, kind], stack.out[0, kind], stack.along[0, kind]))
    stack.weight[0], stack.position[0] = 1.0, 0


@numba.njit(cache=True)
def _pay_in_full(links: Any, flows: Any, stack: Any, node: int, robot: int) -> None:
    """The robot does not see: it is outside, or blinded at its price."""
    for kind in range(len(flows.share)):
        rest = (1.0 - flows.share[kind]) * flows.blinded[kind]
        stack.out[node, kind, robot] += ALWAYS if links.seeing[robot] else rest


@numba.njit(cache=True)
def _fill(team: Any, links: Any, flows: Any, threshold: float, stack: Any, node: int, closed: Any) -> None:  # noqa: PLR0917
    """Close the robots that can no longer see in the flows, too, and bound the room."""
    bound_room(team, links, threshold, stack, node, closed)
    for i in range(len(closed)):
        if closed[i]:
            _pay_in_full(links, flows, stack, node, i)


@numba.njit(cache=True)
def _bounds(links: Any, prices: Any, flows: Any, question: Any, stack: Any, sides: Any, work: Any) -> float:  # noqa: PLR0917
    """Reduced cost that no connected group of the last node falls below; ``sides`` (K, N) inside each minimum cut.

    What hanging together costs is added to the best bound alone, and never to the last flow's, whose cut is a group.
    """
    node, best, chosen, last = stack.position[0], -np.inf, -1, len(flows.share) - 1
    seeing = 0
    for i in range(stack.part.shape[1]):
        seeing += int(stack.part[node, i] == SEEING)
    for kind in range(last + 1):
        flow = (stack.into[node, kind], stack.out[node, kind], stack.along[node, kind])
        paid = _paid(prices, flows, question, stack, node, kind, seeing)
        bound = augment(links, flow, stack.bound[node, kind], question.limit - paid, work[0])
        stack.bound[node, kind] = bound
        if bound + paid > question.limit:
            return float(bound + paid)
        if bound + paid > best and kind < last:
            chosen = kind
        best = max(best, bound + paid)
        for i in range(len(stack.part[node])):
            sides[kind, i] = work[0][0][i] >= 0
    if chosen >= 0:
        flow = (stack.into[node, chosen], stack.out[node, chosen], stack.along[node, chosen])
        paid = _paid(prices, flows, question, stack, node, chosen, seeing)
        limit, bound = question.limit - paid, stack.bound[node, chosen]
        bound = connected_bound(links, stack.part[node], flow, bound, limit, sides[chosen], work)
        stack.bound[node, chosen] = bound
        best = max(best, bound + paid)
    return float(best)


@numba.njit(cache=True)
def _paid(prices: Any, flows: Any, question: Any, stack: Any, node: int, kind: int, seeing: int) -> float:  # noqa: PLR0917
    """What is paid back to a flow (minus that): shares of all who may see, and surcharges of all who may be blinded."""
    paid = -flows.share[kind] * flows.blinded[kind] * (seeing + stack.room[node])
    return float(paid - (flows.blinded[kind] - prices.blinded) * question.budget)


@numba.njit(cache=True)
def _branch(stack: Any, sides: Any, budget: int) -> int:
    """The open robot inside a minimum cut that is worth most, or a robot of a group with too many blinded; else -1."""
    node, last = stack.position[0], len(sides) - 1
    part, worth, chosen = stack.part[node], stack.worth[node], -1
    for kind in range(last + 1):
        for i in range(len(part)):
            if part[i] == OPEN and sides[kind, i] and (chosen < 0 or worth[i] > worth[chosen]):
                chosen = i
        if chosen >= 0:
            return int(chosen)
    blinded = 0
    for i in range(len(part)):
        if sides[last, i] and part[i] != SEEING:
            blinded += 1
            chosen = i if part[i] == ELSE else chosen
    return int(chosen) if blinded > budget else -1


@numba.njit(cache=True)
def _most_inside(stack: Any, form: int) -> int:
    """The open robot that is worth most times its share inside at a form's point; -1 where there is none."""
    node, chosen, most = stack.position[0], -1, 0.0
    for i in range(stack.part.shape[1]):
        score = stack.worth[node, i] * (UNLIKELY + stack.points.at[node, form, i])
        if stack.part[node, i] == OPEN and (chosen < 0 or score > most):
            chosen, most = i, score
    return int(chosen)


@numba.njit(cache=True)
def _copy(stack: Any, node: int, child: int) -> None:
    copy_flows(stack, node, child)
    copy_points(stack.points, node, child)
    copy(stack.sums[child], stack.sums[node])
    copy_row(stack.part[child], stack.part[node])
    copy_row(stack.worth[child], stack.worth[node])
    copy_row(stack.copies[child], stack.copies[node])
    stack.copied[child] = stack.copied[node]
    stack.room[child] = stack.room[node]
    stack.weight[node] *= 0.5
    stack.weight[child] = stack.weight[node]


@numba.njit(cache=True)
def _descend(team: Any, links: Any, flows: Any, stack: Any, robot: int) -> None:
    """Two nodes instead of the last: the robot sees (looked at first), or not; or it is blinded, or outside."""
    node = stack.position[0]
    child = node + 1
    _copy(stack, node, child)
    always(stack.into[child], robot)
    sees = stack.part[node, robot] == OPEN
    stack.grown[child], stack.grown[node] = sees, False
    if sees:
        add(stack.sums[child], stack.sums[child], 1.0, team, robot)
        stack.room[child] -= 1
        stack.copied[child] = 0
        stack.part[child, robot] = SEEING
        stack.points.at[node, :, robot] = 0.0
        close(links, stack.part[node], robot)
        _pay_in_full(links, flows, stack, node, robot)
    else:
        stack.part[child, robot], stack.part[node, robot] = BLINDED, OUTSIDE
        always(stack.out[node], robot)
    stack.position[0] = child


@numba.njit(cache=True)
def lower_prices(stack: Any, robot: Any, lower: Any) -> None:
    """Make the prices ``robot`` (N,) no larger than ``lower`` (N,), in all open nodes: what is closed stays closed."""
    for i in range(len(robot)):
        fall = max(robot[i] - lower[i], 0.0)
        robot[i] -= fall
        for node in range(stack.position[0] + 1):
            for kind in range(stack.out.shape[1]):
                stack.out[node, kind, i] += fall


@numba.njit(cache=True)
def leave_node(stack: Any) -> None:
    """Close the last node, of which a group was found."""
    stack.position[0] -= 1


@numba.njit(cache=True)
def _work(n_robots: int, n_arcs: int) -> Any:
    """Room for :func:`connected_bound`."""
    levels = np.empty(n_robots, np.int64), np.empty(n_robots, np.int64), np.empty(n_robots, np.int64)
    flow = np.empty(n_robots), np.empty(n_robots), np.empty(n_arcs)
    return levels, flow, np.empty(n_robots, np.int64), np.empty(n_robots, np.int64)


@numba.njit(cache=True)
def search_seeing_sets(  # noqa: PLR0917
    team: Any, links: Any, prices: Any, flows: Any, question: Any, stack: Any, nodes: int, found: Any
) -> int:
    """Continue for at most so many nodes: FINISHED, PAUSED, or FOUND at a node that has a group that pays.

    ``prices.capacity`` : the most robots of a set worth less than the threshold; ``question.limit`` < 0, which no group
    at all would cost; ``found`` : robots (N,) and blinded ones (N,) of the group. The node stays open: it is left
    (:func:`leave_node`), or looked at again with lower prices. FINISHED proves that no group pays but in nodes left.
    """
    n_robots, position = len(prices.robot), stack.position
    work = _work(n_robots, len(links.robot))
    sides = np.zeros((len(flows.share), n_robots), dtype=np.bool_)
    closed = np.zeros(n_robots, dtype=np.bool_)
    tangents = (np.zeros(n_robots), np.zeros(n_robots), np.zeros(n_robots), np.arange(n_robots))
    if position[0] < 0 and position[1] == 0:
        _begin(team, links, prices, flows, stack)
    for _ in range(nodes):
        node = position[0]
        if node < 0:
            return FINISHED
        position[1] += 1
        _fill(team, links, flows, question.threshold, stack, node, closed)
        state = node, stack.part[node], stack.room[node], count(stack.part[node], BLINDED)
        form = open_form(prices, question, stack.points, state, tangents)
        done = form == len(prices.forms.constant)
        if done or _bounds(links, prices, flows, question, stack, sides, work) > question.limit:
            position[0] -= 1
            continue
        robot = _branch(stack, sides, question.budget)
        if form >= 0 and robot >= 0 and stack.part[node, robot] == OPEN:
            robot = _most_inside(stack, form)
        if robot >= 0:
            _descend(team, links, flows, stack, robot)
            continue
        blinded = 0
        for i in range(n_robots):
            inside = sides[len(sides) - 1, i]
            found[0][i], found[1][i] = inside, inside and stack.part[node, i] != SEEING
            blinded += int(found[1][i])
        if blinded <= question.budget:
            return FOUND
        position[0] -= 1
    return PAUSED if position[0] >= 0 else FINISHED
