"""Prices of robots, blinded robots and links that no weak group pays, by a linear program with growing rows.

If every group worth less than the threshold has ``pi(g) <= cut(g) / 2 + mu need(g)``, an attack that leaves only such
groups cuts at least ``sum of pi - mu alpha_s`` links (add up its groups). The program looks for the prices that make
this most; it knows some groups only, so what it says is checked by the enumeration (``columns.py``).

Source: Johnson, Mehrotra and Nemhauser, Min-cut clustering, Mathematical Programming 62 (1993).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.attack.pricing import DualPrices
from ratt_opt.highs import LinearProgram, rows_of

if TYPE_CHECKING:
    from collections.abc import Iterable

    from ratt_opt._validation import BoolArray, FloatArray
    from ratt_opt.graph.threat import Threat
    from ratt_opt.highs import Rows

__all__ = ["GroupPrices", "KnownGroup"]

MOST_ROWS = 6_000
"""Rows before those are dropped that have slack at the last prices; more only slow the program down."""

SLACK_OF_BLINDED = 4.0
"""Links of slack that a blinded robot counts for. Measured at 30 robots on hubs: 76 nodes refute a threshold for which
prices in proportion take more than 50,000, and the other way round at another."""


DEARNESS = 0.7
"""Of the way to the dearest that blinded robots can be, if prices have no slack left. Measured at a threshold for
hubs of 30 robots: the search over who senses ends after 40,800, 30,800 and 29,900 nodes with 0.4, 0.7 and 0.9, and
not in 100,000 with 0."""


HELD = 0.8
"""Of what prices for dear blinded robots could claim beyond the links asked for when the price of a blinded robot was
chosen: with so much left it stays, as groups are added, and one program is solved instead of four. On disk-12 of 50
robots four programs took 33 of 120 s."""


@dataclass(frozen=True, slots=True, kw_only=True)
class KnownGroup:
    """``robots`` (N,) with ``need`` of them blinded; asked for at thresholds above ``value`` only."""

    robots: BoolArray
    need: int
    value: float


@dataclass(frozen=True, slots=True, kw_only=True)
class _Dear:
    """A price of ``blinded`` robots, for a threshold and ``links`` to claim; ``beyond`` : more links it could claim."""

    threshold: float
    links: float
    blinded: float
    beyond: float


class GroupPrices:
    """The linear program for one threat; groups may be added and the threshold changed at any time."""

    def __init__(self, threat: Threat) -> None:
        self._threat = threat
        n_robots = threat.graph.n_robots
        self._adjacent = np.zeros((n_robots, n_robots), dtype=np.int64)
        for i, j in threat.graph.links:
            self._adjacent[i, j] = self._adjacent[j, i] = 1
        self._groups: dict[tuple[bytes, int], KnownGroup] = {}
        self._program: LinearProgram | None = None
        self._slack_program: LinearProgram | None = None
        self._threshold = -np.inf
        self._dear: _Dear | None = None

    def add(self, groups: Iterable[KnownGroup]) -> int:
        """Add groups; returns how many are new."""
        fresh = []
        for group in groups:
            key = (group.robots.tobytes(), group.need)
            if key not in self._groups or self._groups[key].value > group.value:
                self._groups[key] = group
                fresh.append(group)
        if self._program is not None:
            self._append([group for group in fresh if group.value < self._threshold])
        return len(fresh)

    def solve(self, threshold: float, seconds: float = np.inf) -> DualPrices:
        """Best prices that no known group of this threshold pays, as far as that many seconds reach."""
        if self._program is None or threshold != self._threshold:
            self._start(threshold)
        assert self._program is not None
        claim = self._program.solve(seconds)
        n_robots = len(self._adjacent)
        if len(claim.x) != n_robots + 1:
            return DualPrices(robot=np.zeros(n_robots), blinded=0.0, links=0.0)
        robot, blinded = claim.x[:n_robots], max(float(claim.x[n_robots]), 0.0)
        links = float(robot.sum()) - blinded * self._threat.n_blinded
        if self._program.n_rows > MOST_ROWS:
            self._forget(robot, blinded)
        return DualPrices(robot=robot, blinded=blinded, links=links)

    def slackest(self, threshold: float, links: float, seconds: float = np.inf) -> DualPrices | None:
        """Prices that claim that many links and are furthest below what known groups cost; ``None`` if none are found.

        Blinded robots count more than links: prices of theirs prune the enumeration most.
        """
        if self._program is None or threshold != self._threshold:
            self._start(threshold)
        n_robots, x = len(self._adjacent), self._claiming(links).solve(seconds).x
        if len(x) != n_robots + 2:
            return None
        blinded = max(float(x[n_robots]), 0.0)
        claimed = float(x[:n_robots].sum()) - blinded * self._threat.n_blinded
        return DualPrices(robot=x[:n_robots], blinded=blinded, links=claimed) if claimed >= links - 1e-6 else None

    def dearest(
        self, threshold: float, links: float, seconds: float = np.inf, reserve: float = 0.0
    ) -> DualPrices | None:
        """Prices that claim that many links with blinded robots about as dear as can be; ``None`` if none are found.

        Dear ones keep the groups of the search over who senses small. ``reserve`` : share of the links that could be
        claimed beyond these to claim, too.
        """
        dear = self._as_dear(threshold, links, seconds)
        if dear is None:
            found, most = self.solve(threshold, seconds), self._dearest_blinded(links, seconds)
            if found.links < links or most is None:
                return None
            blinded = max(found.blinded + DEARNESS * (most - found.blinded), 0.0)
            dear = self._with_blinded_at(threshold, blinded, seconds)
            if dear is None or dear.links < links:
                return None
            self._dear = _Dear(threshold=threshold, links=links, blinded=blinded, beyond=dear.links - links)
        return dear.for_robots(links + reserve * (dear.links - links), self._threat.n_blinded)

    def _as_dear(self, threshold: float, links: float, seconds: float) -> DualPrices | None:
        """With blinded robots at the price chosen last for the same; ``None`` if there is none that still does."""
        last = self._dear
        if last is None or (last.threshold, last.links) != (threshold, links):
            return None
        dear = self._with_blinded_at(threshold, last.blinded, seconds)
        return dear if dear is not None and dear.links - links > HELD * last.beyond else None

    def _with_blinded_at(
        self, threshold: float, blinded: float, seconds: float, robot: FloatArray | None = None
    ) -> DualPrices | None:
        """Best prices with this one of a blinded robot and at most ``robot`` (N,) of the others, if given."""
        if self._program is None or threshold != self._threshold:
            self._start(threshold)
        assert self._program is not None
        n_robots, most = len(self._adjacent), self._most()
        highest = [most] * n_robots if robot is None else robot.tolist()
        for i, price in enumerate([*highest, blinded]):
            self._program.bound_column(i, blinded if i == n_robots else -most, price)
        x = self._program.solve(seconds).x
        for i in range(n_robots + 1):
            self._program.bound_column(i, 0.0 if i == n_robots else -most, most)
        if len(x) != n_robots + 1:
            return None
        claimed = float(x[:n_robots].sum()) - blinded * self._threat.n_blinded
        return DualPrices(robot=x[:n_robots], blinded=blinded, links=claimed)

    def _dearest_blinded(self, links: float, seconds: float) -> float | None:
        """The highest price of a blinded robot at which that many links can be claimed."""
        n_robots, program = len(self._adjacent), self._claiming(links)
        program.change_cost(np.eye(n_robots + 2)[n_robots])
        x = program.solve(seconds).x
        program.change_cost(np.eye(n_robots + 2)[n_robots + 1])
        return float(x[n_robots]) if len(x) == n_robots + 2 else None

    def _claiming(self, links: float) -> LinearProgram:
        """The program of :meth:`slackest`, for that many links."""
        if self._slack_program is None:
            self._slack_program = self._start_slack()
        self._slack_program.bound_row(0, -np.inf, -links)
        return self._slack_program

    def _start_slack(self) -> LinearProgram:
        """The program of :meth:`slackest`: prices, and the slack's share; the first row is the links they claim."""
        n_robots, most = len(self._adjacent), self._most()
        claim = rows_of([([*range(n_robots + 1)], [-1.0] * n_robots + [float(self._threat.n_blinded)])], -np.inf, 0.0)
        cost = np.append(np.zeros(n_robots + 1), 1.0)
        low, high = np.append(np.full(n_robots, -most), [0.0, 0.0]), np.append(np.full(n_robots, most), [most, most])
        program = LinearProgram(cost, low, high, rows=claim, maximise=True)
        program.add_rows(self._rows(self._weak(), slack=True))
        return program

    def _most(self) -> float:
        return 2.0 * len(self._threat.graph.links) + 2.0

    def _start(self, threshold: float) -> None:
        n_robots = len(self._adjacent)
        most = self._most()
        cost = np.append(np.ones(n_robots), -float(self._threat.n_blinded))
        low, high = np.append(np.full(n_robots, -most), 0.0), np.append(np.full(n_robots, most), most)
        self._program = LinearProgram(cost, low, high, maximise=True)
        self._slack_program = None
        self._threshold = threshold
        self._append(self._weak())

    def _weak(self) -> list[KnownGroup]:
        return [group for group in self._groups.values() if group.value < self._threshold]

    def half_cut(self, robots: BoolArray) -> float:
        """Half the links that separate these robots (N,) from the others."""
        return float(self.half_cuts(robots[None])[0])

    def half_cuts(self, groups: BoolArray) -> FloatArray:
        """The same for each row of ``groups`` (C, N)."""
        return np.asarray(0.5 * ((groups @ self._adjacent) * ~groups).sum(axis=1))

    def _append(self, groups: list[KnownGroup]) -> None:
        if not groups:
            return
        assert self._program is not None
        self._program.add_rows(self._rows(groups, slack=False))
        if self._slack_program is not None:
            self._slack_program.add_rows(self._rows(groups, slack=True))

    def _rows(self, groups: list[KnownGroup], *, slack: bool) -> Rows:
        """That no group pays, or that each could pay its part of the slack besides."""
        n_robots, entries = len(self._adjacent), []
        half = self.half_cuts(np.array([group.robots for group in groups], dtype=np.bool_).reshape(-1, n_robots))
        for group, cut in zip(groups, half.tolist(), strict=True):
            members = np.flatnonzero(group.robots).tolist()
            columns, values = [*members, n_robots], [1.0] * len(members) + [-float(group.need)]
            if slack:
                columns, values = [*columns, n_robots + 1], [*values, cut + SLACK_OF_BLINDED * group.need]
            entries.append((columns, values))
        return rows_of(entries, [-np.inf] * len(groups), half)

    def _forget(self, robot: FloatArray, blinded: float) -> None:
        """Keep the groups whose reduced cost is among the least, and start afresh next time."""
        known = list(self._groups.items())
        slack = [
            self.half_cut(group.robots) + blinded * group.need - float(robot[group.robots].sum()) for _, group in known
        ]
        order = np.argsort(slack, kind="stable")[: MOST_ROWS // 2]
        self._groups = dict(known[k] for k in order)
        self._program = None
        self._slack_program = None
