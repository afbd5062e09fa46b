"""What the group of an open node needs blinded, kept from below and from above as robots join, in compiled code.

A node is a row of the enumeration's ``Stack`` (``columns.py``). Imported only where compiled loops are used.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from ratt_opt.attackers.by_prices.groups.blinding import UNDECIDED, WEAK, exchange, trade, weak_subset
from ratt_opt.attackers.by_prices.groups.compiled import copy_row, gather_seeing
from ratt_opt.attackers.by_prices.groups.flow import always
from ratt_opt.running.compiling import numba

__all__ = ["admit", "blind_fewer", "inside_of", "knapsack_need", "settle"]

SMALL = 40
"""Robots up to which what a group needs is decided at every node. Measured at 24 robots: with 12 instead, a
refutation of 17,000 nodes takes more than 220,000."""


@numba.njit(cache=True)
def inside_of(stack: Any, node: int) -> Any:
    """(N,) whether each robot is inside at a node."""
    group = np.empty(stack.side.shape[1], dtype=np.bool_)
    for i in range(len(group)):
        group[i] = stack.side[node, i] == 1
    return group


@numba.njit(cache=True)
def settle(team: Any, links: Any, question: Any, stack: Any, node: int, values: int) -> None:  # noqa: PLR0917
    """Close the gap between the least and the found number of blinded robots as far as ``values`` reach."""
    group = inside_of(stack, node)
    found = np.zeros(len(group), dtype=np.bool_)
    while stack.need[node, 0] < stack.need[node, 1]:
        answer = weak_subset(team, links.seeing, group, stack.need[node, 0], question.threshold, values, found)
        if answer == UNDECIDED:
            return
        if answer == WEAK:
            copy_row(stack.blind[node], found)
            stack.need[node, 1] = stack.need[node, 0]
        else:
            stack.need[node, 0] += 1


@numba.njit(cache=True)
def admit(team: Any, links: Any, question: Any, stack: Any, node: int, robot: int, sums: Any) -> bool:  # noqa: PLR0917
    """Put a robot inside and update what the group needs; false where no blinding suffices."""
    stack.side[node, robot] = 1
    always(stack.into[node], robot)
    group, blind = inside_of(stack, node), stack.blind[node]
    if gather_seeing(team, group, blind, sums) < question.threshold:
        return True
    small = group.sum() <= SMALL
    if small and stack.need[node, 1] > 0:
        other = blind.copy()
        if trade(team, links.seeing, group, other, question.threshold, sums):
            copy_row(blind, other)
            return True
    if not _blind_more(team, links, question, stack, node, robot, sums):
        return False
    if small:
        settle(team, links, question, stack, node, question.quick)
    return bool(stack.need[node, 0] <= question.budget)


@numba.njit(cache=True)
def _blind_more(team: Any, links: Any, question: Any, stack: Any, node: int, robot: int, sums: Any) -> bool:  # noqa: PLR0917
    """Blind the new robot, or the strongest ones where it is protected, until the group is below the threshold."""
    group, blind = inside_of(stack, node), stack.blind[node]
    while True:
        chosen = robot if not (blind[robot] or links.seeing[robot]) else -1
        if chosen < 0:
            for i in range(len(group)):
                free = group[i] and not blind[i] and not links.seeing[i]
                if free and (chosen < 0 or team.single[i] > team.single[chosen]):
                    chosen = i
        if chosen < 0:
            return False
        blind[chosen] = True
        stack.need[node, 1] += 1
        if gather_seeing(team, group, blind, sums) < question.threshold:
            return True


@numba.njit(cache=True)
def blind_fewer(team: Any, links: Any, question: Any, stack: Any, node: int, sums: Any) -> None:  # noqa: PLR0917
    """Let blinded robots see again as long as exchanges make up for it."""
    group = inside_of(stack, node)
    while stack.need[node, 1] > stack.need[node, 0]:
        other, weakest = stack.blind[node].copy(), -1
        for i in range(len(group)):
            if other[i] and (weakest < 0 or team.single[i] < team.single[weakest]):
                weakest = i
        other[weakest] = False
        if not exchange(team, links.seeing, group, other, question.threshold, sums):
            return
        copy_row(stack.blind[node], other)
        stack.need[node, 1] -= 1


@numba.njit(cache=True)
def knapsack_need(links: Any, prices: Any, group: Any) -> int:
    """Blinded robots that the knapsack alone asks for."""
    weight, need = prices.weight * group, 0
    total = weight.sum()
    weight[links.seeing] = 0.0
    while total > prices.capacity and need < len(group):
        heaviest = np.argmax(weight)
        total -= weight[heaviest]
        weight[heaviest] = 0.0
        need += 1
    return need
