"""Better plans if few robots may choose: one chooses another element, or rests while another one chooses.

A neighbour of the plan is judged by the attacks met so far. If it seems better, it is attacked exactly, and that attack
is known from then on: what seemed better once does not seem so again.
"""

from __future__ import annotations

from contextlib import suppress
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.attack.exact import worst_case_attack
from ratt_opt.budget import Budget, OutOfBudget

if TYPE_CHECKING:
    from collections.abc import Iterable

    from ratt_opt._validation import FloatArray, IntArray
    from ratt_opt.attack.task import AttackResult
    from ratt_opt.problem import Problem

__all__ = ["FewRobotsSearch"]


@dataclass(slots=True)
class FewRobotsSearch:
    """Exchanges from the best of some plans; ``elements`` and ``worst_case`` are the best so far."""

    problem: Problem
    budget: Budget
    elements: IntArray = field(init=False)
    worst_case: AttackResult = field(init=False)
    evaluations: int = 0
    _families: dict[frozenset[frozenset[int]], None] = field(default_factory=dict)

    def run(self, starts: Iterable[IntArray]) -> None:
        """Exchange until nothing seems better, or the budget is spent."""
        plans = [self.problem.check_plan(plan) for plan in starts]
        found = [self._attack(plan) for plan in plans]
        k = max(range(len(plans)), key=lambda i: found[i].lower)
        self.elements, self.worst_case = plans[k], found[k]
        with suppress(OutOfBudget):
            while self._improve():
                pass

    def _attack(self, plan: IntArray) -> AttackResult:
        found = worst_case_attack(self.problem, plan, budget=self.budget.part())
        self._families.setdefault(frozenset(self.problem.groups_left(found.attack)))
        return found

    def _improve(self) -> bool:
        """Take the first neighbour whose worst case is better, best ones by the known attacks first; tell if it did."""
        neighbours = self._neighbours()
        while len(neighbours):
            self.budget.check()
            values = self._values(neighbours)
            best = int(values.argmax())
            least = self.worst_case.lower + self.problem.objective.least_improvement(self.worst_case.lower)
            if values[best] <= least:
                return False
            found = self._attack(neighbours[best])
            if found.lower > least:
                self.elements, self.worst_case = neighbours[best], found
                return True
            neighbours = np.delete(neighbours, best, axis=0)
        return False

    def _neighbours(self) -> IntArray:
        """(K, N) plans that differ in one choice, or in who rests."""
        problem, idle = self.problem, self.problem.idle
        busy = np.flatnonzero(self.elements != idle)
        found: list[IntArray] = []
        room = len(busy) < (problem.at_most or 0)
        for e in np.setdiff1d(np.arange(problem.objective.n), idle).tolist():
            i = int(problem.robot[e])
            if self.elements[i] == e:
                continue
            resting = [None] if self.elements[i] != idle[i] or room else busy.tolist()
            for j in resting:
                plan = self.elements.copy()
                if j is not None:
                    plan[j] = idle[j]
                plan[i] = e
                found.append(plan)
        return np.array(found, dtype=np.int64).reshape(len(found), problem.n_robots)

    def _values(self, plans: IntArray) -> FloatArray:
        """(K,) values of plans under the worst of the known attacks."""
        worst = np.full(len(plans), np.inf)
        for family in self._families:
            best = np.full(len(plans), -np.inf)
            for group in family:
                self.budget.check()
                membership = np.zeros((len(plans), self.problem.objective.n), dtype=np.bool_)
                members = sorted(group)
                membership[np.arange(len(plans))[:, None], plans[:, members]] = True
                best = np.maximum(best, self.problem.objective.evaluate(membership))
                self.evaluations += len(plans)
            worst = np.minimum(worst, best)
        return worst
