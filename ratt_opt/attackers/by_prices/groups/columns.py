"""Every group that may be part of an attack at given prices, by depth-first search in compiled code.

For a threshold, a group ``g`` of the attacker's partition cuts ``cut(g) / 2`` links (each is shared with another
group) and needs ``need(g)`` blinded robots to be worth less. At prices ``pi`` of robots and ``mu`` of a blinded robot
its reduced cost is ``cut(g) / 2 + mu need(g) - pi(g)``. The search lists the connected groups whose reduced cost is
at most a limit. Two bounds prune it, both by flows (``flow.py``):

- robots worth less than the threshold keep a knapsack, ``weight(seeing) <= capacity``, such as a largest size; with
  a multiplier ``mu need(g)`` is at least ``sum of min(mu, multiplier weight) - multiplier capacity``;
- ``need`` does not fall when robots join, so what the robots already inside need is paid.

The first is strong for large groups and the second for small ones. Any mixture of them is a bound too, and one in
the middle is better than both while the size of the group is open: a flow for each of a few ``shares``. Convex forms
bound groups of a few sizes each (``size_forms.py``).

Imported only where compiled loops are used.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from ratt_opt.attackers.by_prices.groups.compiled import copy_row
from ratt_opt.attackers.by_prices.groups.flow import always, augment, copy_flows, open_flow
from ratt_opt.attackers.by_prices.groups.needs import admit, blind_fewer, inside_of, knapsack_need, settle
from ratt_opt.attackers.by_prices.groups.size_forms import OPEN, OUTSIDE, SEEING, FormPoints, copy_points, open_form
from ratt_opt.running.compiling import numba

__all__ = ["FINISHED", "FULL", "PAUSED", "Prices", "Question", "Stack", "enumerate_groups"]

FINISHED, PAUSED, FULL = 0, 1, 2


class Prices(NamedTuple):
    """Prices, and the knapsack that bounds what a group needs.

    ``robot`` : (N,) pi; ``blinded`` : mu; ``weight`` : (N,), ``capacity``, ``multiplier`` : of the knapsack;
    ``shares`` : (K,) of the knapsack's bound in each flow's, in [0, 1]; ``forms`` : of sizes, or of none
    """

    robot: Any
    blinded: float
    weight: Any
    capacity: float
    multiplier: float
    shares: Any
    forms: Any


class Question(NamedTuple):
    """Groups worth less than ``threshold`` with at most ``budget`` blinded, of reduced cost at most ``limit``.

    ``order`` : (N,) robots in the order in which groups are listed by their first; ``quick``, ``thorough`` : values
    looked at to decide what a group needs, at every node and before it is listed
    """

    threshold: float
    budget: int
    limit: float
    order: Any
    quick: int
    thorough: int


class Stack(NamedTuple):
    """Open nodes of the search; ``position`` : first robot, open nodes, nodes so far, groups listed.

    For each open node: ``side`` (N,) OPEN, SEEING (inside, whether it sees or not) or OUTSIDE; K flows; ``blind`` (N,)
    blinded robots that leave what is inside below the threshold; ``need`` least and found numbers of them; ``bound`` of
    the flows; ``points`` of the forms.
    """

    position: Any
    side: Any
    into: Any
    out: Any
    along: Any
    blind: Any
    need: Any
    bound: Any
    points: Any

    @classmethod
    def of(cls, n_robots: int, n_arcs: int, n_bounds: tuple[int, int]) -> Stack:
        """A search that has not begun; ``n_bounds`` : flows, and forms."""
        depth, (n_flows, n_forms) = n_robots + 2, n_bounds
        return cls(
            position=np.zeros(4, dtype=np.int64),
            side=np.zeros((depth, n_robots), dtype=np.int8),
            into=np.zeros((depth, n_flows, n_robots)),
            out=np.zeros((depth, n_flows, n_robots)),
            along=np.zeros((depth, n_flows, n_arcs)),
            blind=np.zeros((depth, n_robots), dtype=np.bool_),
            need=np.zeros((depth, 2), dtype=np.int64),
            bound=np.zeros((depth, n_flows)),
            points=FormPoints.of(depth, n_forms, n_robots),
        )


@numba.njit(cache=True)
def _copy(stack: Any, source: int, target: int) -> None:
    copy_flows(stack, source, target)
    copy_row(stack.side[target], stack.side[source])
    copy_row(stack.blind[target], stack.blind[source])
    copy_row(stack.need[target], stack.need[source])
    copy_points(stack.points, source, target)


@numba.njit(cache=True)
def _least(links: Any, prices: Any, question: Any, stack: Any, node: int, work: Any) -> float:  # noqa: PLR0917
    """Reduced cost that no group of the node falls below: the better of both flows."""
    best = -np.inf
    for kind, share in enumerate(prices.shares):
        flow = (stack.into[node, kind], stack.out[node, kind], stack.along[node, kind])
        paid = (1 - share) * prices.blinded * stack.need[node, 0] - share * prices.multiplier * prices.capacity
        bound = augment(links, flow, stack.bound[node, kind], question.limit - paid, work)
        stack.bound[node, kind] = bound
        best = max(best, bound + paid)
        if best > question.limit:
            break
    return best


@numba.njit(cache=True)
def _may_cost(prices: Any, question: Any, stack: Any, node: int, tangents: Any) -> bool:
    """Whether the forms leave a group of a node within the limit, seeing robots being as many as the knapsack holds."""
    n_robots = len(question.order)
    inside, most = 0, n_robots
    for i in range(n_robots):
        inside += int(stack.side[node, i] == SEEING)
    least = prices.weight.min()
    if least > 0.0:
        most = int(min(prices.capacity / least, most))
    need = max(stack.need[node, 0], inside - most)
    if need > question.budget:
        return False
    state = node, stack.side[node], most + need - inside, need
    return bool(open_form(prices, question, stack.points, state, tangents) != len(prices.forms.constant))


@numba.njit(cache=True)
def _first(team: Any, links: Any, prices: Any, question: Any, stack: Any, work: Any, sums: Any) -> bool:  # noqa: PLR0917
    """The node of all groups whose first robot in the order is the next one; false where it is pruned."""
    place, node = stack.position[0], stack.position[1]
    n_robots = len(question.order)
    stack.side[node], stack.blind[node], stack.need[node] = OPEN, False, 0
    stack.points.at[node], stack.points.paid[node], stack.points.done[node] = 0.0, 0.0, False
    cost = np.empty(n_robots)
    for kind, share in enumerate(prices.shares):
        for i in range(n_robots):
            held = prices.multiplier * prices.weight[i]
            held = held if links.seeing[i] else min(held, prices.blinded)
            cost[i] = share * held - prices.robot[i]
        flow = (stack.into[node, kind], stack.out[node, kind], stack.along[node, kind])
        stack.bound[node, kind] = open_flow(links, cost, flow)
    for k in range(place):
        stack.side[node, question.order[k]] = OUTSIDE
        always(stack.out[node], question.order[k])
    if not admit(team, links, question, stack, node, question.order[place], sums):
        return False
    return bool(_least(links, prices, question, stack, node, work) <= question.limit)


@numba.njit(cache=True)
def _next_robot(links: Any, side: Any) -> int:
    """The open robot next to the group with the most links to decided ones; -1 where there is none."""
    best, most = -1, 0
    for i in range(len(side)):
        if side[i] != OPEN:
            continue
        decided, inside = 0, False
        for a in range(links.start[i], links.start[i + 1]):
            other = side[links.robot[a]]
            decided += other != OPEN
            inside = inside or other == SEEING
        if inside and decided > most:
            best, most = i, decided
    return best


@numba.njit(cache=True)
def _cost(links: Any, prices: Any, side: Any, need: int) -> float:
    total = prices.blinded * need
    for i in range(len(side)):
        if side[i] == SEEING:
            total -= prices.robot[i]
            for a in range(links.start[i], links.start[i + 1]):
                total += 0.5 if side[links.robot[a]] != SEEING else 0.0
    return float(total)


@numba.njit(cache=True)
def _list(team: Any, links: Any, prices: Any, question: Any, stack: Any, listed: Any, sums: Any) -> None:  # noqa: PLR0917
    """Add the finished group of the node just closed where its reduced cost is within the limit."""
    node = stack.position[1]
    groups, blinds, needs, costs = listed
    group = inside_of(stack, node)
    asked = knapsack_need(links, prices, group)
    stack.need[node, 0] = max(stack.need[node, 0], min(asked, stack.need[node, 1]))
    if _cost(links, prices, stack.side[node], stack.need[node, 0]) > question.limit:
        return
    blind_fewer(team, links, question, stack, node, sums)
    settle(team, links, question, stack, node, question.thorough)
    cost = _cost(links, prices, stack.side[node], stack.need[node, 0])
    if cost <= question.limit and stack.need[node, 0] <= question.budget:
        row = stack.position[3]
        copy_row(groups[row], group)
        copy_row(blinds[row], stack.blind[node])
        copy_row(needs[row], stack.need[node])
        costs[row] = cost
        stack.position[3] += 1


@numba.njit(cache=True)
def enumerate_groups(team: Any, links: Any, prices: Any, question: Any, stack: Any, nodes: int, listed: Any) -> int:  # noqa: PLR0917
    """Continue for at most so many nodes: FINISHED, PAUSED, or FULL when ``listed`` has no room left.

    ``listed`` : groups (C, N), blinded robots (C, N), least and found needs (C, 2), reduced costs (C,)
    """
    n_robots, position = len(question.order), stack.position
    work = (np.empty(n_robots, dtype=np.int64), np.empty(n_robots, dtype=np.int64), np.empty(n_robots, dtype=np.int64))
    sums = np.empty_like(team.prior)
    tangents = (np.zeros(n_robots), np.zeros(n_robots), np.zeros(n_robots), np.arange(n_robots))
    stop = position[2] + nodes
    while True:
        if position[3] >= len(listed[3]):
            return FULL
        if position[2] >= stop:
            return PAUSED
        if position[1] == 0:
            if position[0] == n_robots:
                return FINISHED
            position[2] += 1
            position[1] = 1 if _first(team, links, prices, question, stack, work, sums) else 0
            position[0] += 1
            continue
        node = position[1] - 1
        robot = _next_robot(links, stack.side[node])
        if robot < 0:
            position[1] -= 1
            _list(team, links, prices, question, stack, listed, sums)
            continue
        position[2] += 2
        _copy(stack, node, node + 1)
        stack.side[node + 1, robot], stack.side[node, robot] = SEEING, OUTSIDE
        joins = _may_cost(prices, question, stack, node + 1, tangents)
        joins = joins and admit(team, links, question, stack, node + 1, robot, sums)
        joins = joins and _may_cost(prices, question, stack, node + 1, tangents)
        joins = joins and _least(links, prices, question, stack, node + 1, work) <= question.limit
        always(stack.out[node], robot)
        stays = _may_cost(prices, question, stack, node, tangents)
        stays = stays and _least(links, prices, question, stack, node, work) <= question.limit
        if joins and not stays:
            _copy(stack, node + 1, node)
        position[1] += int(joins) + int(stays) - 1
