"""Plain annealing of attacks on one plan: what the exact attacker must never be worse than, given the same seconds."""

from __future__ import annotations

import math
import time
from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.attack.team import Links, Team
from ratt_opt.problem import Attack

if TYPE_CHECKING:
    from ratt_opt._validation import BoolArray, IntArray
    from ratt_opt.problem import Problem

__all__ = ["plain_annealing"]

HOT, COLD, MOVES = 0.02, 0.0002, 20_000
"""Temperatures relative to the team's value, and moves of one cooling of plain annealing: some tenths of a second."""


class _Cooling:
    """One cooling from the whole team; the best attack until now is ``best_group`` (N,) and ``best_blind`` (N,)."""

    def __init__(self, team: Team, links: Links, blind: BoolArray, budget: int, rng: np.random.Generator) -> None:
        self._team, self._links, self._budget, self._rng = team, links, budget, rng
        self._group, self._blind, self._cut = np.zeros(team.robots, dtype=np.int64), blind, 0
        self._values = np.array([self._value(g) for g in range(team.robots)])
        self._energy, self._least = float(self._values.max()), math.inf
        self.best_group, self.best_blind = self._group.copy(), blind.copy()

    def _value(self, g: int) -> float:
        return self._team.value((self._group == g) & ~self._blind)

    def run(self, hot: float, cold: float) -> None:
        """Make all moves: a robot changes groups, or is blinded instead of another."""
        for move in range(MOVES):
            i, j = self._rng.integers(0, self._team.robots, 2).tolist()
            temperature = hot * (cold / hot) ** (move / MOVES)
            if self._rng.random() < 0.5:
                self._blind_instead(i, j, temperature)
            else:
                own = int(self._rng.integers(0, self._team.robots))
                self._transfer(i, own if self._rng.random() < 0.1 else int(self._group[j]), temperature)

    def _blind_instead(self, i: int, j: int, temperature: float) -> None:
        if self._blind[i] or not self._blind[j] or self._links.seeing[i]:
            return
        self._blind[i], self._blind[j] = True, False
        if not self._is_kept({int(self._group[i]), int(self._group[j])}, 0, temperature):
            self._blind[i], self._blind[j] = False, True

    def _transfer(self, i: int, target: int, temperature: float) -> None:
        home = int(self._group[i])
        others = self._group[self._links.robot[self._links.start[i] : self._links.start[i + 1]]]
        more = int((others == home).sum() - (others == target).sum())
        if target == home or self._cut + more > self._budget:
            return
        self._group[i] = target
        if not self._is_kept({home, target}, more, temperature):
            self._group[i] = home

    def _is_kept(self, changed: set[int], more: int, temperature: float) -> bool:
        """Whether what has changed in these groups stays."""
        before = self._values.copy()
        for g in changed:
            self._values[g] = self._value(g)
        after = float(self._values.max())
        if after > self._energy and self._rng.random() >= math.exp((self._energy - after) / temperature):
            self._values = before
            return False
        self._energy, self._cut = after, self._cut + more
        if after < self._least:
            self._least, self.best_group, self.best_blind = after, self._group.copy(), self._blind.copy()
        return True


def plain_annealing(problem: Problem, plan: IntArray, seconds: float, seed: int) -> float:
    """Worst value that annealing from the whole team finds, cooled again and again for that many seconds."""
    team = Team.of(problem.objective, plan)
    if team is None:
        raise TypeError("the criterion has no compiled loops")
    links, rng = Links.of(problem.threat), np.random.default_rng(seed)
    whole, best, ends = problem.objective(plan), np.inf, time.monotonic() + seconds
    while time.monotonic() < ends:
        blind = np.zeros(problem.n_robots, dtype=np.bool_)
        blind[rng.permutation(np.flatnonzero(~links.seeing))[: problem.threat.n_blinded]] = True
        cooling = _Cooling(team, links, blind, problem.alpha_c, rng)
        cooling.run(HOT * whole, COLD * whole)
        group = cooling.best_group
        cut = frozenset((i, j) for i, j in problem.communication.links if group[i] != group[j])
        attack = Attack(frozenset(np.flatnonzero(cooling.best_blind).tolist()), cut)
        best = min(best, problem.team_value(plan, attack))
    return best
