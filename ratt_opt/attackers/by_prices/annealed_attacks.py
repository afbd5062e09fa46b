"""Quick attacks on one plan after the other: annealed anew, and from an attack that is known to hurt."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ratt_opt.attack.annealing import Starts
from ratt_opt.attack.links import Links
from ratt_opt.attack.team import Team, has_loops
from ratt_opt.budget import OutOfBudget

if TYPE_CHECKING:
    from ratt_opt._validation import IntArray
    from ratt_opt.budget import Budget
    from ratt_opt.problem import Attack, Problem

__all__ = ["AnnealedAttacks"]


class AnnealedAttacks:
    """Attacks on plans of one threat, for criteria with compiled code; the same for the same order of questions."""

    def __init__(self, problem: Problem, budget: Budget) -> None:
        self._threat, self._budget = problem.threat, budget
        self._links = Links.of(problem.threat)
        self._count = 0

    @classmethod
    def of(cls, problem: Problem, budget: Budget) -> AnnealedAttacks | None:
        """``None`` where the objective has no compiled code."""
        return cls(problem, budget) if has_loops(problem.objective) else None

    def attack(self, problem: Problem, plan: IntArray, moves: int, known: Attack | None = None) -> Attack | None:
        """An attack on a plan after so many moves a robot, from a known one or anew; ``None`` where none was found.

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
