"""The best plan whose worst case is proved."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ratt_opt.stopping import Stop

if TYPE_CHECKING:
    from ratt_opt._validation import IntArray
    from ratt_opt.attackers.result import AttackResult
    from ratt_opt.budget import Budget
    from ratt_opt.solvers.maxmin.plans.adversary import Adversary

__all__ = ["PROVED", "ProvedPlan"]

PROVED = 2e-10
"""Relative difference between a plan's known and its proved value that counts as none. The search leaves it out of its
own gap, so that both together stay within 1e-9, the smallest gap that is asked for."""


class ProvedPlan:
    """``elements`` keep ``lower`` under every attack, as ``worst_case`` proved; before it, what nothing is worth.

    ``unproved_stop`` : why the last exact attack that did not close stopped. ``evaluations`` : of all exact attacks.
    """

    def __init__(self, adversary: Adversary, elements: IntArray) -> None:
        self.adversary = adversary
        self.elements = elements
        self.lower = adversary.problem.objective([])  # whatever the plan
        self.worst_case: AttackResult | None = None
        self.evaluations = 0
        self.unproved_stop = Stop.HEURISTIC

    def reaches(self, level: float) -> bool:
        """Whether the proved value is a plan's known one."""
        return self.lower >= level - PROVED * abs(level) - self.adversary.problem.objective.rounding

    def attack(self, plan: IntArray, budget: Budget) -> None:
        """Attack a plan exactly within a budget, and keep it where more is proved of it than of the one kept.

        Raises
        ------
        OutOfBudget : the user interrupted the attack; what it had proved counts.
        """
        result = self.adversary.attack(plan, budget)
        self.evaluations += result.evaluations
        if result.lower > self.lower:
            self.elements, self.lower, self.worst_case = plan.copy(), result.lower, result
        if result.stop not in {Stop.CLOSED, Stop.EXHAUSTED}:
            self.unproved_stop = result.stop
        self.adversary.heed(result)
