"""A lower bound of what a group costs, by a flow that grows as robots are fixed, in compiled code.

The least of ``sum of cost[i] over the group + half the links it cuts`` over groups that contain and avoid given robots is a
minimum cut; any flow is a lower bound of it, so rounding and stopping early do no harm. Fixing a robot only adds
capacity: a child's flow starts from its parent's. Imported only where compiled loops are used.

Source: Picard and Ratliff, Minimum cuts and related problems, Networks 5 (1975).
"""

from __future__ import annotations

from typing import Any

import numba

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
def augment(links: Any, flow: Any, bound: float, limit: float, work: Any) -> float:
    """Push flow along shortest paths until none is left or the bound exceeds ``limit``; returns the bound.

    ``work`` : (queue (N,), arc that reached a robot (N,))
    """
    into, out, along = flow
    queue, reached = work
    n_robots = len(into)
    while bound <= limit:
        head, tail, end = 0, 0, -1
        for i in range(n_robots):
            reached[i] = -2
            if into[i] > EMPTY:
                reached[i] = -1
                queue[tail] = i
                tail += 1
        while head < tail and end < 0:
            i = queue[head]
            head += 1
            if out[i] > EMPTY:
                end = i
                break
            for a in range(links.start[i], links.start[i + 1]):
                j = links.robot[a]
                if reached[j] == -2 and along[a] > EMPTY:
                    reached[j] = a
                    queue[tail] = j
                    tail += 1
        if end < 0:
            return bound
        amount, i = out[end], end
        while reached[i] >= 0:
            amount = min(amount, along[reached[i]])
            i = links.robot[links.back[reached[i]]]
        amount = min(amount, into[i])
        out[end] -= amount
        into[i] -= amount
        i = end
        while reached[i] >= 0:
            a = reached[i]
            along[a] -= amount
            along[links.back[a]] += amount
            i = links.robot[links.back[a]]
        bound += amount
    return bound
