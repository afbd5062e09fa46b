"""Is there an attack worth less than a threshold? By prices, enumeration and covers.

1. Prices (``prices.py``) that claim more links than the budget refute the threshold once the enumeration
   (``columns.py``) has found no group that pays them; groups that do are added to the program.
2. Prices that claim ``gap`` links less leave the groups of reduced cost at most ``gap``: they are listed, and the
   partitions into them tried (``cover.py``). Either one is an attack, or the threshold is refuted.

Source: for the second step, Baldacci, Christofides and Mingozzi, Mathematical Programming 115 (2008).
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum
from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.attackers.by_prices.blinding import ABSENT, weak_subset
from ratt_opt.attackers.by_prices.columns import FINISHED, FULL, Prices, Question, Stack, enumerate_groups
from ratt_opt.attackers.by_prices.cover import FOUND, PAUSED, next_cover
from ratt_opt.attackers.by_prices.prices import GroupPrices, KnownGroup, PriceVector
from ratt_opt.attackers.by_prices.starts import Split

if TYPE_CHECKING:
    from collections.abc import Iterator

    from ratt_opt._validation import BoolArray, FloatArray, IntArray
    from ratt_opt.attackers.by_prices.team import Links, Team
    from ratt_opt.budget import Budget
    from ratt_opt.graph.threat import Threat

__all__ = ["Answer", "Decision", "Verdict"]

SHARES = np.array([1.0, 0.75, 0.5, 0.25, 0.0])
"""Mixtures of the two bounds of the enumeration. Measured at 24 robots: five flows visit a half to a seventh of the
nodes of two."""

MARGIN = 1e-3
"""Links that scaled prices claim beyond the budget; well above rounding, well below one link."""

TOLERANCE = 1e-6
"""Reduced costs below minus this count as negative: above what the linear program leaves of its rows, and a team's sum
stays well below MARGIN."""

STEPS = (-3.0, -0.3, -0.01)
"""Reduced costs asked for in turn: the groups that pay the prices worst are found first, and fast."""

LOWERED = 0.01
"""By which all robots' prices fall once no group is below the last of STEPS; no reduced cost is negative then."""

CHUNK, ROOM, NEW_GROUPS = 2_000, 100_000, 100
"""Nodes between two looks at the clock; groups listed for covers; groups added to the program at a time."""

QUICK, THOROUGH = 200, 3_000
"""Values looked at to decide what a group needs: at every node (some 20 microseconds), and before it is listed."""

SIZE_VALUES = 1_000_000
"""Values looked at to prove that no weak set has a certain size."""


class Verdict(Enum):
    """What became of a threshold."""

    REFUTED = "refuted"
    REACHED = "reached"
    OPEN = "open"


@dataclass(frozen=True, slots=True, kw_only=True)
class Answer:
    """``split`` : an attack below the threshold, where it is reached."""

    verdict: Verdict
    split: Split | None = None


@dataclass(frozen=True, slots=True)
class _Listed:
    """Groups of small reduced cost: robots and blinded ones (C, N), least and found needs (C, 2), costs (C,)."""

    code: int
    robots: BoolArray
    blinded: BoolArray
    need: IntArray
    cost: FloatArray


