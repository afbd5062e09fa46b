"""Attacks by annealing partitions and blinded robots together, in compiled code.

A state gives every robot a group and blinds a fixed number of robots. Moves take a robot to a neighbour's group or to a
group of its own, exchange two robots of different groups, or exchange a blinded robot for a seeing one. The
links between groups may exceed the budget at a price. Groups of nearly the largest value count too (a norm
instead of the maximum), or most moves would change nothing. Imported only where compiled loops are used.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from ratt_opt.attackers.by_prices.groups.compiled import add, copy, copy_row, value_of
from ratt_opt.compiling import numba

__all__ = ["POWERS", "Cooling", "State", "anneal"]

POWERS = 30.0, 100.0
"""Of the norm of the groups' values, four starts each in turn. Measured on ten attacks on teams of 24 robots: 30 finds
the best known in 9 of them, 12 in 5, the plain maximum in 8; on hubs of 30, (5, 30), 30 misses it by 0.5 %."""

UNCUTTABLE = 1_000_000
"""Links that a protected link counts for."""

OWN_GROUP, TRANSFER, BLINDING = 0.08, 0.5, 0.8
"""Chance that a transfer opens a new group; bounds between the chances of a transfer, another blinded robot, a swap."""


class Cooling(NamedTuple):
    """``steps`` moves from temperature ``hot`` to ``cold`` [unit of the value]; ``price`` of a link over ``budget``.

    ``first``, ``last`` : the part of them to make; ``power`` : of the norm of the groups' values
    """

    steps: int
    hot: float
    cold: float
    price: float
    budget: int
    first: int
    last: int
    power: float


class State(NamedTuple):
    """``group``, ``blind`` (N,); by group ``sums`` (N, M, T), ``value``, ``size`` (N,); ``cut`` (1,) links."""

    group: Any
    blind: Any
    sums: Any
    value: Any
    size: Any
    cut: Any

    @classmethod
    def of(cls, team: Any, group: Any, blind: Any) -> State:
        """A state still to be filled."""
        n_robots = len(group)
        sums = np.empty((n_robots, *team.prior.shape))
        return cls(group, blind, sums, np.zeros(n_robots), np.zeros(n_robots, np.int64), np.zeros(1, np.int64))


@numba.njit(cache=True)
def _fill(team: Any, links: Any, state: Any) -> None:
    for g in range(len(state.group)):
        copy(state.sums[g], team.prior)
        state.size[g] = 0
    state.cut[0] = 0
    for i in range(len(state.group)):
        state.size[state.group[i]] += 1
        if not state.blind[i]:
            add(state.sums[state.group[i]], state.sums[state.group[i]], 1.0, team, i)
        for a in range(links.start[i], links.start[i + 1]):
            if links.robot[a] > i and state.group[links.robot[a]] != state.group[i]:
                state.cut[0] += UNCUTTABLE if links.fixed[a] else 1
    for g in range(len(state.group)):
        state.value[g] = value_of(team, state.sums[g]) if state.size[g] else 0.0


@numba.njit(cache=True)
def _transfer(team: Any, links: Any, state: Any, robot: int, target: int) -> None:
    home = state.group[robot]
    for a in range(links.start[robot], links.start[robot + 1]):
        weight, other = UNCUTTABLE if links.fixed[a] else 1, state.group[links.robot[a]]
        if other == home:
            state.cut[0] += weight
        elif other == target:
            state.cut[0] -= weight
    if not state.blind[robot]:
        add(state.sums[home], state.sums[home], -1.0, team, robot)
        add(state.sums[target], state.sums[target], 1.0, team, robot)
    state.group[robot] = target
    state.size[home] -= 1
    state.size[target] += 1


@numba.njit(cache=True)
def _flip(team: Any, state: Any, robot: int) -> None:
    sums = state.sums[state.group[robot]]
    add(sums, sums, 1.0 if state.blind[robot] else -1.0, team, robot)
    state.blind[robot] = not state.blind[robot]


@numba.njit(cache=True)
def _apply(team: Any, links: Any, state: Any, move: Any) -> None:
    """A move or its inverse: (kind, robot, other robot, group of the first, group of the second)."""
    kind, i, j, _, target = move
    if kind == 0:
        _transfer(team, links, state, i, target)
    elif kind == 1:
        _flip(team, state, i)
        _flip(team, state, j)
    else:
        home = state.group[i]
        _transfer(team, links, state, i, state.group[j])
        _transfer(team, links, state, j, home)


@numba.njit(cache=True)
def _propose(links: Any, state: Any, n_blinded: int, rng: Any) -> Any:
    """A random move; kind -1 where there is none."""
    n_robots, chance = len(state.group), rng.random()
    i, j = int(rng.random() * n_robots), int(rng.random() * n_robots)
    home, kind, target = state.group[i], -1, state.group[j]
    if chance < TRANSFER or n_blinded == 0:
        degree = links.start[i + 1] - links.start[i]
        if degree == 0 or rng.random() < OWN_GROUP:
            if state.size[home] > 1:
                kind, target = 0, np.argmin(state.size)
        else:
            target = state.group[links.robot[links.start[i] + int(rng.random() * degree)]]
            kind = 0 if target != home else -1
    elif chance < BLINDING:
        while not state.blind[i]:
            i = int(rng.random() * n_robots)
        home = state.group[i]
        kind = 1 if not (state.blind[j] or links.seeing[j]) else -1
    elif home != target:
        kind = 2
    return kind, i, j, home, target


@numba.njit(cache=True)
def _energy(state: Any, cooling: Any) -> float:
    largest = state.value.max()
    total = 0.0
    for g in range(len(state.value)):
        if state.value[g] > 0.7 * largest:  # below that the power is less than 1e-4
            total += (state.value[g] / largest) ** cooling.power
    over = cooling.price * max(0, state.cut[0] - cooling.budget)
    return float(over if largest <= 0.0 else largest * total ** (1.0 / cooling.power) + over)


@numba.njit(cache=True)
def anneal(team: Any, links: Any, state: Any, cooling: Any, best: Any, least: float, rng: Any) -> float:  # noqa: PLR0917
    """Anneal ``state`` in place; ``best`` = (group (N,), blind (N,)) becomes the best state within the link budget.

    Returns the value of the best state's largest group (groups may be disconnected: the attack is worth no more);
    ``least`` where no state within the budget was better.
    """
    _fill(team, links, state)
    n_blinded = state.blind.sum()
    energy = _energy(state, cooling)
    saved, worth = np.empty((2, *team.prior.shape)), np.empty(2)
    for step in range(cooling.first, cooling.last):
        if state.cut[0] <= cooling.budget and state.value.max() < least:
            least = state.value.max()
            copy_row(best[0], state.group)
            copy_row(best[1], state.blind)
        move = _propose(links, state, n_blinded, rng)
        if move[0] < 0:
            continue
        home, target = move[3], move[4]
        copy(saved[0], state.sums[home])
        copy(saved[1], state.sums[target])
        worth[0], worth[1] = state.value[home], state.value[target]
        _apply(team, links, state, move)
        state.value[home] = value_of(team, state.sums[home]) if state.size[home] else 0.0
        state.value[target] = value_of(team, state.sums[target])
        after = _energy(state, cooling)
        temperature = cooling.hot * (cooling.cold / cooling.hot) ** (step / cooling.steps)
        if after <= energy or rng.random() < np.exp((energy - after) / temperature):
            energy = after
            continue
        _apply(team, links, state, (move[0], move[1], move[2], target, home))
        copy(state.sums[home], saved[0])
        copy(state.sums[target], saved[1])
        state.value[home], state.value[target] = worth[0], worth[1]
    return float(least)
