"""Plans improved element by element against the attacks known so far."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ratt_opt.attackers.any_function import metered_problem
from ratt_opt.budget import OutOfBudget

if TYPE_CHECKING:
    from ratt_opt._validation import IntArray
    from ratt_opt.budget import Budget
    from ratt_opt.problem import Problem
    from ratt_opt.solvers.by_values.plan_attacks import PlanAttacks

__all__ = ["Climbing"]

MOST_KEPT = 500_000
"""Stored values, some hundred megabytes at most; others are computed again."""


class Climbing:
    """Values of sets of elements, kept from plan to plan; what the known attacks leave of a plan; climbs."""

    def __init__(self, problem: Problem, attacks: PlanAttacks, budget: Budget) -> None:
        self._problem, self._attacks, self._budget = problem, attacks, budget
        self._known: dict[frozenset[int], float] = {}
        self._asked = attacks.problem.objective

    def climbed(self, elements: IntArray, part: Budget) -> IntArray:
        """Change one robot's element at a time while the known attacks leave more, within a part of the budget."""
        self._asked = metered_problem(self._attacks.problem, part).objective
        current = elements.copy()
        try:
            value, unchanged, i = self._value(elements), 0, 0
            while unchanged < len(current):
                unchanged += 1
                for e in self._problem.choices[i]:
                    other = current.copy()
                    other[i] = e
                    least = value + self._problem.objective.least_improvement(value)
                    if e != current[i] and (better := self._value(other)) > least:
                        current, value, unchanged = other, better, 0
                i = (i + 1) % len(current)
        except OutOfBudget:
            self._budget.check()
        self._asked = self._attacks.problem.objective
        return current

    def worth(self, elements: frozenset[int]) -> float:
        """Value of a set of elements, within the part of the budget that is being spent."""
        if elements not in self._known:
            if len(self._known) > MOST_KEPT:
                self._known.clear()
            self._known[elements] = self._asked(elements)
        return self._known[elements]

    def _value(self, elements: IntArray) -> float:
        """What the known attacks leave of a plan."""
        return min(max(self._group(elements, group) for group in groups) for groups in self._attacks.known.values())

    def _group(self, elements: IntArray, group: frozenset[int]) -> float:
        return self.worth(frozenset(elements[sorted(group)].tolist()))
