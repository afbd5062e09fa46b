"""Attacks by annealing partitions and blinded robots together, in compiled code.

A state gives every robot a group and blinds a fixed number of robots; links between groups never exceed the budget.
Moves take a robot to a neighbour's group or to a group of its own, exchange a blinded robot for a seeing one, or
exchange two robots of different groups. What a move may cost is drawn before it is valued, so that links, then the
group that gains, rule out most of them. Imported only where compiled loops are used.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from ratt_opt.attackers.by_prices.groups.compiled import add, copy, copy_row, value_of
from ratt_opt.running.compiling import numba

__all__ = ["Cooling", "State", "anneal"]

UNCUTTABLE = 1_000_000
"""Links that a protected link counts for."""

TRANSFER, BLINDING, OWN_GROUP = 0.6, 0.96, 0.05
"""Bounds between the chances of a transfer, another blinded robot and two robots exchanged; and the chance that a
transfer opens a new group. Flat: a tenth more or less of each was not measured to matter."""

MOVED, BLINDED, EXCHANGED = 0, 1, 2


class Cooling(NamedTuple):
    """``steps`` moves from temperature ``hot`` to ``cold`` [unit of the value]; ``budget`` : links that may be cut.

    ``first``, ``last`` : the part of them to make
    """

    steps: int
    hot: float
    cold: float
    budget: int
    first: int
    last: int


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
def _propose(links: Any, state: Any, n_blinded: int, rng: Any) -> Any:
    """A random move (kind, robot, other robot, group that loses, group that gains); kind -1 where there is none.

    The first robot is the one whose view is gained: moved to the gaining group, or blinded there until now.
    """
    n_robots, chance = len(state.group), rng.random()
    i, j = int(rng.random() * n_robots), int(rng.random() * n_robots)
    home, gaining, kind = state.group[i], state.group[j], -1
    if chance < TRANSFER or n_blinded == 0:
        degree = links.start[i + 1] - links.start[i]
        if degree == 0 or rng.random() < OWN_GROUP:
            gaining = np.argmin(state.size) if state.size[home] > 1 else home
        else:
            gaining = state.group[links.robot[links.start[i] + int(rng.random() * degree)]]
        kind = MOVED if gaining != home else -1
    elif chance < BLINDING:
        while not state.blind[i]:
            i = int(rng.random() * n_robots)
        home, gaining = state.group[j], state.group[i]
        kind = BLINDED if not (state.blind[j] or links.seeing[j]) else -1
    elif home != gaining:
        kind = EXCHANGED
    return kind, i, j, home, gaining


@numba.njit(cache=True)
def _more_links(links: Any, state: Any, robot: int, home: int, gaining: int) -> int:
    """Links cut when a robot changes groups, less those that then are not."""
    more = 0
    for a in range(links.start[robot], links.start[robot + 1]):
        weight, other = UNCUTTABLE if links.fixed[a] else 1, state.group[links.robot[a]]
        if other == home:
            more += weight
        elif other == gaining:
            more -= weight
    return more


@numba.njit(cache=True)
def _links_after(links: Any, state: Any, move: Any) -> int:
    kind, i, j, home, gaining = move
    after = state.cut[0]
    if kind != BLINDED:
        after += _more_links(links, state, i, home, gaining)
    if kind == EXCHANGED:
        after += _more_links(links, state, j, gaining, home)
        for a in range(links.start[i], links.start[i + 1]):
            if links.robot[a] == j:  # stays cut, and was counted as joined from both ends
                after += 2 * (UNCUTTABLE if links.fixed[a] else 1)
    return int(after)


@numba.njit(cache=True)
def _value_after(team: Any, state: Any, move: Any, gains: bool, sums: Any) -> float:
    """Value of the group that gains or loses by a move, and its ``sums`` (M, T); of both where they are one."""
    kind, i, j, home, gaining = move
    copy(sums, state.sums[gaining if gains else home])
    sign = 1.0 if gains else -1.0
    if (kind == BLINDED and gains) or (kind != BLINDED and not state.blind[i]):
        add(sums, sums, sign, team, i)
    if kind == BLINDED and (home == gaining or not gains):
        add(sums, sums, -1.0, team, j)
    if kind == EXCHANGED and not state.blind[j]:
        add(sums, sums, -sign, team, j)
    empties = kind == MOVED and not gains and state.size[home] == 1
    return 0.0 if empties else float(value_of(team, sums))


@numba.njit(cache=True)
def _sees_alike(state: Any, move: Any) -> bool:
    """Whether no robot that sees is concerned."""
    kind, i, j = move[0], move[1], move[2]
    return bool(kind != BLINDED and state.blind[i] and (kind == MOVED or state.blind[j]))


@numba.njit(cache=True)
def _apply(state: Any, move: Any, after: int) -> None:
    """Groups, blinded robots and ``after`` links cut; not the sums."""
    kind, i, j, home, gaining = move
    state.cut[0] = after
    if kind == BLINDED:
        state.blind[i], state.blind[j] = False, True
        return
    state.group[i] = gaining
    if kind == EXCHANGED:
        state.group[j] = home
    else:
        state.size[home] -= 1
        state.size[gaining] += 1


@numba.njit(cache=True)
def _keep_better(state: Any, best: Any, least: float) -> float:
    largest = state.value.max()
    if largest >= least:
        return least
    copy_row(best[0], state.group)
    copy_row(best[1], state.blind)
    return float(largest)


@numba.njit(cache=True)
def anneal(team: Any, links: Any, state: Any, cooling: Any, best: Any, least: float, rng: Any) -> float:  # noqa: PLR0917
    """Anneal ``state``, which is within the budget, in place; ``best`` = (group (N,), blind (N,)) becomes the best one.

    Returns the value of the best state's largest group (groups may be disconnected: the attack is worth no more);
    ``least`` where no state was better, and then ``best`` stays.
    """
    _fill(team, links, state)
    n_blinded, energy = state.blind.sum(), state.value.max()
    gained, lost = np.empty((2, *team.prior.shape))
    least = _keep_better(state, best, least)
    for step in range(cooling.first, cooling.last):
        move = _propose(links, state, n_blinded, rng)
        kind, _, _, home, gaining = move
        cut = _links_after(links, state, move) if kind >= 0 else 0
        if kind < 0 or cut > cooling.budget:
            continue
        if _sees_alike(state, move):
            _apply(state, move, cut)
            continue
        temperature = cooling.hot * (cooling.cold / cooling.hot) ** (step / cooling.steps)
        bound = energy - temperature * np.log(1.0 - rng.random())
        more = _value_after(team, state, move, True, gained)
        if more > bound:
            continue
        less = _value_after(team, state, move, False, lost) if home != gaining else more
        if less > bound:
            continue
        before = state.value[home], state.value[gaining]
        state.value[home], state.value[gaining] = less, more
        after = state.value.max()
        if after > bound:
            state.value[home], state.value[gaining] = before
            continue
        energy = after
        _apply(state, move, cut)
        copy(state.sums[gaining], gained)
        if home != gaining:
            copy(state.sums[home], lost)
        least = _keep_better(state, best, least)
    return least
