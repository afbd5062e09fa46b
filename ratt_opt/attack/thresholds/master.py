"""The master: links that groups which cover the team cost at least, by duals of a linear program.

    minimise    sum cut(C) x_C
    subject to  each robot in exactly one chosen group   [duals u_i]
                sum blinded(C) x_C <= alpha_s            [dual -m]

HiGHS suggests ``u`` and ``m``. Rounded to integers they are a bound by themselves: of groups that cover the team each
costs at least ``u(C) - m blinded(C)`` plus the least reduced cost of all columns. If all columns are listed
(:func:`best_duals`), these are looked through; otherwise pricing bounds them (:class:`GroupPrices` knows some columns).

Source: Johnson, Mehrotra and Nemhauser, Min-cut clustering, Mathematical Programming 62 (1993).
"""

from __future__ import annotations

from dataclasses import dataclass
from math import inf
from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.attack.thresholds.columns import UNIT, IntegerDuals
from ratt_opt.attack.thresholds.pricing import DualPrices
from ratt_opt.graph.communication import robots_of
from ratt_opt.highs import LinearProgram, rows_of

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from numpy.typing import ArrayLike

    from ratt_opt._validation import BoolArray, FloatArray
    from ratt_opt.attack.params.groups import MasterParams
    from ratt_opt.attack.thresholds.columns import Column, Columns
    from ratt_opt.budget import Budget
    from ratt_opt.graph.threat import Threat
    from ratt_opt.highs import Rows

__all__ = ["DualBound", "GroupPrices", "KnownGroup", "best_duals"]


@dataclass(frozen=True, slots=True)
class DualBound:
    """``duals`` : under which no column has a negative reduced cost; ``columns`` : of the program.

    ``used`` : columns of which the last solution takes a part
    """

    duals: IntegerDuals
    columns: list[Column]
    used: list[Column]


def best_duals(  # noqa: PLR0917
    columns: Columns, n_blinded: int, most_cut: int, budget: Budget, params: MasterParams, first: Iterable[Column] = ()
) -> DualBound:
    """The best duals under which no column has a negative reduced cost, or some that claim more than ``most_cut``.

    ``first`` : columns that the program begins with

    Raises
    ------
    OutOfBudget : the time is up, or the user interrupted.
    """
    n = columns.robots
    program = _program(n, n_blinded, 4.0 * (most_cut + n**2))
    best, known, parts = IntegerDuals(np.zeros(n, np.int64), 0), dict.fromkeys(first), np.zeros(0)
    program.add_rows(_rows(list(known), n))
    while best.claim(n_blinded) <= most_cut * UNIT:
        budget.check()
        claimed = program.solve()
        duals, parts = _rounded(claimed.x, n), np.abs(claimed.duals)
        if duals is None:
            break  # HiGHS has nothing to say; what is known stays true
        least, cheapest = columns.cheapest(duals)
        if least < 0:  # every group has a robot, so that this makes up for it
            duals = IntegerDuals(duals.robots + least, duals.blinding)
        if duals.claim(n_blinded) > best.claim(n_blinded):
            best = duals
        fresh = [one for one in columns.some(cheapest) if one not in known]
        if not fresh:
            break
        known.update(dict.fromkeys(fresh))
        program.add_rows(_rows(fresh, n))
    entered = list(known)
    return DualBound(best, entered, [entered[k] for k in np.flatnonzero(parts > params.used)])


def _rounded(claimed: FloatArray, n: int) -> IntegerDuals | None:
    if len(claimed) != n + 1 or not np.isfinite(claimed).all():
        return None
    return IntegerDuals(np.floor(claimed[:n] * UNIT).astype(np.int64), max(int(np.ceil(claimed[n] * UNIT)), 0))


def _rows(columns: Sequence[Column], robots: int) -> Rows:
    groups = [(robots_of(column.group), column.blinded) for column in columns]
    return _no_negative_costs(groups, [column.cut for column in columns], robots)


def _program(robots: int, n_blinded: int, largest: float) -> LinearProgram:
    """The dual without a column: prices of robots, of either sign, and of a blinded one, up to ``largest`` in size."""
    lower = np.append(np.full(robots, -largest), 0.0)
    return LinearProgram(np.append(np.ones(robots), -float(n_blinded)), lower, largest, maximise=True)


