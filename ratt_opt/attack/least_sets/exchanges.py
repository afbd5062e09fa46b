"""Sets of robots of low value, by exchanging one robot inside for one outside: no claim.

The value of a set has many local minima under single exchanges: from the individually weakest robots alone, attacks on
teams of thirty were found up to 0.25 % too weak; from a few dozen starts, hardly ever, in less time than one start
takes in plain NumPy.
"""

from __future__ import annotations

from ctypes import byref, c_double
from enum import IntEnum
from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.budget import Budget
from ratt_opt.native.library import address, checked
from ratt_opt.native.loops import ScanRecord, loops
from ratt_opt.setfunctions.information import from_triangles, triangles

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

    from ratt_opt._validation import BoolArray, FloatArray, IntArray
    from ratt_opt.attack.team import Team

__all__ = ["descended", "exchange_groups", "exchanged", "weak_sets_of_size"]


class Home(IntEnum):
    """Group of a robot beside one set; a barred one enters no group."""

    BARRED = -1
    OUTSIDE = 0
    INSIDE = 1


def exchange_groups(  # noqa: PLR0917
    team: Team, count: int, home: IntArray, must: BoolArray, budget: Budget, share: float = 0.0
) -> float:
    """Exchange robots of the best group for others as long as that weakens it, or time is left; its value.

    ``home`` : (N,) group of each robot, 1 to ``count``, or none; changed in place
    ``must`` : (N,) robots that stay in some group
    ``share`` : weight of the sum of two groups' values beside the largest value
    """
    home = checked("home", home, np.int64, (team.robots,))
    held = address(checked("must", must, np.bool_, (team.robots,)))
    scan, value, finished = ScanRecord(next=0, leaves=-1, enters=-1, lowest=np.inf), c_double(np.inf), 0
    while not finished:
        with team.pace.timed(pairs := team.pace.units):
            finished = loops.exchange_groups(team.record, count, address(home), held, share, pairs, scan, byref(value))
        if finished < 0:
            raise MemoryError
        finished = finished or budget.is_over
    return value.value


def exchanged(
    team: Team,
    start: Iterable[int],
    *,
    among: Iterable[int] | None = None,
    fixed: Iterable[int] = (),
    budget: Budget | None = None,
) -> frozenset[int]:
    """Make the best exchange again and again while that lowers the value; ties to the lowest robots.

    ``among`` : robots that may be in the set (all by default); ``fixed`` : robots that stay in it
    ``budget`` : once it is spent the set is left as it is
    """
    start, fixed = frozenset(start), frozenset(fixed)
    where = np.full(team.robots, Home.OUTSIDE if among is None else Home.BARRED, dtype=np.int64)
    where[list(among or ())] = Home.OUTSIDE
    where[list(fixed)] = Home.BARRED
    where[list(start)] = Home.INSIDE
    exchange_groups(team, 1, where, np.isin(np.arange(team.robots), list(fixed)), budget or Budget())
    return frozenset(np.flatnonzero(where == Home.INSIDE).tolist())


def weak_sets_of_size(team: Team, size: int, budget: Budget | None = None) -> list[frozenset[int]]:
    """Sets of ``size`` robots that no exchange lowers, lowest value first; fewer, and rougher, once time is up.

    Deterministic. Starts: the robots of least individual value, those of least information about each target, and
    seeded random ones.
    """
    n_robots, n_targets = team.information.shape[:2]
    step = max(size * (n_robots - size) * n_targets, 1)
    found: dict[frozenset[int], float] = {}
    own = budget or Budget()
    for _, start in zip(
        range(max(team.params.set_exchanges.work // step, team.params.set_exchanges.fewest_starts)),
        _starts(team, size),
        strict=False,
    ):
        robots = exchanged(team, start.tolist(), budget=own)
        if robots not in found:
            found[robots] = team.value(robots)
        if own.is_over:
            break
    return sorted(found, key=found.__getitem__)


def _starts(team: Team, size: int) -> Iterator[IntArray]:
    yield np.argsort(team.single, kind="stable")[:size]
    traces = team.traces
    rng = np.random.default_rng(team.params.set_exchanges.seed)
    targets = rng.permutation(traces.shape[1])
    for j in targets:
        yield np.argsort(traces[:, j], kind="stable")[:size]
    for _ in range(team.params.set_exchanges.random_starts):
        yield rng.permutation(len(traces))[:size]


def descended(team: Team, start: IntArray) -> IntArray:
    """Robots, as many as in ``start`` (K,) and worth no more; from the end of their descent."""
    chosen, value = start, team.value(start)
    while True:
        scores = np.einsum("nmt,mt->n", team.information, _slopes(team, team.sums(chosen)))
        others = np.argsort(scores, kind="stable")[: len(start)]
        if (lower := team.value(others)) >= value - team.objective.least_improvement(value):
            return chosen
        chosen, value = others, lower


def _slopes(team: Team, sums: FloatArray) -> FloatArray:
    """(M, T) supergradient of the value in the entries of packed matrices, at posterior information (M, T)."""
    gradient = team.objective.gradient(from_triangles(sums))
    off_diagonal_twice = triangles(2 - np.eye(gradient.shape[-1]))
    return off_diagonal_twice * triangles(gradient)
