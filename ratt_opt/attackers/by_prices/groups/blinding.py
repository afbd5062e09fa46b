"""How many robots of a group must be blinded for it to be worth less than a threshold, in compiled code.

Imported only where compiled loops are used.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from ratt_opt.attackers.by_prices.groups.compiled import add, copy, gather_seeing, value_of
from ratt_opt.running.compiling import numba

if TYPE_CHECKING:
    from collections.abc import Callable

    from ratt_opt._validation import BoolArray
    from ratt_opt.attackers.by_prices.team import PricedTeam

__all__ = ["ABSENT", "UNDECIDED", "WEAK", "exchange", "may_be_weak", "trade", "weak_subset"]

ABSENT, WEAK, UNDECIDED = 0, 1, 2
AT_ONCE = 5_000
"""Values between two looks at the clock: a tenth of a second where targets have four coordinates, max-eigenvalue."""


@numba.njit(cache=True)
def _strongest_first(team: Any, group: Any) -> Any:
    """The robots of ``group`` (N,) by falling individual value."""
    members, size = np.empty(len(group), dtype=np.int64), 0
    for i in range(len(group)):
        if group[i]:
            place = size
            while place > 0 and team.single[members[place - 1]] < team.single[i]:
                members[place] = members[place - 1]
                place -= 1
            members[place] = i
            size += 1
    return members[:size]


@numba.njit(cache=True)
def _can_blind(seeing: Any, members: Any, first: int) -> bool:
    """Whether none of the members from ``first`` on is protected."""
    possible = True
    for k in range(first, len(members)):
        possible = possible and not seeing[members[k]]
    return possible


@numba.njit(cache=True)
def _begun(team: Any, group: Any) -> Any:
    """Where a search for blinded robots of ``group`` (N,) begins; it goes on in place.

    The members, the information of those kept at each depth, what was tried there, and (2,) depth and blinded so far.
    """
    members = _strongest_first(team, group)
    sums = np.empty((len(members) + 1, *team.prior.shape))
    copy(sums[0], team.prior)
    choice = np.zeros(len(members) + 1, dtype=np.int64)  # 0: nothing tried, 1: blinding tried, 2: keeping tried
    return members, sums, choice, np.zeros(2, dtype=np.int64)


@numba.njit(cache=True)
def _go_on(team: Any, seeing: Any, place: Any, blinded: int, threshold: float, limit: int, found: Any) -> int:  # noqa: PLR0917
    """:func:`weak_subset` from where it was: UNDECIDED before the first value beyond the limit, and then to go on."""
    members, sums, choice, at = place
    size, asked = len(members), 0
    depth, used = at[0], at[1]
    while depth >= 0:
        if (depth == size or size - depth <= blinded - used) and _can_blind(seeing, members, depth):
            found[:] = False
            for k in range(size):
                found[members[k]] = k >= depth or choice[k] == 1
            return WEAK
        step = choice[depth] if depth < size else 2
        robot = members[depth] if depth < size else -1
        if step == 0 and used < blinded and not seeing[robot]:
            choice[depth] = 1
            copy(sums[depth + 1], sums[depth])
            used += 1
            depth += 1
            if depth <= size:
                choice[depth] = 0
            continue
        if step < 2 and asked >= limit:
            at[0], at[1] = depth, used
            return UNDECIDED
        if step == 1:
            used -= 1
        if step < 2:
            choice[depth] = 2
            add(sums[depth + 1], sums[depth], 1.0, team, robot)
            asked += 1
            if value_of(team, sums[depth + 1]) < threshold:
                depth += 1
                choice[depth] = 0
                continue
        depth -= 1
    return ABSENT


@numba.njit(cache=True)
def weak_subset(team: Any, seeing: Any, group: Any, blinded: int, threshold: float, limit: int, found: Any) -> int:  # noqa: PLR0917
    """Whether blinding so many robots can leave ``group`` (N,) less than the threshold: ABSENT, WEAK or UNDECIDED.

    ``seeing`` : (N,) robots that cannot be blinded; ``limit`` : values looked at before giving up;
    ``found`` : (N,) becomes the blinded robots. The strongest are decided first, blinded before kept.
    """
    return _go_on(team, seeing, _begun(team, group), blinded, threshold, limit, found)


def may_be_weak(  # noqa: PLR0917
    team: PricedTeam, group: BoolArray, blinded: int, threshold: float, limit: int, check: Callable[[], None]
) -> bool:
    """:func:`weak_subset` of a group any of whose robots can be blinded, in pieces; true also where undecided.

    ``check`` : raises where the time is up
    """
    nobody, found = np.zeros((2, len(group)), dtype=np.bool_)
    place = _begun(team, group)
    for begin in range(0, limit, AT_ONCE):
        check()
        answer = _go_on(team, nobody, place, blinded, threshold, min(AT_ONCE, limit - begin), found)
        if answer != UNDECIDED:
            return bool(answer == WEAK)
    return True


@numba.njit(cache=True)
def exchange(team: Any, seeing: Any, group: Any, blind: Any, threshold: float, sums: Any) -> bool:  # noqa: PLR0917
    """Exchange a blinded robot for a seeing one while that lowers the group's value; whether it falls below.

    ``blind`` (N,) and ``sums`` (M, T), the seeing robots' information, are changed in place.
    """
    value = gather_seeing(team, group, blind, sums)
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
                add(other, sums, 1.0, team, i)
                add(other, other, -1.0, team, j)
                changed = value_of(team, other)
                if changed < best:
                    best, leaves, enters = changed, i, j
        if leaves < 0:
            return False
        blind[leaves], blind[enters] = False, True
        value = gather_seeing(team, group, blind, sums)
    return bool(value < threshold)


@numba.njit(cache=True)
def _least(team: Any, sums: Any, group: Any, blind: Any, seeing: Any, sign: float, other: Any) -> Any:  # noqa: PLR0917
    """Who of the group leaves the least value by seeing again (sign 1) or being blinded (-1): (robot or -1, value)."""
    robot, least = -1, np.inf
    for i in range(len(group)):
        if group[i] and blind[i] == (sign > 0) and not (seeing[i] and sign < 0):
            add(other, sums, sign, team, i)
            value = value_of(team, other)
            if value < least:
                robot, least = i, value
    return robot, least


@numba.njit(cache=True)
def trade(team: Any, seeing: Any, group: Any, blind: Any, threshold: float, sums: Any) -> bool:  # noqa: PLR0917
    """:func:`exchange` by one robot at a time: far fewer values to look at, and seldom worse."""
    value, other = gather_seeing(team, group, blind, sums), np.empty_like(sums)
    for _ in range(len(group)):  # rounding must not make it trade equals for ever
        if value < threshold:
            return True
        leaves, more = _least(team, sums, group, blind, seeing, 1.0, other)
        if leaves < 0 or not more < np.inf:
            return False
        add(sums, sums, 1.0, team, leaves)
        enters, least = _least(team, sums, group, blind, seeing, -1.0, other)
        if enters < 0 or not least < value * (1 - 1e-9):
            return False
        blind[leaves], blind[enters] = False, True
        value = gather_seeing(team, group, blind, sums)
    return bool(value < threshold)
