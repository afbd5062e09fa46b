"""A lower bound of what a group costs, by a flow that grows as robots are fixed, in compiled code.

The least of ``sum of cost[i] over the group + half the links it cuts``, over groups that contain and avoid given
robots, is a minimum cut; any flow is a lower bound of it, so rounding and stopping early do no harm. Fixing a robot
only adds capacity: a child's flow starts from its parent's. Imported only where compiled loops are used.

Source: Picard and Ratliff, Minimum cuts and related problems, Networks 5 (1975).
"""

from __future__ import annotations

from typing import Any

from ratt_opt.running.compiling import numba

__all__ = ["ALWAYS", "augment", "open_flow"]

ALWAYS = 1e6
"""Capacity that no cost reaches: a robot fixed, a link that cannot be cut."""

EMPTY = 1e-12


@numba.njit(cache=True)
def open_flow(links: Any, cost: Any, flow: Any) -> float:
    """Start ``flow`` = (into (N,), out (N,), along (A,)) residual capacities; returns the bound before any flow."""
    into, out, along = flow
    bound = 0.0
    for i in range(len(cost)):
        into[i], out[i] = max(-cost[i], 0.0), max(cost[i], 0.0)
        bound += min(cost[i], 0.0)
    for a in range(len(along)):
        along[a] = ALWAYS if links.fixed[a] else 0.5
    return bound


@numba.njit(cache=True)
def _levels(links: Any, flow: Any, level: Any, queue: Any) -> bool:
    """Distance of every robot from the source in residual arcs, -1 out of reach; whether the sink is in reach."""
    into, out, along = flow
    head, tail, reached = 0, 0, False
    for i in range(len(into)):
        level[i] = -1
        if into[i] > EMPTY:
            level[i] = 0
            queue[tail] = i
            tail += 1
    while head < tail:
        i = queue[head]
        head += 1
        reached = reached or out[i] > EMPTY
        for a in range(links.start[i], links.start[i + 1]):
            j = links.robot[a]
            if level[j] < 0 and along[a] > EMPTY:
                level[j] = level[i] + 1
                queue[tail] = j
                tail += 1
    return reached


@numba.njit(cache=True)
def _push(links: Any, flow: Any, source: int, level: Any, arc: Any, path: Any) -> float:  # noqa: PLR0917
    """One path from a source robot to the sink along rising levels; what it carries, 0 where there is none left.

    ``arc`` : (N,) next arc to try from each robot; ``path`` : (N,) arcs of the path
    """
    into, out, along = flow
    i, length = source, 0
    while out[i] <= EMPTY:
        advanced = False
        while arc[i] < links.start[i + 1]:
            a = arc[i]
            if along[a] > EMPTY and level[links.robot[a]] == level[i] + 1:
                path[length] = a
                length += 1
                i = links.robot[a]
                advanced = True
                break
            arc[i] += 1
        if advanced:
            continue
        if length == 0:
            return 0.0
        length -= 1
        i = links.robot[links.back[path[length]]]
        arc[i] += 1
    amount = min(into[source], out[i])
    for k in range(length):
        amount = min(amount, along[path[k]])
    into[source] -= amount
    out[i] -= amount
    for k in range(length):
        along[path[k]] -= amount
        along[links.back[path[k]]] += amount
    return float(amount)


@numba.njit(cache=True)
def augment(links: Any, flow: Any, bound: float, limit: float, work: Any) -> float:
    """Push flow, shortest paths first, until none is left or the bound exceeds ``limit``; returns the bound.

    ``work`` : three (N,) arrays of integers

    Source: Dinic, Soviet Mathematics Doklady 11 (1970).
    """
    level, arc, path = work
    into = flow[0]
    while bound <= limit and _levels(links, flow, level, path):
        for i in range(len(into)):
            arc[i] = links.start[i]
        for source in range(len(into)):
            while into[source] > EMPTY and bound <= limit:
                amount = _push(links, flow, source, level, arc, path)
                if amount == 0.0:
                    break
                bound += amount
    return bound
