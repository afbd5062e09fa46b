"""Sets of robots of low value, by exchanging one robot inside for one outside: no claim.

The value of a set has many local minima under single exchanges: from the individually weakest robots alone, attacks on
teams of thirty were found up to 0.25 % too weak; from a few dozen starts, hardly ever, in less time than one start
takes in plain NumPy.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from ratt_opt.budget import Budget
from ratt_opt.native.library import address, checked
from ratt_opt.native.loops import ScanRecord, loops
from ratt_opt.setfunctions.information import from_triangles, triangles

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

    from ratt_opt._validation import FloatArray, IntArray
    from ratt_opt.attack.team import Team

__all__ = ["descended", "exchanged", "new_scan", "weak_sets_of_size"]

BARRED, INSIDE, OUTSIDE = 0, 1, 2
"""State of a robot; a barred one takes part in no exchange."""


def new_scan() -> ScanRecord:
    """Return a scan that has tried no exchange."""
    return ScanRecord(next=0, leaves=-1, enters=-1, lowest=np.inf)


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
    where = np.full(team.robots, OUTSIDE if among is None else BARRED, dtype=np.int8)
    where[list(among or ())] = OUTSIDE
    where[list(start)] = INSIDE
    where[list(fixed)] = BARRED
    kept = fixed & start
    _settle(team, team.sums(kept), where, budget or Budget())
    return kept.union(np.flatnonzero(where == INSIDE).tolist())


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
        where = np.full(n_robots, OUTSIDE, dtype=np.int8)
        where[start] = INSIDE
        _settle(team, team.prior, where, own)
        robots = frozenset(np.flatnonzero(where == INSIDE).tolist())
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


def _settle(team: Team, kept: FloatArray, where: Any, budget: Budget) -> None:
    """Exchange until nothing is lowered, or time is up; ``where`` (N,) is changed in place."""
    sums, scan = checked("kept", np.ascontiguousarray(kept), np.float64, team.prior.shape), new_scan()
    finished = 0
    while not finished:
        with team.pace.timed(pairs := team.pace.units):
            finished = loops.exchange_robots(team.record, address(sums), address(where), pairs, scan)
        if finished < 0:
            raise MemoryError
        if budget.is_over:
            return


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
