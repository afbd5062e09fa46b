"""Prices of robots, groups, blinded robots and triples that no group pays, by a linear program with growing rows.

As ``attackers/by_prices/prices.py``, for what a group needs as weak sets say, with two kinds of columns more:
an attack leaves a number of groups at least, and of three robots one group at most holds two.

Source: for the triples, Jepsen, Petersen, Spoorendonk and Pisinger, Operations Research 56 (2008).
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import combinations
from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.budget import OutOfBudget, Stop
from ratt_opt.highs import LinearProgram, rows_of

if TYPE_CHECKING:
    from collections.abc import Iterable

    from ratt_opt._validation import FloatArray, IntArray
    from ratt_opt.attackers.by_covers.weak_sets import WeakSets
    from ratt_opt.graph.threat import Threat

__all__ = ["HALF_LINK", "CoverPrices", "CoverProgram"]

HALF_LINK = 2**22
"""Units of half a link."""

LOWERED = 1e-5
"""Links by which each robot is cheaper than the program says: more than its tolerance and what rounding takes off."""

USED = 1e-7
"""Part of a group in a solution that is more than the program's tolerance."""

NEW_TRIPLES, VIOLATED = 20, 1e-3
"""Triples added at a time, and by how much each must be violated."""


@dataclass(frozen=True, slots=True)
class CoverPrices:
    """In units: ``robot`` (N,), ``blinded``, ``group``, ``penalty`` (T,) even, of ``triple`` (T,) masks; ``slack``."""

    robot: IntArray
    blinded: int
    group: int
    triple: IntArray
    penalty: IntArray
    slack: int


class CoverProgram:
    """The linear program for one threat; groups are masks."""

    def __init__(self, threat: Threat, weak: WeakSets) -> None:
        self._threat, self._weak = threat, weak
        n_robots = threat.graph.n_robots
        self._near = [0] * n_robots
        for i, j in threat.graph.links:
            self._near[i] |= 1 << j
            self._near[j] |= 1 << i
        self._corners = np.array(list(combinations(range(n_robots), 3)), dtype=np.int64).reshape(-1, 3)
        self._groups: dict[int, None] = {}
        self._triples: list[int] = []
        self._program: LinearProgram | None = None
        self._solution: tuple[FloatArray, FloatArray] = np.zeros(0), np.zeros(0)
        self.add(1 << i for i in range(n_robots))

    def add(self, groups: Iterable[int]) -> int:
        """Add groups; returns how many are new."""
        fresh = [group for group in dict.fromkeys(groups) if group not in self._groups]
        self._groups.update(dict.fromkeys(fresh))
        if self._program is not None:
            self._append(self._program, fresh)
        return len(fresh)

    def links(self, group: int) -> int:
        """Links that separate a group from the others."""
        return sum((near & ~group).bit_count() for i, near in enumerate(self._near) if group >> i & 1)

    def solve(self, seconds: float) -> CoverPrices:
        """Best prices that no known group pays, a little lower, as far as so many seconds reach.

        Raises
        ------
        OutOfBudget : they do not reach.
        """
        n_robots, threat = len(self._near), self._threat
        if self._program is None:
            self._program = self._started()
            self._append(self._program, list(self._groups))
        claim = self._program.solve(seconds)
        if not claim.is_optimal:
            raise OutOfBudget(Stop.TIME)
        self._solution, unit = (claim.x, claim.duals), 2 * HALF_LINK
        robot = np.floor((claim.x[:n_robots] - LOWERED) * unit).astype(np.int64)
        blinded, group = (max(int(x * unit), 0) for x in claim.x[n_robots : n_robots + 2])
        penalty = 2 * np.ceil(np.maximum(claim.x[n_robots + 2 :], 0.0) * HALF_LINK).astype(np.int64)
        slack = unit * threat.alpha_c + (blinded + 1) * threat.n_blinded + int(penalty.sum()) - int(robot.sum())
        slack -= group * self._weak.fewest(threat.n_blinded)
        return CoverPrices(robot, blinded + 1, group, np.array(self._triples, dtype=np.int64), penalty, slack)

    def _started(self) -> LinearProgram:
        """Columns: robots, a blinded robot, a group, triples."""
        n_robots, threat, n_triples = len(self._near), self._threat, len(self._triples)
        fewest, most = float(self._weak.fewest(threat.n_blinded)), 2.0 * len(threat.graph.links) + 2.0
        cost = [1.0] * n_robots + [-float(threat.n_blinded), fewest] + [-1.0] * n_triples
        low, high = [-most] * n_robots + [0.0] * (2 + n_triples), [most] * len(cost)
        return LinearProgram(cost, np.array(low), np.array(high), maximise=True)

    def _append(self, program: LinearProgram, groups: list[int]) -> None:
        n_robots, entries = len(self._near), []
        for group in groups:
            members = [i for i in range(n_robots) if group >> i & 1]
            held = [k for k, triple in enumerate(self._triples) if (triple & group).bit_count() >= 2]
            columns = [*members, n_robots, n_robots + 1, *(n_robots + 2 + k for k in held)]
            values = [1.0] * len(members) + [-float(self._weak.need(group)), 1.0] + [-1.0] * len(held)
            entries.append((columns, values))
        if groups:
            program.add_rows(rows_of(entries, -np.inf, [0.5 * self.links(group) for group in groups]))

    def support(self) -> list[int]:
        """Groups of the last solution, a partition of the team into fractions of groups."""
        used = np.abs(self._solution[1]) > USED
        return [group for group, is_used in zip(self._groups, used, strict=True) if is_used]

    def renew(self) -> None:
        """Ask again what the groups need, and forget those that no attack may leave."""
        most = self._threat.n_blinded
        self._groups = {group: None for group in self._groups if self._weak.need(group) <= most}
        self._program = None

    def add_triples(self) -> bool:
        """Add triples of which the last solution's groups hold two too often, and drop those without a penalty."""
        x, duals = self._solution
        groups = np.array(self.support(), dtype=np.int64)
        member = groups[:, None] >> np.arange(len(self._near)) & 1
        held = np.abs(duals[np.abs(duals) > USED]) @ (member[:, self._corners].sum(axis=2) >= 2) - 1.0
        worst = [k for k in np.argsort(-held, kind="stable")[:NEW_TRIPLES].tolist() if held[k] > VIOLATED]
        new = [sum(1 << int(i) for i in self._corners[k]) for k in worst]
        paid = x[len(self._near) + 2 :]
        kept = [triple for triple, price in zip(self._triples, paid, strict=True) if price > 1e-9]
        fresh = [triple for triple in new if triple not in kept]
        self._triples, self._program = kept + fresh, None
        return bool(fresh)