def _no_negative_costs(groups: Iterable[tuple[list[int], int]], cuts: ArrayLike, robots: int) -> Rows:
    """Build the rows that no group has a negative reduced cost.

    ``groups`` : robots of each group, and how many of them are blinded
    """
    entries = [([*members, robots], [*[1.0] * len(members), -float(need)]) for members, need in groups]
    return rows_of(entries, -inf, cuts)


@dataclass(frozen=True, slots=True, kw_only=True)
class KnownGroup:
    """``robots`` (N,) with ``need`` of them blinded; asked for at thresholds above ``value`` only."""

    robots: BoolArray
    need: int
    value: float


class GroupPrices:
    """The linear program over known groups of one threat; groups may be added and the threshold changed at any time.

    Prices are of half links: if every group below the threshold has ``pi(g) <= cut(g) / 2 + mu need(g)``, an attack
    that leaves only such groups cuts at least ``sum of pi - mu alpha_s`` links.
    """

    def __init__(self, threat: Threat, params: MasterParams) -> None:
        self._threat, self._robots, self._params = threat, threat.graph.n_robots, params
        self._adjacent = np.zeros((self._robots, self._robots), dtype=np.int64)
        for i, j in threat.graph.links:
            self._adjacent[i, j] = self._adjacent[j, i] = 1
        self._groups: dict[tuple[bytes, int], KnownGroup] = {}
        self._program: LinearProgram | None = None
        self._threshold = -np.inf

    def add(self, groups: Iterable[KnownGroup]) -> int:
        """Add groups; returns how many are new."""
        fresh = []
        for group in groups:
            key = (group.robots.tobytes(), group.need)
            if key not in self._groups or self._groups[key].value > group.value:
                self._groups[key] = group
                fresh.append(group)
        if self._program is not None:
            self._enter(self._program, fresh)
        return len(fresh)

    def solve(self, threshold: float, seconds: float = np.inf) -> DualPrices:
        """Best prices at which no known group of this threshold has a negative reduced cost.

        After that many seconds, prices of nothing.
        """
        if self._program is None or threshold != self._threshold:
            most = 2.0 * len(self._threat.graph.links) + 2.0
            self._threshold, self._program = threshold, _program(self._robots, self._threat.n_blinded, most)
            self._enter(self._program, self._groups.values())
        claim, n = self._program.solve(seconds).x, self._robots
        if len(claim) != n + 1:
            return DualPrices(robot=np.zeros(n), blinded=0.0, links=0.0)
        robot, blinded = claim[:n], max(float(claim[n]), 0.0)
        if self._program.n_rows > self._params.most_rows:
            self._forget(robot, blinded)
        return DualPrices(robot=robot, blinded=blinded, links=float(robot.sum()) - blinded * self._threat.n_blinded)

    def half_cuts(self, groups: BoolArray) -> FloatArray:
        """(C,) half the links that separate the robots of each row of ``groups`` (C, N) from the others."""
        return np.asarray(0.5 * ((groups @ self._adjacent) * ~groups).sum(axis=1))

    def _enter(self, program: LinearProgram, groups: Iterable[KnownGroup]) -> None:
        below = [group for group in groups if group.value < self._threshold]
        if below:
            cuts = self.half_cuts(np.array([group.robots for group in below]))
            needs = [(np.flatnonzero(group.robots).tolist(), group.need) for group in below]
            program.add_rows(_no_negative_costs(needs, cuts, self._robots))

    def _forget(self, robot: FloatArray, blinded: float) -> None:
        """Keep the groups whose reduced cost is among the least, and start afresh next time."""
        keys, groups = list(self._groups), list(self._groups.values())
        robots, need = np.array([group.robots for group in groups]), np.array([group.need for group in groups])
        costs = self.half_cuts(robots) + blinded * need - robots @ robot
        self._groups = {keys[k]: groups[k] for k in np.argsort(costs, kind="stable")[: self._params.most_rows // 2]}
        self._program = None
