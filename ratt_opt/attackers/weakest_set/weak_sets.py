"""Sets of robots of low value, by exchanges from many starts.

The value of a set has many local minima under single exchanges: from the individually weakest robots alone, attacks on
teams of thirty were found up to 0.25 % too weak; from a few dozen starts, hardly ever, in less time than one start
takes in plain NumPy.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numba
import numpy as np

from ratt_opt.attackers.weakest_set.compiled import criterion

if TYPE_CHECKING:
    from collections.abc import Iterator

    from ratt_opt._validation import IntArray
    from ratt_opt.attackers.weakest_set.compact import CompactTeam

__all__ = ["weak_sets"]

RANDOM_STARTS = 40
WORK = 3_000_000
"""Exchanges times targets in one step of all starts together; large teams afford fewer starts."""
FEWEST_STARTS = 4
SEED = 0


def weak_sets(team: CompactTeam, size: int) -> list[frozenset[int]]:
    """Sets of ``size`` robots that no exchange of two robots lowers, lowest value first.

    Deterministic. Starts: the robots of least individual value, those of least information about each target, and
    seeded random ones.
    """
    n_robots, n_targets = team.information.shape[:2]
    step = max(size * (n_robots - size) * n_targets, 1)
    found: dict[frozenset[int], float] = {}
    for _, start in zip(range(max(WORK // step, FEWEST_STARTS)), _starts(team, size), strict=False):
        inside = np.zeros(n_robots, dtype=np.bool_)
        inside[start] = True
        _exchange(team.kind, team.weights, team.prior, team.information, inside)
        robots = frozenset(np.flatnonzero(inside).tolist())
        if robots not in found:
            found[robots] = team.value(robots)
    return sorted(found, key=found.__getitem__)


def _starts(team: CompactTeam, size: int) -> Iterator[IntArray]:
    yield np.argsort(team.single, kind="stable")[:size]
    traces = team.information[:, :, 0] + team.information[:, :, 2]
    rng = np.random.default_rng(SEED)
    targets = rng.permutation(traces.shape[1])
    for j in targets:
        yield np.argsort(traces[:, j], kind="stable")[:size]
    for _ in range(RANDOM_STARTS):
        yield rng.permutation(len(traces))[:size]


@numba.njit(cache=True)
def _exchange(kind: int, weights: Any, prior: Any, information: Any, inside: Any) -> None:
    """Exchange one robot inside (N,) for one outside, the best pair each time, while that lowers the value."""
    n_robots = len(inside)
    sums = prior.copy()
    for member in np.flatnonzero(inside):
        sums += information[member]
    value = criterion(kind, weights, sums)  # of what is left to the team: the attacker wants it large
    changed = np.empty_like(sums)
    while True:
        best, leaves, enters = value + 1e-12 * abs(value), -1, -1
        for i in range(n_robots):
            for e in range(n_robots):
                if not inside[i] or inside[e]:
                    continue
                _replace(sums, information[i], information[e], changed)
                other = criterion(kind, weights, changed)
                if other > best:
                    best, leaves, enters = other, i, e
        if leaves < 0:
            return
        inside[leaves], inside[enters] = False, True
        _replace(sums, information[leaves], information[enters], changed)
        sums[:] = changed
        value = best


@numba.njit(cache=True)
def _replace(sums: Any, leaves: Any, enters: Any, changed: Any) -> None:
    """``changed = sums - leaves + enters``, all (M, 3)."""
    for j in range(sums.shape[0]):
        for t in range(3):
            changed[j, t] = sums[j, t] - leaves[j, t] + enters[j, t]
