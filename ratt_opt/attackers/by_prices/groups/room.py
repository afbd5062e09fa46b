"""How many more robots may see at a node of a search for groups that pay, in compiled code.

Levels are concave (``compiled.py``): that of ``k`` robots more is at least the mean of those of ``k`` copies of each.
Imported only where compiled loops are used.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from ratt_opt.attackers.by_prices.groups.compiled import add, least_level, level_of, value_of
from ratt_opt.attackers.by_prices.groups.size_forms import BLINDED, ELSE, INSIDE, OPEN, OUTSIDE
from ratt_opt.running.compiling import numba

__all__ = ["SURE", "bound_room", "close", "count", "may_see"]

SURE = 1e-9
"""Relative: means must exceed what is enough by so much to prove that no more robots fit; above their rounding."""


@numba.njit(cache=True)
def count(part: Any, what: int) -> int:
    """How many robots are that."""
    total = 0
    for i in range(len(part)):
        total += int(part[i] == what)
    return total


@numba.njit(cache=True)
def may_see(part: int) -> bool:
    """Whether it is not known yet if the robot sees."""
    return bool(part in (OPEN, INSIDE))


@numba.njit(cache=True)
def close(links: Any, part: Any, robot: int) -> None:
    """The robot does not see: it is blinded, or outside unless it is inside for sure."""
    if part[robot] == INSIDE:
        part[robot] = BLINDED
    else:
        part[robot] = OUTSIDE if links.seeing[robot] else ELSE


@numba.njit(cache=True)
def _mean_of_least(values: Any, size: int) -> float:
    """Mean of the ``size`` least; the values are sorted in place."""
    total = 0.0
    for k in range(1, len(values)):
        value, place = values[k], k
        while place > 0 and values[place - 1] > value:
            values[place] = values[place - 1]
            place -= 1
        values[place] = value
    for k in range(size):
        total += values[k]
    return total / size


@numba.njit(cache=True)
def bound_room(team: Any, links: Any, threshold: float, stack: Any, node: int, closed: Any) -> None:  # noqa: PLR0917
    """Close the robots of a node that can no longer see, and bound its room; ``closed`` (N,) says which these were.

    ``stack`` : for each node ``part``, ``sums``, ``worth``, ``copies``, ``copied``, ``room``, ``grown``
    """
    part, sums, trial = stack.part[node], stack.sums[node], np.empty_like(team.prior)
    n_open = 0
    for i in range(len(part)):
        closed[i] = False
        if not may_see(part[i]):
            continue
        if stack.grown[node]:
            add(trial, sums, 1.0, team, i)
            stack.worth[node, i] = value_of(team, trial)
        if stack.worth[node, i] < threshold and stack.room[node] > 0:
            n_open += 1
        else:
            close(links, part, i)
            closed[i] = True
    stack.room[node] = min(stack.room[node], n_open)
    levels, enough, k = np.empty(n_open), least_level(team, threshold) * (1 + SURE), 0
    while stack.room[node] > 1:
        k, is_new = 0, stack.copied[node] != stack.room[node]
        stack.copied[node] = stack.room[node]
        for i in range(len(part)):
            if may_see(part[i]):
                if is_new:
                    add(trial, sums, stack.room[node], team, i)
                    stack.copies[node, i] = level_of(team, trial)
                levels[k] = stack.copies[node, i]
                k += 1
        if _mean_of_least(levels, stack.room[node]) < enough:
            break
        stack.room[node] -= 1
