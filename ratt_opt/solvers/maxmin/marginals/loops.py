"""The loop of a search in depth over all plans, compiled: a node is a dead end if one attack leaves too little.

In the order of a path the first robots have chosen an element each. What the others can add to these is at most the
sum, over robots, of an element's largest gain: log-determinants are submodular (Nemhauser, Wolsey and Fisher 1978).
"""

from __future__ import annotations

from typing import Any

import numpy as np

from ratt_opt.running.compiling import numba
from ratt_opt.solvers.maxmin.covers.loops.team import log_determinant
from ratt_opt.solvers.maxmin.levels.level_search import Outcome
from ratt_opt.solvers.maxmin.marginals.tables import BRANCHED

__all__ = ["dive"]

PROVED, SPENT, PLAN = int(Outcome.PROVED), int(Outcome.SPENT), int(Outcome.PLAN)
ONE, SPREAD = np.uint64(1), np.uint64(0x9E3779B97F4A7C15)


@numba.njit(cache=True)
def dive(team: Any, attacks: Any, gains: Any, path: Any, limits: Any) -> int:
    """Search on for that many nodes, for which the record has room; return the outcome.

    ``limits`` : level, what a plan may be worth more than it without its being found, nodes, attacks tried at a node
    """
    level, slack, nodes, most = limits
    n, slots = len(path.chosen), np.empty(len(team.prior), dtype=np.int64)
    for _ in range(nodes):
        depth = path.depth[0]
        ended = BRANCHED
        for place in range(len(attacks.order) if depth == n else min(most, len(attacks.order))):
            a = attacks.order[place]
            if _is_weak(team, attacks, gains, path, (a, level + slack if depth == n else level), slots):
                for k in range(place, 0, -1):
                    attacks.order[k] = attacks.order[k - 1]
                attacks.order[0] = ended = a
                break
        if ended == BRANCHED and depth == n:
            return PLAN
        path.record[path.size[0]] = ended
        path.size[0] += 1
        if ended == BRANCHED:
            _choose(team, path, depth, team.first[depth])
            continue
        while depth > 0 and path.chosen[depth - 1] + 1 == team.first[depth]:
            depth -= 1
            _take_back(team, path, depth)
        if depth == 0:
            return PROVED
        _take_back(team, path, depth - 1)
        _choose(team, path, depth - 1, path.chosen[depth - 1] + 1)
    return SPENT


@numba.njit(cache=True)
def _choose(team: Any, path: Any, robot: int, element: int) -> None:
    path.chosen[robot] = element
    path.depth[0] = robot + 1
    for j in range(len(path.seers)):
        if team.sees[element, j]:
            path.seers[j] |= ONE << np.uint64(robot)
            path.version[j] += 1


@numba.njit(cache=True)
def _take_back(team: Any, path: Any, robot: int) -> None:
    path.depth[0] = robot
    for j in range(len(path.seers)):
        if team.sees[path.chosen[robot], j]:
            path.seers[j] &= ~(ONE << np.uint64(robot))
            path.version[j] += 1


@numba.njit(cache=True)
def _is_weak(team: Any, attacks: Any, gains: Any, path: Any, asked: Any, slots: Any) -> bool:  # noqa: PLR0917
    """Whether no group that an attack leaves is worth more than a level; ``asked`` : both."""
    attack, level = asked
    for place in range(attacks.of.shape[1]):
        g = attacks.of[attack, place]
        if g >= 0 and _is_worth_more(team, attacks.members[g], gains, path, level, slots):
            return False
    return True


@numba.njit(cache=True)
def _is_worth_more(team: Any, members: Any, gains: Any, path: Any, level: float, slots: Any) -> bool:  # noqa: PLR0917
    """Whether what is chosen in a group, and what is gained at most, exceeds the level.

    The work is done on arrays of its own: a call that takes them along costs more than what most calls would do.
    """
    depth, total, sets = path.depth[0], 0.0, gains.value.shape[1]
    first, sees, gain_of, value = team.first, team.sees, gains.gain, gains.value
    version, chosen_by, since, kept, kept_by = path.version, path.seers, gains.since, gains.version, gains.seers
    for j in range(len(slots)):
        seers = chosen_by[j] & members
        k = np.int64((seers * SPREAD) >> np.uint64(40)) % sets
        if kept[j, k] != version[j] or kept_by[j, k] != seers or since[j, k] > depth:
            _work_out(team, gains, path, j, seers, k)
        slots[j] = k
        total += value[j, k]
    for i in range(depth, len(first) - 1):
        if total > level:
            return True
        if (members >> np.uint64(i)) & ONE:
            most = 0.0
            for e in range(first[i], first[i + 1]):
                gain = 0.0
                for j in range(len(slots)):
                    if sees[e, j]:
                        gain += gain_of[j, slots[j], e]
                most = max(most, gain)
            total += most
    return bool(total > level)


@numba.njit(cache=True)
def _work_out(team: Any, gains: Any, path: Any, j: int, seers: Any, k: int) -> None:  # noqa: PLR0917
    """Keep the gains beside a set of seers of a target at ``k``."""
    depth = path.depth[0]
    gains.version[j, k], gains.seers[j, k], gains.since[j, k] = path.version[j], seers, depth
    known, matrix = gains.matrices
    for t in range(len(known)):
        known[t] = team.prior[j, t]
        for i in range(depth):
            if (seers >> np.uint64(i)) & ONE:
                known[t] += team.information[path.chosen[i], j, t]
    weight, before = team.weights[j], log_determinant(known)
    gains.value[j, k] = team.baseline[j] + weight * before
    for place in range(team.seeing.shape[1]):
        e = team.seeing[j, place]
        if e < team.first[depth]:
            break
        for t in range(len(known)):
            matrix[t] = known[t] + team.information[e, j, t]
        gains.gain[j, k, e] = weight * (log_determinant(matrix) - before)
