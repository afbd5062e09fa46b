"""Whether any group pays the prices, by depth-first search over the robots left seeing in it, in compiled code.

A group ``g`` whose seeing robots are ``S`` costs ``cut(g) / 2 + mu |g - S| - pi(g)``. Of a node some robots see, some
do not (they are blinded or outside, as a minimum cut finds best), and some are open. At most ``room`` open robots can
still see, or the group would be worth the threshold, and at most ``budget`` are blinded. A flow bounds all groups of
the node: a blinded robot pays ``mu`` and a surcharge, which is paid back ``budget`` times; an open robot pays a share
of both, which is paid back ``room`` times. Seeing robots are few where values saturate early, while groups may be
large: ``columns.py`` decides who is inside instead.

Imported only where compiled loops are used.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from ratt_opt.attackers.by_prices.groups.compiled import value_of
from ratt_opt.attackers.by_prices.groups.flow import ALWAYS, augment, open_flow
from ratt_opt.compiling import numba

__all__ = ["Flows", "SeeingStack", "search_seeing_sets"]

FINISHED, PAUSED, FULL = 0, 1, 2

OPEN, SEEING, ELSE, BLINDED, OUTSIDE = 0, 1, 2, 3, 4
"""What a robot of a node is: ELSE is blinded or outside the group."""

SURE = 1e-9
"""Relative: averages must exceed the threshold by so much to prove that no more robots fit; above their rounding."""


class Flows(NamedTuple):
    """What bounds a node: ``share`` (K,) in [0, 1] that open robots pay, ``blinded`` (K,) price of a blinded robot.

    The last is (0, mu), whose minimum cut is a group that costs what it says.
    """

    share: Any
    blinded: Any


class SeeingStack(NamedTuple):
    """Open nodes of the search; ``position`` : open nodes, nodes so far, groups found.

    For each open node: ``part`` (N,) what robots are; K flows; ``sums`` (M, T) of the seeing robots; ``worth`` (N,)
    value with one robot more; ``room`` further robots that may see; ``bound`` (K,) of the flows; ``grown`` whether the
    last robot decided sees
    """

    position: Any
    part: Any
    into: Any
    out: Any
    along: Any
    sums: Any
    worth: Any
    room: Any
    bound: Any
    grown: Any

    @classmethod
    def of(cls, n_arcs: int, n_flows: int, prior: Any, n_robots: int) -> SeeingStack:
        """A search that has not begun."""
        depth = n_robots + 2
        return cls(
            position=np.array([-1, 0, 0], dtype=np.int64),
            part=np.zeros((depth, n_robots), dtype=np.int8),
            into=np.zeros((depth, n_flows, n_robots)),
            out=np.zeros((depth, n_flows, n_robots)),
            along=np.zeros((depth, n_flows, n_arcs)),
            sums=np.zeros((depth, *prior.shape)),
            worth=np.zeros((depth, n_robots)),
            room=np.zeros(depth, dtype=np.int64),
            bound=np.zeros((depth, n_flows)),
            grown=np.zeros(depth, dtype=np.bool_),
        )


@numba.njit(cache=True)
def _begin(team: Any, links: Any, prices: Any, flows: Any, stack: Any) -> None:
    """The root: every robot open."""
    stack.part[0], stack.sums[0], stack.room[0], stack.grown[0] = OPEN, team.prior, int(prices.capacity), True
    cost = np.empty(len(prices.robot))
    for kind in range(len(flows.share)):
        cost[:] = flows.share[kind] * flows.blinded[kind] - prices.robot
        stack.bound[0, kind] = open_flow(links, cost, (stack.into[0, kind], stack.out[0, kind], stack.along[0, kind]))
    stack.position[0] = 0


@numba.njit(cache=True)
def _close(links: Any, flows: Any, stack: Any, node: int, robot: int) -> None:
    """The robot does not see: it is outside, or blinded at its price."""
    stack.part[node, robot] = OUTSIDE if links.seeing[robot] else ELSE
    for kind in range(len(flows.share)):
        rest = (1.0 - flows.share[kind]) * flows.blinded[kind]
        stack.out[node, kind, robot] += ALWAYS if links.seeing[robot] else rest


@numba.njit(cache=True)
def _fill(team: Any, links: Any, flows: Any, threshold: float, stack: Any, node: int) -> int:  # noqa: PLR0917
    """Close the robots that can no longer see, and bound the room; returns how many are open."""
    part, sums, trial = stack.part[node], stack.sums[node], np.empty_like(team.prior)
    n_open = 0
    for i in range(len(part)):
        if part[i] != OPEN:
            continue
        if stack.grown[node]:
            trial[:] = sums + team.information[i]
            stack.worth[node, i] = value_of(team, trial)
        if stack.worth[node, i] < threshold and stack.room[node] > 0:
            n_open += 1
        else:
            _close(links, flows, stack, node, i)
    stack.room[node] = min(stack.room[node], n_open)
    worths, k = np.empty(n_open), 0
    while stack.room[node] > 1:
        # Criteria are concave: k robots are worth at least the mean of k copies of each.
        k = 0
        for i in range(len(part)):
            if part[i] == OPEN:
                trial[:] = sums + stack.room[node] * team.information[i]
                worths[k] = value_of(team, trial)
                k += 1
        worths.sort()
        if worths[: stack.room[node]].mean() < threshold * (1 + SURE):
            break
        stack.room[node] -= 1
    return n_open


@numba.njit(cache=True)
def _bounds(links: Any, prices: Any, flows: Any, question: Any, stack: Any, sides: Any, work: Any) -> float:  # noqa: PLR0917
    """Reduced cost that no group of the last node falls below; ``sides`` (K, N) the robots inside each minimum cut."""
    node, best = stack.position[0], -np.inf
    seeing = int((stack.part[node] == SEEING).sum())
    for kind in range(len(flows.share)):
        flow = (stack.into[node, kind], stack.out[node, kind], stack.along[node, kind])
        paid = -flows.share[kind] * flows.blinded[kind] * (seeing + stack.room[node])
        paid -= (flows.blinded[kind] - prices.blinded) * question.budget
        bound = augment(links, flow, stack.bound[node, kind], question.limit - paid, work)
        stack.bound[node, kind] = bound
        best = max(best, bound + paid)
        if best > question.limit:
            break
        sides[kind] = work[0] >= 0
    return best


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
def _descend(team: Any, links: Any, flows: Any, stack: Any, robot: int) -> None:
    """Two nodes instead of the last: the robot sees (looked at first), or not; or it is blinded, or outside."""
    node = stack.position[0]
    child = node + 1
    stack.part[child], stack.into[child], stack.out[child] = stack.part[node], stack.into[node], stack.out[node]
    stack.along[child], stack.bound[child], stack.worth[child] = stack.along[node], stack.bound[node], stack.worth[node]
    stack.sums[child], stack.room[child] = stack.sums[node], stack.room[node]
    stack.into[child, :, robot] = ALWAYS
    sees = stack.part[node, robot] == OPEN
    stack.grown[child], stack.grown[node] = sees, False
    if sees:
        stack.sums[child] += team.information[robot]
        stack.room[child] -= 1
        stack.part[child, robot] = SEEING
        _close(links, flows, stack, node, robot)
    else:
        stack.part[child, robot], stack.part[node, robot] = BLINDED, OUTSIDE
        stack.out[node, :, robot] = ALWAYS
    stack.position[0] = child


@numba.njit(cache=True)
def search_seeing_sets(  # noqa: PLR0917
    team: Any, links: Any, prices: Any, flows: Any, question: Any, stack: Any, nodes: int, found: Any
) -> int:
    """Continue for at most so many nodes: FINISHED, PAUSED, or FULL when ``found`` has no room left.

    ``prices.capacity`` : the most robots of a set worth less than the threshold; ``question.limit`` < 0, which no group
    at all would cost; ``found`` : robots (C, N) and blinded ones (C, N) of groups that pay. FINISHED without any proves
    that none does.
    """
    n_robots, position = len(prices.robot), stack.position
    work = (np.empty(n_robots, dtype=np.int64), np.empty(n_robots, dtype=np.int64), np.empty(n_robots, dtype=np.int64))
    sides = np.zeros((len(flows.share), n_robots), dtype=np.bool_)
    if position[0] < 0 and position[1] == 0:
        _begin(team, links, prices, flows, stack)
    for _ in range(nodes):
        node = position[0]
        if node < 0:
            return FINISHED
        if position[2] >= len(found[0]):
            return FULL
        position[1] += 1
        _fill(team, links, flows, question.threshold, stack, node)
        if _bounds(links, prices, flows, question, stack, sides, work) > question.limit:
            position[0] -= 1
            continue
        robot = _branch(stack, sides, question.budget)
        if robot >= 0:
            _descend(team, links, flows, stack, robot)
            continue
        inside = sides[len(sides) - 1]
        blinded = inside & (stack.part[node] != SEEING)
        if blinded.sum() <= question.budget:
            found[0][position[2]], found[1][position[2]] = inside, blinded
            position[2] += 1
        position[0] -= 1
    return PAUSED if position[0] >= 0 else FINISHED
