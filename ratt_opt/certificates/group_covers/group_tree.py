"""The groups that may be part of an attack, by a tree over who is inside one, in compiled code.

What closes a case is what the verifier (``verifier/group_covers.py``) follows in integers: that its groups cannot be
part of an attack, or a bound on their reduced cost by a flow, of which the links between a decided robot and an
open one take no part: what these cost is a sum over robots. Flows are found where those of earlier cases do not do.
Imported only where a certificate is written.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from ratt_opt.attackers.by_prices.groups.flow import ALWAYS, augment, open_flow
from ratt_opt.compiling import numba

if TYPE_CHECKING:
    from ratt_opt.attackers.by_prices.team import Links
    from ratt_opt.graph.threat import Threat

__all__ = [
    "COMPLETE",
    "FINISHED",
    "FLOW",
    "FULL",
    "IMPOSSIBLE",
    "PAUSED",
    "Found",
    "Network",
    "Sets",
    "Tariff",
    "grow_tree",
]

FINISHED, PAUSED, FULL = 0, 1, 2

COMPLETE, IMPOSSIBLE, FLOW = -1, -2, -3
"""Leaves: a group of which no further robot can be; no group of an attack; FLOW less the number of a flow and set."""

RECENT = 48
"""Flows that a case tries, the latest, beside the one that closed the last case."""

SHARES = np.array([1.0, 0.75, 0.5, 0.25, 0.0])
"""Of a blinded robot's price that an open robot pays in the flows that a case looks for."""


class Network(NamedTuple):
    """A threat's graph. By robot: masks of the ``near`` ones and of those it cannot be cut from (``tied``), (N,);
    ``links`` : as the attacker has them; ``most`` : blinded robots, links cut; ``seeing`` : mask of protected robots"""

    near: Any
    tied: Any
    links: Any
    most: Any
    seeing: int

    @classmethod
    def of(cls, threat: Threat, links: Links) -> Network:
        """The graph of a threat of at most 60 robots."""
        near, tied = np.zeros((2, threat.graph.n_robots), dtype=np.int64)
        for i, j in threat.graph.links:
            near[i] |= 1 << j
            near[j] |= 1 << i
        for i, j in threat.protected_links:
            tied[i] |= 1 << j
            tied[j] |= 1 << i
        most = np.array([threat.n_blinded, threat.alpha_c], dtype=np.int64)
        return cls(near, tied, links, most, sum(1 << i for i in threat.protected_robots))


class Sets(NamedTuple):
    """Sets of robots (F,) as masks, of whose robots at most ``room`` (F,) see in a group worth less."""

    robots: Any
    room: Any


class Tariff(NamedTuple):
    """Prices of robots (N,) and of a blinded one, half a link, and the reduced cost above which a group is closed."""

    robot: Any
    blinded: int
    half_link: int
    slack: int
    order: Any
    group: int
    triple: Any
    penalty: Any


class Found(NamedTuple):
    """What a search has so far. ``tree`` (T,); complete groups (C,) as masks with their reduced costs (C,); ``flows``
    (K, A) out of each arc's robot; ``count`` : nodes of the tree, groups, flows, cases open, flow used last

    ``stack`` : (depth, 2) masks of who is inside and outside in the open cases
    """

    tree: Any
    group: Any
    cost: Any
    flows: Any
    count: Any
    stack: Any

    @classmethod
    def of(cls, n_robots: int, n_nodes: int, n_groups: int, flows: tuple[int, int]) -> Found:
        """A search that has not begun, with room for so many nodes, groups and flows (K, A)."""
        return cls(
            tree=np.zeros(n_nodes, dtype=np.int64),
            group=np.zeros(n_groups, dtype=np.int64),
            cost=np.zeros(n_groups, dtype=np.int64),
            flows=np.zeros(flows, dtype=np.int64),
            count=np.array([0, 0, 0, 1, 0], dtype=np.int64),
            stack=np.zeros((n_robots + 2, 2), dtype=np.int64),
        )


@numba.njit(cache=True)
def _ones(mask: int) -> int:
    ones = 0
    while mask:
        mask &= mask - 1
        ones += 1
    return ones


@numba.njit(cache=True)
def _reached(network: Any, inside: int, usable: int) -> int:
    """Robots in reach of the lowest one inside, through usable ones."""
    reached, front = inside & -inside, inside & -inside
    while front:
        lowest = front & -front
        front ^= lowest
        new = network.near[_ones(lowest - 1)] & usable & ~reached
        reached |= new
        front |= new
    return reached