class Decision:
    """Decides thresholds for one plan; what is learned about groups serves the next threshold."""

    def __init__(self, team: Team, links: Links, threat: Threat) -> None:
        self.team, self.links, self.threat = team, links, threat
        self.prices = GroupPrices(threat)
        self._n_robots = len(team.single)
        self._rng, self._shuffled = np.random.default_rng(0), False
        for i in range(self._n_robots):
            alone = np.arange(self._n_robots) == i
            self.prices.add([KnownGroup(robots=alone, need=0, value=float(team.single[i]))])
            if not links.seeing[i]:
                self.prices.add([KnownGroup(robots=alone, need=1, value=0.0)])

    def learn(self, split: Split) -> None:
        """Add the groups of an attack to the program."""
        from ratt_opt.attackers.by_prices.compiled import gather

        sums = np.empty_like(self.team.prior)
        for label in np.unique(split.group):
            robots = split.group == label
            value = float(gather(self.team, robots & ~split.blind, sums))
            self.prices.add([KnownGroup(robots=robots, need=int((robots & split.blind).sum()), value=value)])

    def decide(self, threshold: float, budget: Budget, nodes: int) -> Answer:
        """Decide one threshold; ``OPEN`` after so many nodes of one enumeration.

        Raises
        ------
        OutOfBudget : the time is up.
        """
        size = self._largest_weak(threshold, budget)
        step = 0
        while True:
            budget.check()
            found = self.prices.solve(threshold)
            refuting = found.links > self.threat.alpha_c + MARGIN
            if refuting and step > 0:
                step = len(STEPS)
            elif step == len(STEPS):
                return self._cover(found.lowered(LOWERED), threshold, size, budget, nodes)
            asked = found.scaled(self.threat.alpha_c + MARGIN) if refuting else found
            limit = STEPS[step] if step < len(STEPS) else -TOLERANCE
            listed = self._list(asked, (threshold, size, limit), budget, (nodes, NEW_GROUPS))
            self._shuffled = listed.code == FULL
            if len(listed.cost):
                if not self._teach(listed, threshold):
                    return Answer(verdict=Verdict.OPEN)
            elif listed.code != FINISHED:
                return Answer(verdict=Verdict.OPEN)
            elif step == len(STEPS):
                return Answer(verdict=Verdict.REFUTED)
            else:
                step += 1

    def _teach(self, listed: _Listed, threshold: float) -> int:
        """Add listed groups to the program, with what they are known to need at least."""
        below = np.nextafter(threshold, -np.inf)
        rows = zip(listed.robots, listed.need[:, 0].tolist(), strict=True)
        return self.prices.add([KnownGroup(robots=row.copy(), need=need, value=float(below)) for row, need in rows])

    def _largest_weak(self, threshold: float, budget: Budget) -> int:
        """A size that no set of robots worth less than the threshold exceeds."""
        everyone, nobody = np.ones(self._n_robots, dtype=np.bool_), np.zeros(self._n_robots, dtype=np.bool_)
        for size in range(self._n_robots, 0, -1):
            budget.check()
            spared, found = self._n_robots - size, nobody.copy()
            if weak_subset(self.team, nobody, everyone, spared, threshold, SIZE_VALUES, found) != ABSENT:
                return size
        return 0

    def _list(
        self, prices: PriceVector, asked: tuple[float, int, float], budget: Budget, most: tuple[int, int]
    ) -> _Listed:
        """Groups of ``asked`` = (threshold, largest weak size, limit), within ``most`` = (nodes, groups)."""
        n_robots, (threshold, size, limit), (nodes, room) = self._n_robots, asked, most
        at = Prices(prices.robot, prices.blinded, np.ones(n_robots), float(size), prices.blinded, SHARES)
        order = np.argsort(-prices.robot, kind="stable")
        if self._shuffled:  # the groups listed last all began with the same robots
            order = self._rng.permutation(n_robots)
        question = Question(threshold, self.threat.n_blinded, limit, order, QUICK, THOROUGH)
        stack = Stack.of(n_robots, len(self.links.robot), len(SHARES))
        shape = (room, n_robots)
        listed = (np.zeros(shape, np.bool_), np.zeros(shape, np.bool_), np.zeros((room, 2), np.int64), np.zeros(room))
        code = PAUSED
        while code == PAUSED and int(stack.position[2]) < nodes:
            budget.check()
            before = int(stack.position[2])
            code = enumerate_groups(self.team, self.links, at, question, stack, CHUNK, listed)
            budget.nodes += int(stack.position[2]) - before
        count = int(stack.position[3])
        robots, blinded, need, cost = listed
        return _Listed(code, robots[:count], blinded[:count], need[:count], cost[:count])

    def _cover(self, prices: PriceVector, threshold: float, size: int, budget: Budget, nodes: int) -> Answer:
        """Try all partitions into groups of small reduced cost."""
        gap = self.threat.alpha_c - prices.links + TOLERANCE
        self._shuffled = False
        listed = self._list(prices, (threshold, size, gap), budget, (nodes, ROOM))
        if listed.code != FINISHED:
            return Answer(verdict=Verdict.OPEN)
        for members in self._partitions(listed, gap, budget):
            if (listed.need[members, 0] < listed.need[members, 1]).any():
                return Answer(verdict=Verdict.OPEN)
            group = np.zeros(self._n_robots, dtype=np.int64)
            for label, k in enumerate(members):
                group[listed.robots[k]] = label
            blind = np.asarray(listed.blinded[members].any(axis=0))
            return Answer(verdict=Verdict.REACHED, split=Split(group=group, blind=blind, value=threshold))
        return Answer(verdict=Verdict.REFUTED)

    def _partitions(self, listed: _Listed, gap: float, budget: Budget) -> Iterator[list[int]]:
        """Groups of each partition within both budgets."""
        n_robots = self._n_robots
        busy = np.argsort(-listed.robots.sum(axis=0), kind="stable")
        robots = np.ascontiguousarray(listed.robots[:, busy])
        lowest = robots.argmax(axis=1)
        order = np.argsort(lowest, kind="stable")
        robots = np.ascontiguousarray(robots[order])
        links = np.array([self.prices.half_cut(row) for row in listed.robots[order]])
        costs = np.stack([np.maximum(listed.cost[order], 0.0), listed.need[order, 0], links], axis=1)
        first = np.searchsorted(lowest[order], np.arange(n_robots + 1))
        position, depth = np.full(n_robots + 2, -1, dtype=np.int64), np.zeros(1, dtype=np.int64)
        covered, spent = np.zeros((n_robots + 2, n_robots), dtype=np.bool_), np.zeros((n_robots + 2, 3))
        state = (position, covered, spent, depth, first)
        budgets = np.array([gap, self.threat.n_blinded, self.threat.alpha_c], dtype=np.float64)
        while True:
            budget.check()
            code = next_cover(robots, costs, budgets, state, 1_000_000)
            if code == FOUND:
                yield order[position[: int(depth[0]) + 1]].tolist()
            elif code != PAUSED:
                return
