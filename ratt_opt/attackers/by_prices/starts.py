"""The heuristic attacker: annealing from many starts, whole teams and regions in turn."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.attackers.by_prices.annealing import POWERS, Cooling, State, anneal
from ratt_opt.problem import Attack

if TYPE_CHECKING:
    from ratt_opt._validation import BoolArray, IntArray
    from ratt_opt.attackers.by_prices.team import Links, PricedTeam
    from ratt_opt.budget import Budget
    from ratt_opt.graph.threat import Threat

__all__ = ["Partition", "Starts"]

MOVES = 4_000
"""Moves per robot of one start. Measured at 24 robots: a start of 100,000 moves takes 0.1 s and finds the best known
attack in half of the starts or more, but for one case in ten."""

PART = 500_000
"""Moves between two looks at the clock, times targets: some hundredths of a second."""

HOT, COLD = 0.05, 0.0005
"""First and last temperature relative to the whole team's value."""

WARM = HOT / 5
"""First temperature where a start is a good attack, or regions."""

PRICE = 0.02
"""Of a link too many, relative to the whole team's value; 0.005 leaves starts that never come back into the budget."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Partition:
    """A partition with its blinded robots: ``group`` (N,), ``blind`` (N,); no group is worth more than ``value``."""

    group: IntArray
    blind: BoolArray
    value: float

    def attack(self, threat: Threat) -> Attack:
        """The links between groups and the blinded robots."""
        cut = frozenset((i, j) for i, j in threat.graph.links if self.group[i] != self.group[j])
        return Attack(frozenset(np.flatnonzero(self.blind).tolist()), cut)


class Starts:
    """Annealed attacks of so many moves a robot, one start after the other; deterministic for a seed.

    ``best`` : the best partition so far, ``None`` before the first
    """

    def __init__(self, team: PricedTeam, links: Links, threat: Threat, seed: int = 0, moves: int = MOVES) -> None:
        self._team, self._links, self._threat, self._moves = team, links, threat, moves
        self._rng = np.random.default_rng(seed)
        self._count = 0
        whole = team.prior + team.information.sum(axis=0)
        self._scale = max(self._value(whole), 1e-300)
        self.best: Partition | None = None

    def _value(self, sums: np.ndarray) -> float:
        from ratt_opt.attackers.by_prices.groups.compiled import value_of

        return float(value_of(self._team, sums))

    def next(self, budget: Budget) -> Partition | None:
        """The outcome of one more start; ``None`` where it left no attack within the budget.

        Raises
        ------
        OutOfBudget : the time is up; ``best`` keeps what was found.
        """
        kind = self._count % 4 if self.best is not None else 0
        self._count += 1
        hot = HOT if kind < 2 else WARM
        group = np.zeros(len(self._team.single), dtype=np.int64)
        blind = self._blinded()
        if kind == 2:
            group = self._regions()
        elif kind == 3 and self.best is not None:
            group, blind = self.best.group.copy(), self.best.blind.copy()
        return self._anneal(group, blind, hot, budget)

    def near(self, attack: Attack, budget: Budget) -> Partition | None:
        """The outcome of a start from an attack within the budgets; otherwise as :meth:`next`."""
        group = np.zeros(len(self._team.single), dtype=np.int64)
        for label, members in enumerate(self._threat.graph.groups(attack.links)):
            group[list(members)] = label
        blind = np.zeros(len(group), dtype=np.bool_)
        blind[list(attack.sensing)] = True
        free = self._rng.permutation(np.flatnonzero(~(blind | self._links.seeing)))
        blind[free[: self._threat.n_blinded - len(attack.sensing)]] = True
        return self._anneal(group, blind, WARM, budget)

    def _anneal(self, group: IntArray, blind: BoolArray, hot: float, budget: Budget) -> Partition | None:
        scale, steps, least, partition = self._scale, self._moves * len(group), np.inf, None
        found, state = (group.copy(), blind.copy()), State.of(self._team, group, blind)
        part, power = max(PART // len(self._team.prior), 1), POWERS[(max(self._count, 1) - 1) // 4 % len(POWERS)]
        for first in range(0, steps, part):
            budget.check()
            last = min(first + part, steps)
            cooling = Cooling(steps, hot * scale, COLD * scale, PRICE * scale, self._threat.alpha_c, first, last, power)
            value = float(anneal(self._team, self._links, state, cooling, found, least, self._rng))
            if value < least:
                least, partition = value, Partition(group=found[0].copy(), blind=found[1].copy(), value=value)
                if self.best is None or value < self.best.value:
                    self.best = partition
        return partition

    def _blinded(self) -> BoolArray:
        blind = np.zeros(len(self._team.single), dtype=np.bool_)
        blind[self._rng.permutation(np.flatnonzero(~self._links.seeing))[: self._threat.n_blinded]] = True
        return blind

    def _regions(self) -> IntArray:
        """Groups grown side by side from a few random robots; robots out of reach stay together."""
        n_robots, links = len(self._team.single), self._links
        group = np.full(n_robots, -1, dtype=np.int64)
        seeds = self._rng.permutation(n_robots)[: int(self._rng.integers(2, max(3, n_robots // 4) + 1))]
        group[seeds] = np.arange(len(seeds))
        front = seeds.tolist()
        while front:
            i = front.pop(int(self._rng.integers(len(front))))
            for j in links.robot[links.start[i] : links.start[i + 1]].tolist():
                if group[j] < 0:
                    group[j] = group[i]
                    front.append(j)
        group[group < 0] = 0
        return group
