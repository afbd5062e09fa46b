"""Groups that pay the prices least, by annealing one group at a time, in compiled code.

Nothing is proved here: the groups are real (connected or not, worth less than the threshold with the robots blinded
that they say), so they may enter the program of prices, and the enumeration (``columns.py``) starts from prices that
hardly any group pays. Imported only where compiled loops are used.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from ratt_opt.attackers.by_prices.groups.compiled import add, copy, copy_row, value_of
from ratt_opt.attackers.by_prices.groups.flow import ALWAYS
from ratt_opt.running.compiling import numba

__all__ = ["BLINDED", "NOBODY", "SEEING", "cheap_group"]

OUTSIDE, SEEING, BLINDED = 0, 1, 2
"""What a robot is to the group."""

NOBODY = 1e9
"""Cost returned where no group contains the first robot."""

ALONG, SWAP = 0.6, 0.4
"""Chances that a move goes along a link of the group, and that another robot of the group changes with it."""

JOIN_SEEING, TO_BLINDED, TO_SEEING = 0.6, 0.3, 0.4
"""Chances that a robot joins seeing, and that one inside is blinded or sees again instead of leaving."""


@numba.njit(cache=True)
def _change(links: Any, prices: Any, part: Any, robot: int, new: int) -> float:
    """Make a robot something else to the group; returns what the reduced cost rises by."""
    old = part[robot]
    rise = prices[1] * (int(new == BLINDED) - int(old == BLINDED))
    if (new == OUTSIDE) != (old == OUTSIDE):
        joining = -prices[0][robot]
        for a in range(links.start[robot], links.start[robot + 1]):
            cut = ALWAYS if links.fixed[a] else 0.5
            joining += -cut if part[links.robot[a]] != OUTSIDE else cut
        rise += joining if old == OUTSIDE else -joining
    part[robot] = new
    return float(rise)


@numba.njit(cache=True)
def _touches(links: Any, part: Any, robot: int) -> bool:
    touching = 0
    for a in range(links.start[robot], links.start[robot + 1]):
        touching += int(part[links.robot[a]] != OUTSIDE)
    return touching > 0


@numba.njit(cache=True)
def _propose(links: Any, part: Any, first: int, rng: Any) -> Any:
    """A robot and what it becomes, and another of the group (-1: none) and what that becomes; (-1, ...) for no move."""
    n_robots = len(part)
    i = int(rng.random() * n_robots)
    degree = links.start[i + 1] - links.start[i]
    if part[i] != OUTSIDE and degree and rng.random() < ALONG:
        i = links.robot[links.start[i] + int(rng.random() * degree)]
    chance, stays = rng.random(), i == first
    if part[i] == OUTSIDE:
        if not _touches(links, part, i):
            return -1, 0, -1, 0
        new = SEEING if chance < JOIN_SEEING else BLINDED
    elif part[i] == SEEING:
        new = BLINDED if stays or chance < TO_BLINDED else OUTSIDE
    else:
        new = SEEING if stays or chance < TO_SEEING else OUTSIDE
    j, other = int(rng.random() * n_robots), OUTSIDE
    fixed = j == i or part[j] == OUTSIDE
    if fixed or j == first or rng.random() >= SWAP:
        j = -1
    elif rng.random() < 0.5:
        other = BLINDED if part[j] == SEEING else SEEING
    if (new == BLINDED and links.seeing[i]) or (other == BLINDED and links.seeing[j]):
        return -1, 0, -1, 0
    return i, new, j, other


@numba.njit(cache=True)
def _start(team: Any, links: Any, prices: Any, limits: Any, first: int, part: Any, sums: Any) -> float:  # noqa: PLR0917
    """The first robot alone, blinded where it must be."""
    part[:] = OUTSIDE
    copy(sums, team.prior)
    if team.single[first] < limits[0]:
        add(sums, sums, 1.0, team, first)
        return float(_change(links, prices, part, first, SEEING))
    if limits[1] == 0 or links.seeing[first]:
        return NOBODY
    return float(_change(links, prices, part, first, BLINDED))


@numba.njit(cache=True)
def _is_weak(team: Any, limits: Any, sums: Any, trial: Any, moved: Any) -> bool:
    """Whether the group stays below the threshold; its information is brought up to date if so."""
    i, before, after, j, other_before, other_after = moved
    change = int(after == SEEING) - int(before == SEEING)
    other = int(other_after == SEEING) - int(other_before == SEEING) if j >= 0 else 0
    copy(trial, sums)
    if change:
        add(trial, trial, change, team, i)
    if other:
        add(trial, trial, other, team, j)
    if (change > 0 or other > 0) and not value_of(team, trial) < limits[0]:
        return False
    copy(sums, trial)
    return True


@numba.njit(cache=True)
def cheap_group(  # noqa: PLR0917
    team: Any, links: Any, prices: Any, limits: Any, first: int, cooling: Any, rng: Any, best: Any
) -> float:
    """Anneal a group around one robot; returns its reduced cost, ``best`` (N,) what each robot is to it.

    ``prices`` : pi (N,), mu; ``limits`` : threshold, most blinded; ``cooling`` : moves, first and last temperature
    [links]
    """
    part, sums, trial = np.zeros(len(best), dtype=np.int8), np.empty_like(team.prior), np.empty_like(team.prior)
    cost = _start(team, links, prices, limits, first, part, sums)
    least, blinded = cost, int(part[first] == BLINDED)
    copy_row(best, part)
    if cost == NOBODY:
        return NOBODY
    for move in range(cooling[0]):
        temperature = cooling[1] * (cooling[2] / cooling[1]) ** (move / cooling[0])
        i, new, j, other = _propose(links, part, first, rng)
        if i < 0:
            continue
        old, old_other = part[i], part[j] if j >= 0 else 0
        after = blinded + int(new == BLINDED) - int(old == BLINDED)
        if j >= 0:
            after += int(other == BLINDED) - int(old_other == BLINDED)
        if after > limits[1]:
            continue
        rise = _change(links, prices, part, i, new)
        if j >= 0:
            rise += _change(links, prices, part, j, other)
        accepted = rise <= 0 or rng.random() < np.exp(-rise / temperature)
        if accepted and _is_weak(team, limits, sums, trial, (i, old, new, j, old_other, other)):
            cost, blinded = cost + rise, after
            if cost < least - 1e-9:
                least = cost
                copy_row(best, part)
            continue
        part[i] = old
        if j >= 0:
            part[j] = old_other
    return float(least)
