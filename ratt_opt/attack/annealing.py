"""The heuristic attacker: annealing from many starts, the whole team and the best attack so far in turn."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.attack.team import Links, Team, has_native_kernel
from ratt_opt.budget import OutOfBudget
from ratt_opt.native.library import address, address_of
from ratt_opt.native.loops import AnnealRecord, loops
from ratt_opt.problem import Attack

if TYPE_CHECKING:
    from ratt_opt._validation import BoolArray, FloatArray, IntArray
    from ratt_opt.budget import Budget
    from ratt_opt.graph.communication import Link
    from ratt_opt.graph.threat import Threat
    from ratt_opt.problem import Problem

__all__ = ["AnnealedAttacks", "Partition", "Starts"]

MOVES, LONGER, LONGEST = 10_000, 16, 4
"""Moves per robot of the first starts; they double after each ``LONGER`` starts, up to ``LONGEST`` times as many. At 24
robots a start of 240,000 moves takes 0.02 s and finds the best known attack in half of the starts, but one case in ten;
at 100 robots starts that are twice as long are as good after one second and better after three."""

PART = 500_000
"""Moves between two looks at the clock, times what a value takes in the plane: some thousandths of a second."""

HOT, COLD = 0.02, 0.00005
"""First and last temperature relative to the whole team's value. Nine attacks on 50 and 100 robots, two seeds, three
seconds each, miss the best known by 0.10 % on average, with a last one of 0.0002 by 0.24 %; 0.001 ends up to 5 % too
high at 100 robots."""

WARM = HOT / 5
"""First temperature where a start is a good attack."""

AGAIN = 4
"""Every fourth start begins with the best attack so far, the others with the team without a cut."""


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
    """Annealed attacks, one start after the other; deterministic for a seed.

    ``source`` : a team, or (2**N,) the values of all sets of robots
    ``best`` : the best partition so far, ``None`` before the first
    """

    def __init__(
        self, source: Team | FloatArray, links: Links, threat: Threat, seed: int = 0, moves: int = MOVES
    ) -> None:
        self._source, self._links, self._threat, self._moves = source, links, threat, moves
        self._rng = np.random.default_rng(seed)
        self._random = self._rng.integers(1, 2**63, 1, np.uint64)
        self._count = 0
        if isinstance(source, Team):
            self._table, self._scale, self._work = None, source.whole_value, max(source.work // 8, 1)
        else:
            self._table, self._scale, self._work = source, float(np.abs(source).max()), 1
        self._scale = max(self._scale, 1e-300)
        self.best: Partition | None = None

    def next(self, budget: Budget) -> Partition | None:
        """The outcome of one more start; ``None`` if it left no attack within the budget.

        Raises
        ------
        OutOfBudget : the time is up; ``best`` keeps what was found.
        """
        moves = self._moves * min(2 ** (self._count // LONGER), LONGEST)
        self._count += 1
        if self._count % AGAIN == 0 and self.best is not None:
            return self._anneal(self.best.group.copy(), self.best.blind.copy(), WARM, moves, budget)
        blind = np.zeros(self._threat.graph.n_robots, dtype=np.bool_)
        blind[self._rng.permutation(np.flatnonzero(~self._links.seeing))[: self._threat.n_blinded]] = True
        return self._anneal(self._groups(frozenset()), blind, HOT, moves, budget)

    def _groups(self, cut: frozenset[Link]) -> IntArray:
        """(N,) the group of each robot after cutting links."""
        group = np.zeros(self._threat.graph.n_robots, dtype=np.int64)
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
        best, best_blind, least, partition = group.copy(), blind.copy(), np.full(1, np.inf), None
        links, steps, part = self._links, moves * len(group), max(PART // self._work, 1)
        record = AnnealRecord(
            table=None if self._table is None else address(self._table),
            team=address_of(self._source.record) if isinstance(self._source, Team) else None,
            robots=len(group),
            budget=self._threat.alpha_c,
            start=address(links.start),
            robot=address(links.robot),
            fixed=address(links.fixed),
            seeing=address(links.seeing),
            group=address(group),
            best_group=address(best),
            blind=address(blind),
            best_blind=address(best_blind),
            first=0,
            last=0,
            steps=steps,
            hot=hot * self._scale,
            cold=COLD * self._scale,
            least=address(least),
            random=address(self._random),
        )
        for record.first in range(0, steps, part):
            budget.check()
            before, record.last = float(least[0]), min(record.first + part, steps)
            if loops.anneal(record):
                raise MemoryError
            if least[0] < before:
                partition = Partition(group=best.copy(), blind=best_blind.copy(), value=float(least[0]))
                if self.best is None or partition.value < self.best.value:
                    self.best = partition
        return partition


class AnnealedAttacks:
    """Attacks on plans of one threat, for criteria with compiled code; the same for the same order of questions."""

    def __init__(self, problem: Problem, budget: Budget) -> None:
        self._threat, self._budget = problem.threat, budget
        self._links = Links.of(problem.threat)
        self._count = 0

    @classmethod
    def of(cls, problem: Problem, budget: Budget) -> AnnealedAttacks | None:
        """``None`` if the objective has no compiled code."""
        return cls(problem, budget) if has_native_kernel(problem.objective) else None

    def attack(self, problem: Problem, plan: IntArray, moves: int, known: Attack | None = None) -> Attack | None:
        """An attack on a plan after that many moves a robot, from a known one or anew; ``None`` if none was found.

        ``problem`` : may have another objective and other elements, but this threat
        """
        team = Team.of(problem.objective, plan)
        assert team is not None
        starts = Starts(team, self._links, self._threat, seed=self._count, moves=moves)
        self._count += 1
        try:
            best = starts.next(self._budget) if known is None else starts.near(known, self._budget)
        except OutOfBudget:
            best = starts.best
        return None if best is None else best.attack(self._threat)