@numba.njit(cache=True)
def _lost(network: Any, inside: int, outside: int) -> int:
    """Links between both; more than any budget where one of them is protected."""
    lost = 0
    for i in range(len(network.near)):
        if inside >> i & 1:
            lost += _ones(network.near[i] & outside)
            if network.tied[i] & outside:
                return len(network.links.robot) + 1
    return lost


@numba.njit(cache=True)
def _need(network: Any, sets: Any, inside: int) -> int:
    """Blinded robots that a group with these robots has at least; more than any budget where it cannot be blinded."""
    need = 0
    for k in range(len(sets.room)):
        own = inside & sets.robots[k]
        if _ones(own & network.seeing) > sets.room[k]:
            return len(network.near) + 1
        need = max(need, _ones(own) - sets.room[k])
    return need


@numba.njit(cache=True)
def _penalties(tariff: Any, inside: int, outside: int, extra: Any) -> int:
    """What triples cost: those with two robots inside; ``extra`` (N,) what an open robot beside one inside adds."""
    paid = 0
    extra[:] = 0
    for k in range(len(tariff.triple)):
        triple, penalty = tariff.triple[k], tariff.penalty[k]
        within = _ones(triple & inside)
        if within >= 2:
            paid += penalty
        elif within == 1:
            rest = triple & ~inside & ~outside
            share = penalty if _ones(rest) == 1 else penalty // 2
            while rest:
                lowest = rest & -rest
                extra[_ones(lowest - 1)] += share
                rest ^= lowest
    return int(paid)


@numba.njit(cache=True)
def _open_costs(network: Any, tariff: Any, flow: Any, inside: int, outside: int, cost: Any) -> int:  # noqa: PLR0917
    """Fill ``cost`` (N,) of the open robots; returns what the group costs without them and blinded ones."""
    start, robot = network.links.start, network.links.robot
    paid = _penalties(tariff, inside, outside, cost) - tariff.group
    for i in range(len(cost)):
        if inside >> i & 1:
            paid -= tariff.robot[i]
            paid += tariff.half_link * _ones(network.near[i] & ~inside)
        elif not outside >> i & 1:
            c = cost[i] - tariff.robot[i]
            for a in range(start[i], start[i + 1]):
                if inside >> robot[a] & 1:
                    c -= tariff.half_link
                elif outside >> robot[a] & 1:
                    c += tariff.half_link
                else:
                    c += flow[a]
            cost[i] = c
    return int(paid)


@numba.njit(cache=True)
def _closing_set(network: Any, sets: Any, tariff: Any, flow: Any, case: Any, work: Any) -> int:  # noqa: PLR0917
    """The set whose bound exceeds the slack by this flow; -1 where none does."""
    inside, outside = case
    cost, order = work
    paid = _open_costs(network, tariff, flow, inside, outside, cost)
    n_open = 0
    for i in range(len(cost)):
        if not (inside | outside) >> i & 1 and cost[i] < 0:
            k = n_open
            while k > 0 and cost[order[k - 1]] > cost[i]:
                order[k] = order[k - 1]
                k -= 1
            order[k] = i
            n_open += 1
    for s in range(len(sets.room)):
        room = sets.room[s] - _ones(inside & sets.robots[s])
        blinded = max(-room, 0)
        room, more = max(room, 0), network.most[0] - blinded
        total = paid + tariff.blinded * blinded
        for k in range(n_open):
            i = order[k]
            if not sets.robots[s] >> i & 1:
                total += cost[i]
            elif room > 0:
                total += cost[i]
                room -= 1
            elif more > 0:
                total += min(cost[i] + tariff.blinded, 0)
                more -= 1
        if total > tariff.slack:
            return s
    return -1


@numba.njit(cache=True)
def _known(network: Any, sets: Any, tariff: Any, found: Any, case: Any, work: Any) -> int:  # noqa: PLR0917
    """The leaf of a flow found before that closes the case; 0 without one."""
    count, last = found.count[2], found.count[4]
    for k in range(count, max(count - RECENT, 0) - 1, -1):
        flow = last if k == count else k
        if (k == count and count == 0) or (k < count and flow == last):
            continue
        s = _closing_set(network, sets, tariff, found.flows[flow], case, work)
        if s >= 0:
            found.count[4] = flow
            return int(FLOW - (flow * len(sets.room) + s))
    return 0


