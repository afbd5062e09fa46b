"""What bounds the cost of the groups of a case, in compiled code.

It is what the verifier (``verifier/lower_end/group_costs.py``) computes in integers.

Imported only where a certificate is written.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from ratt_opt.graph.separable_groups import count_ones
from ratt_opt.running.compiling import numba

if TYPE_CHECKING:
    from ratt_opt.attack.links import Links
    from ratt_opt.graph.threat import Threat

__all__ = ["Network", "Sets", "Tariff", "closing_set", "lost", "need", "penalties", "reached"]


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


@numba.njit(cache=True)
def reached(network: Any, inside: int, usable: int) -> int:
    """Robots in reach of the lowest one inside, through usable ones."""
    found, front = inside & -inside, inside & -inside
    while front:
        lowest = front & -front
        front ^= lowest
        new = network.near[count_ones(lowest - 1)] & usable & ~found
        found |= new
        front |= new
    return found


@numba.njit(cache=True)
def lost(network: Any, inside: int, outside: int) -> int:
    """Links between both; more than any budget where one of them is protected."""
    total = 0
    for i in range(len(network.near)):
        if inside >> i & 1:
            total += count_ones(network.near[i] & outside)
            if network.tied[i] & outside:
                return len(network.links.robot) + 1
    return total


@numba.njit(cache=True)
def need(network: Any, sets: Any, inside: int) -> int:
    """Blinded robots that a group with these robots has at least; more than any budget where it cannot be blinded."""
    blinded = 0
    for k in range(len(sets.room)):
        own = inside & sets.robots[k]
        if count_ones(own & network.seeing) > sets.room[k]:
            return len(network.near) + 1
        blinded = max(blinded, count_ones(own) - sets.room[k])
    return blinded


@numba.njit(cache=True)
def penalties(tariff: Any, inside: int, outside: int, extra: Any) -> int:
    """What triples cost: those with two robots inside; ``extra`` (N,) what an open robot beside one inside adds."""
    paid = 0
    extra[:] = 0
    for k in range(len(tariff.triple)):
        triple, penalty = tariff.triple[k], tariff.penalty[k]
        within = count_ones(triple & inside)
        if within >= 2:
            paid += penalty
        elif within == 1:
            rest = triple & ~inside & ~outside
            share = penalty if count_ones(rest) == 1 else penalty // 2
            while rest:
                lowest = rest & -rest
                extra[count_ones(lowest - 1)] += share
                rest ^= lowest
    return int(paid)


@numba.njit(cache=True)
def _open_costs(network: Any, tariff: Any, flow: Any, inside: int, outside: int, cost: Any) -> int:  # noqa: PLR0917
    """Fill ``cost`` (N,) of the open robots; returns what the group costs without them and blinded ones."""
    start, robot = network.links.start, network.links.robot
    paid = penalties(tariff, inside, outside, cost) - tariff.group
    for i in range(len(cost)):
        if inside >> i & 1:
            paid -= tariff.robot[i]
            paid += tariff.half_link * count_ones(network.near[i] & ~inside)
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
def closing_set(network: Any, sets: Any, tariff: Any, flow: Any, case: Any, work: Any) -> int:  # noqa: PLR0917
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
        room = sets.room[s] - count_ones(inside & sets.robots[s])
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
