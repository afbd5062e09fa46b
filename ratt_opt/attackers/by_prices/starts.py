"""The heuristic attacker: annealing from many starts, the whole team and the best attack so far in turn."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.attackers.by_prices.annealing import Cooling, State, anneal
from ratt_opt.problem import Attack

if TYPE_CHECKING:
    from ratt_opt._validation import BoolArray, IntArray
    from ratt_opt.attackers.by_prices.team import Links, PricedTeam
    from ratt_opt.budget import Budget
    from ratt_opt.graph.communication import Link
    from ratt_opt.graph.threat import Threat

__all__ = ["Partition", "Starts"]

MOVES, LONGER, LONGEST = 4_000, 16, 4
"""Moves per robot of the first starts, which double after so many starts, up to so many times as many. At 24 robots a
start of 100,000 moves takes 0.03 s and finds the best known attack in half of the starts or more, but for one case in
ten; at 100 robots starts that are twice as long are as good after one second and better after three."""

PART = 500_000
"""Moves between two looks at the clock, times targets: some thousandths of a second."""

HOT, COLD = 0.02, 0.00005
"""First and last temperature relative to the whole team's value. Nine attacks on 50 and 100 robots, two seeds, three
seconds each, miss the best known by 0.10 % on average, with a last one of 0.0002 by 0.24 %; 0.001 ends up to 5 % too
high at 100 robots."""

WARM = HOT / 5
"""First temperature where a start is a good attack."""

AGAIN = 4
"""One of so many starts is the best attack so far; the others are the team without a cut."""


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
        moves = self._moves * min(2 ** (self._count // LONGER), LONGEST)
        self._count += 1
        if self._count % AGAIN == 0 and self.best is not None:
            return self._anneal(self.best.group.copy(), self.best.blind.copy(), WARM, moves, budget)
        blind = np.zeros(len(self._team.single), dtype=np.bool_)
        blind[self._rng.permutation(np.flatnonzero(~self._links.seeing))[: self._threat.n_blinded]] = True
        return self._anneal(self._groups(frozenset()), blind, HOT, moves, budget)

    def _groups(self, cut: frozenset[Link]) -> IntArray:
        """(N,) the group of each robot after cutting links."""
        group = np.zeros(len(self._team.single), dtype=np.int64)
        for label, members in enumerate(self._threat.graph.groups(cut)):
            group[list(members)] = label
        return group

    def near(self, attack: Attack, budget: Budget) -> Partition | None:
        """The outcome of a start from an attack that is within the budgets; otherwise as :meth:`next`."""
        group = self._groups(attack.links)
        blind = np.zeros(len(group), dtype=np.bool_)
        blind[list(attack.sensing)] = True
        free = self._rng.permutation(np.flatnonzero(~(blind | self._links.seeing)))
        blind[free[: self._threat.n_blinded - len(attack.sensing)]] = True
        return self._anneal(group, blind, WARM, self._moves, budget)

    def _anneal(self, group: IntArray, blind: BoolArray, hot: float, moves: int, budget: Budget) -> Partition | None:
        scale, steps, least, partition = self._scale, moves * len(group), np.inf, None
        found, state = (group.copy(), blind.copy()), State.of(self._team, group, blind)
        part = max(PART // len(self._team.prior), 1)
        for first in range(0, steps, part):
            budget.check()
            last = min(first + part, steps)
            cooling = Cooling(steps, hot * scale, COLD * scale, self._threat.alpha_c, first, last)
            value = float(anneal(self._team, self._links, state, cooling, found, least, self._rng))
            if value < least:
                least, partition = value, Partition(group=found[0].copy(), blind=found[1].copy(), value=value)
                if self.best is None or value < self.best.value:
                    self.best = partition
        return partition