@numba.njit(cache=True)
def _found_flow(network: Any, sets: Any, tariff: Any, found: Any, case: Any, work: Any) -> int:  # noqa: PLR0917
    """The leaf of a new flow that closes the case; 0 without one."""
    inside, outside = case
    n_robots, unit = len(tariff.robot), 2.0 * tariff.half_link
    cost = np.empty(n_robots)
    flow = (np.empty(n_robots), np.empty(n_robots), np.empty(len(network.links.robot)))
    room = (np.empty(n_robots, np.int64), np.empty(n_robots, np.int64), np.empty(n_robots, np.int64))
    new, extra = found.count[2], np.zeros(n_robots, np.int64)
    _penalties(tariff, inside, outside, extra)
    for s in range(len(sets.room)):
        for share in SHARES:
            for i in range(n_robots):
                pays = share * tariff.blinded if sets.robots[s] >> i & 1 else 0.0
                cost[i] = (pays - tariff.robot[i] + extra[i]) / unit
            bound = open_flow(network.links, cost, flow)
            for i in range(n_robots):
                flow[0][i] += ALWAYS if inside >> i & 1 else 0.0
                flow[1][i] += ALWAYS if outside >> i & 1 else 0.0
            augment(network.links, flow, bound, np.inf, room)
            for a in range(len(network.links.robot)):
                half = ALWAYS if network.links.fixed[a] else 0.5
                if a < network.links.back[a]:
                    amount = int(np.rint((half - flow[2][a]) * unit))
                    found.flows[new, a] = amount
                    found.flows[new, network.links.back[a]] = -amount
            closing = _closing_set(network, sets, tariff, found.flows[new], case, work)
            if closing >= 0:
                found.count[2] += 1
                found.count[4] = new
                return int(FLOW - (new * len(sets.room) + closing))
    return 0


@numba.njit(cache=True)
def _branch(network: Any, tariff: Any, inside: int, outside: int) -> int:
    """The open robot next to the group with the most links to decided ones; the next in the order without a group."""
    best, most = -1, 0
    for i in tariff.order:
        if (inside | outside) >> i & 1:
            continue
        if not inside:
            return int(i)
        linked = _ones(network.near[i] & inside)
        decided = _ones(network.near[i] & (inside | outside))
        if linked and decided > most:
            best, most = i, decided
    return best


@numba.njit(cache=True)
def _list(network: Any, tariff: Any, found: Any, case: Any, need: int, extra: Any) -> None:  # noqa: PLR0917
    """Add a complete group where its reduced cost is within the slack."""
    inside, outside = case
    cost = tariff.blinded * need + _penalties(tariff, inside, outside, extra) - tariff.group
    for i in range(len(tariff.robot)):
        if inside >> i & 1:
            cost += tariff.half_link * _ones(network.near[i] & outside) - tariff.robot[i]
    if inside and cost <= tariff.slack:
        found.group[found.count[1]], found.cost[found.count[1]] = inside, cost
        found.count[1] += 1


@numba.njit(cache=True)
def grow_tree(network: Any, sets: Any, tariff: Any, found: Any, nodes: int) -> int:
    """Continue for at most so many cases: FINISHED, PAUSED, or FULL where there is no room for more.

    Complete groups of a reduced cost of at most the slack are listed; it may be negative.
    """
    n_robots, count = len(tariff.robot), found.count
    work = (np.zeros(n_robots, np.int64), np.zeros(n_robots, np.int64))
    everyone = (1 << n_robots) - 1
    for _ in range(nodes):
        if count[3] == 0:
            return FINISHED
        if count[0] >= len(found.tree) or count[1] >= len(found.group) or count[2] + 1 >= len(found.flows):
            return FULL
        count[3] -= 1
        inside, outside = found.stack[count[3], 0], found.stack[count[3], 1]
        if inside:
            reached = _reached(network, inside, everyone & ~outside)
            torn = inside & ~reached
            outside = everyone & ~reached
        else:
            torn = 0
        need = _need(network, sets, inside)
        leaf = 0
        if torn or need > network.most[0] or _lost(network, inside, outside) > network.most[1]:
            leaf = IMPOSSIBLE
        elif inside | outside == everyone:
            leaf = COMPLETE
            _list(network, tariff, found, (inside, outside), need, work[0])
        else:
            leaf = _known(network, sets, tariff, found, (inside, outside), work)
            if leaf == 0:
                leaf = _found_flow(network, sets, tariff, found, (inside, outside), work)
        if leaf == 0:
            leaf = _branch(network, tariff, inside, outside)
            found.stack[count[3], 0], found.stack[count[3], 1] = inside, outside | (1 << leaf)
            found.stack[count[3] + 1, 0], found.stack[count[3] + 1, 1] = inside | (1 << leaf), outside
            count[3] += 2
        found.tree[count[0]] = leaf
        count[0] += 1
    return PAUSED if count[3] else FINISHED
