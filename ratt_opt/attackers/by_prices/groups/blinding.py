"""How many robots of a group must be blinded for it to be worth less than a threshold, in compiled code.

Imported only where compiled loops are used.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from ratt_opt.attackers.by_prices.groups.compiled import gather, value_of
from ratt_opt.compiling import numba

__all__ = ["ABSENT", "UNDECIDED", "WEAK", "exchange", "trade", "weak_subset"]

ABSENT, WEAK, UNDECIDED = 0, 1, 2


@numba.njit(cache=True)
def weak_subset(team: Any, seeing: Any, group: Any, blinded: int, threshold: float, limit: int, found: Any) -> int:  # noqa: PLR0917
    """Whether blinding so many robots can leave ``group`` (N,) less than the threshold: ABSENT, WEAK or UNDECIDED.

    ``seeing`` : (N,) robots that cannot be blinded; ``limit`` : values looked at before giving up;
    ``found`` : (N,) becomes the blinded robots. The strongest are decided first, blinded before kept.
    """
    members = np.flatnonzero(group)
    members = members[np.argsort(-team.single[members])]
    size, asked = len(members), 0
    sums = np.empty((size + 1, *team.prior.shape))
    sums[0] = team.prior
    choice = np.zeros(size + 1, dtype=np.int64)  # 0: nothing tried, 1: blinding tried, 2: keeping tried
    depth, used = 0, 0
    while depth >= 0:
        if (depth == size or size - depth <= blinded - used) and not seeing[members[depth:]].any():
            found[:] = False
            found[members[:depth]] = choice[:depth] == 1
            found[members[depth:]] = True
            return WEAK
        step = choice[depth] if depth < size else 2
        robot = members[depth] if depth < size else -1
        if step == 0 and used < blinded and not seeing[robot]:
            choice[depth] = 1
            sums[depth + 1] = sums[depth]
            used += 1
            depth += 1
            if depth <= size:
                choice[depth] = 0
            continue
        if step == 1:
            used -= 1
        if step < 2:
            choice[depth] = 2
            sums[depth + 1] = sums[depth] + team.information[robot]
            asked += 1
            if asked > limit:
                return UNDECIDED
            if value_of(team, sums[depth + 1]) < threshold:
                depth += 1
                choice[depth] = 0
                continue
        depth -= 1
    return ABSENT


@numba.njit(cache=True)
def exchange(team: Any, seeing: Any, group: Any, blind: Any, threshold: float, sums: Any) -> bool:  # noqa: PLR0917
    """Exchange a blinded robot for a seeing one while that lowers the group's value; whether it falls below.

    ``blind`` (N,) and ``sums`` (M, T), the seeing robots' information, are changed in place.
    """
    value = gather(team, group & ~blind, sums)
    other = np.empty_like(sums)
    for _ in range(len(group)):  # rounding must not make it exchange equals for ever
        if value < threshold:
            return True
        best, leaves, enters = value * (1 - 1e-9), -1, -1
        for i in range(len(group)):
            if not (group[i] and blind[i]):
                continue
            for j in range(len(group)):
                if not group[j] or blind[j] or seeing[j]:
                    continue
                other[:] = sums + team.information[i] - team.information[j]
                changed = value_of(team, other)
                if changed < best:
                    best, leaves, enters = changed, i, j
        if leaves < 0:
            return False
        blind[leaves], blind[enters] = False, True
        value = gather(team, group & ~blind, sums)
    return bool(value < threshold)


@numba.njit(cache=True)
def _least(team: Any, sums: Any, allowed: Any, sign: float, other: Any) -> Any:
    """The allowed robot whose information, added or taken away, leaves the least value: (robot or -1, value)."""
    robot, least = -1, np.inf
    for i in range(len(allowed)):
        if allowed[i]:
            other[:] = sums + sign * team.information[i]
            value = value_of(team, other)
            if value < least:
                robot, least = i, value
    return robot, least


@numba.njit(cache=True)
def trade(team: Any, seeing: Any, group: Any, blind: Any, threshold: float, sums: Any) -> bool:  # noqa: PLR0917
    """:func:`exchange` by one robot at a time: far fewer values to look at, and seldom worse."""
    value, other = gather(team, group & ~blind, sums), np.empty_like(sums)
    for _ in range(len(group)):  # rounding must not make it trade equals for ever
        if value < threshold:
            return True
        leaves, more = _least(team, sums, group & blind, 1.0, other)
        if leaves < 0 or not more < np.inf:
            return False
        sums += team.information[leaves]
        enters, least = _least(team, sums, group & ~blind & ~seeing, -1.0, other)
        if enters < 0 or not least < value * (1 - 1e-9):
            return False
        blind[leaves], blind[enters] = False, True
        value = gather(team, group & ~blind, sums)
    return bool(value < threshold)
