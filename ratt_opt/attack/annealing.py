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
    from ratt_opt._validation import BoolArray, IntArray
    from ratt_opt.attack.params.groups import AnnealingParams
    from ratt_opt.budget import Budget
    from ratt_opt.graph.communication import Link
    from ratt_opt.graph.threat import Threat
    from ratt_opt.problem import Problem

__all__ = ["AnnealedAttacks", "Partition", "Starts"]


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

    ``best`` : the best partition so far, ``None`` before the first
    """

    def __init__(
        self,
        team: Team,
        links: Links,
        threat: Threat,
        params: AnnealingParams,
        *,
        seed: int = 0,
        moves: int | None = None,
    ) -> None:
        self._team, self._links, self._threat, self._params = team, links, threat, params
        self._moves = params.moves if moves is None else moves
        self._rng = np.random.default_rng(seed)
        self._random = self._rng.integers(1, 2**63, 1, np.uint64)
        self._count = 0
        self._scale, self._work = max(team.whole_value, 1e-300), max(team.work // 8, 1)
        self.best: Partition | None = None

    def next(self, budget: Budget) -> Partition | None:
        """The outcome of one more start; ``None`` if it left no attack within the budget.

        Raises
        ------
        OutOfBudget : the time is up; ``best`` keeps what was found.
        """
        moves = self._moves * min(2 ** (self._count // self._params.longer), self._params.longest)
        self._count += 1
        if self._count % self._params.again == 0 and self.best is not None:
            return self._anneal(self.best.group.copy(), self.best.blind.copy(), self._params.warm, moves, budget)
        blind = np.zeros(self._threat.graph.n_robots, dtype=np.bool_)
        blind[self._rng.permutation(np.flatnonzero(~self._links.seeing))[: self._threat.n_blinded]] = True
        return self._anneal(self._groups(frozenset()), blind, self._params.hot, moves, budget)

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
        return self._anneal(group, blind, self._params.warm, self._moves, budget)

    def _anneal(self, group: IntArray, blind: BoolArray, hot: float, moves: int, budget: Budget) -> Partition | None:
        best, best_blind, least, partition = group.copy(), blind.copy(), np.full(1, np.inf), None
        links, steps, part = self._links, moves * len(group), max(self._params.part // self._work, 1)
        record = AnnealRecord(
            team=address_of(self._team.record),
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
            cold=self._params.cold * self._scale,
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
        starts = Starts(team, self._links, self._threat, team.params.annealing, seed=self._count, moves=moves)
        self._count += 1
        try:
            best = starts.next(self._budget) if known is None else starts.near(known, self._budget)
        except OutOfBudget:
            best = starts.best
        return None if best is None else best.attack(self._threat)
