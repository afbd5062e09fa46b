"""Groups hang together: what a minimum cut in several pieces costs more, as a flow, in compiled code.

Costs add up over the pieces of a group, so if any group pays the prices, a connected one does. Where a minimum cut's
piece has some of the robots that are inside for sure and another piece others, a connected group has one of the robots
``W`` next to the piece. With a multiplier ``t`` its cost is at least ``cost + t (1 - robots of W inside)``, and
``t (1 - ...) = sum over W of t (robot outside) - t (|W| - 1)`` only adds capacity to the flow.

Imported only where compiled loops are used.
"""

from __future__ import annotations

from typing import Any

from ratt_opt.attackers.by_prices.groups.compiled import copy_row
from ratt_opt.attackers.by_prices.groups.flow import augment
from ratt_opt.attackers.by_prices.groups.size_forms import BLINDED, OUTSIDE, SEEING
from ratt_opt.running.compiling import numba

__all__ = ["connected_bound"]

ROUNDS, STEP = 8, 1.0
"""Multipliers tried at a node for each flow, and the largest [links]."""

GAIN = 1e-3
"""Links that a multiplier must raise the bound by."""


@numba.njit(cache=True)
def _piece(links: Any, part: Any, side: Any, first: int, piece: Any, queue: Any) -> int:  # noqa: PLR0917
    """The piece of ``side`` around a robot (1) and the robots next to it (2) in ``piece`` (N,); how many these are."""
    piece[:] = 0
    piece[first], queue[0] = 1, first
    head, tail, border = 0, 1, 0
    while head < tail:
        i = queue[head]
        head += 1
        for a in range(links.start[i], links.start[i + 1]):
            j = links.robot[a]
            if piece[j] == 0 and side[j]:
                piece[j], queue[tail] = 1, j
                tail += 1
            elif piece[j] == 0 and part[j] != OUTSIDE:
                piece[j] = 2
                border += 1
    return border


@numba.njit(cache=True)
def _is_inside(part: Any, robot: int) -> bool:
    return bool(part[robot] == SEEING or part[robot] == BLINDED)


@numba.njit(cache=True)
def _next_piece(links: Any, part: Any, side: Any, after: int, piece: Any, queue: Any) -> Any:  # noqa: PLR0917
    """The piece of the next robot inside for sure that misses another one: (robot or -1, robots next to it)."""
    first = after
    while first < len(part) and not _is_inside(part, first):
        first += 1
    if first == len(part):
        return -1, 0
    border = _piece(links, part, side, first, piece, queue)
    for i in range(len(part)):
        if piece[i] != 1 and _is_inside(part, i):
            return first, border
    return -1, 0


@numba.njit(cache=True)
def _keep(flow: Any, kept: Any) -> None:
    for k in range(3):
        copy_row(kept[k], flow[k])


@numba.njit(cache=True)
def connected_bound(  # noqa: PLR0917
    links: Any, part: Any, flow: Any, bound: float, limit: float, side: Any, work: Any
) -> float:
    """Raise a node's ``bound`` towards ``limit``; ``side`` (N,) is the minimum cut's, before and after.

    ``work`` : of :func:`augment`, another flow, and two (N,) of integers. Infinite where no group is connected.
    """
    levels, kept, piece, queue = work
    first = 0
    for _ in range(ROUNDS):
        first, border = _next_piece(links, part, side, first, piece, queue)
        if first < 0:
            break
        if border == 0:
            return 1e9
        _keep(flow, kept)
        step = min(STEP, limit - bound + GAIN)
        for i in range(len(part)):
            if piece[i] == 2:
                flow[0][i] += step
        raised = augment(links, flow, bound - step * (border - 1), limit, levels)
        if raised > limit:
            return raised
        if raised < bound + GAIN:
            _keep(kept, flow)
            first += 1
            continue
        bound = raised
        for i in range(len(part)):
            side[i] = levels[0][i] >= 0
    return bound
