"""The groups that may be part of an attack, by a tree over who is inside one, in compiled code.

What closes a case is what the verifier (``verifier/lower_end/group_covers.py``) follows in integers: that its groups
cannot be part of an attack, or a bound on their reduced cost by a flow, of which the links between a decided robot and
an open one take no part: what these cost is a sum over robots. Flows are found where those of earlier cases do not do.
Imported only where a certificate is written.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from ratt_opt.certificates.flow import ALWAYS, augment, open_flow
from ratt_opt.certificates.group_covers.case_bounds import closing_set, lost, need, penalties, reached
from ratt_opt.graph.separable_groups import count_ones
from ratt_opt.running.compiling import numba

__all__ = ["FINISHED", "FLOW", "FULL", "PAUSED", "Found", "grow_tree"]

FINISHED, PAUSED, FULL = 0, 1, 2

COMPLETE, IMPOSSIBLE, FLOW = -1, -2, -3
"""Leaves: a group of which no further robot can be; no group of an attack; FLOW less the number of a flow and set."""

RECENT = 48
"""Flows that a case tries, the latest, beside the one that closed the last case."""

SHARES = np.array([1.0, 0.75, 0.5, 0.25, 0.0])
"""Of a blinded robot's price that an open robot pays in the flows that a case looks for."""


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
def _known(network: Any, sets: Any, tariff: Any, found: Any, case: Any, work: Any) -> int:  # noqa: PLR0917
    """The leaf of a flow found before that closes the case; 0 without one."""
    count, last = found.count[2], found.count[4]
    for k in range(count, max(count - RECENT, 0) - 1, -1):
        flow = last if k == count else k
        if (k == count and count == 0) or (k < count and flow == last):
            continue
        s = closing_set(network, sets, tariff, found.flows[flow], case, work)
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
    penalties(tariff, inside, outside, extra)
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
            closing = closing_set(network, sets, tariff, found.flows[new], case, work)
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
        linked = count_ones(network.near[i] & inside)
        decided = count_ones(network.near[i] & (inside | outside))
        if linked and decided > most:
            best, most = i, decided
    return best


@numba.njit(cache=True)
def _list(network: Any, tariff: Any, found: Any, case: Any, need: int, extra: Any) -> None:  # noqa: PLR0917
    """Add a complete group where its reduced cost is within the slack."""
    inside, outside = case
    cost = tariff.blinded * need + penalties(tariff, inside, outside, extra) - tariff.group
    for i in range(len(tariff.robot)):
        if inside >> i & 1:
            cost += tariff.half_link * count_ones(network.near[i] & outside) - tariff.robot[i]
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
            within = reached(network, inside, everyone & ~outside)
            torn = inside & ~within
            outside = everyone & ~within
        else:
            torn = 0
        needed = need(network, sets, inside)
        leaf = 0
        if torn or needed > network.most[0] or lost(network, inside, outside) > network.most[1]:
            leaf = IMPOSSIBLE
        elif inside | outside == everyone:
            leaf = COMPLETE
            _list(network, tariff, found, (inside, outside), needed, work[0])
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
