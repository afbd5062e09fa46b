"""The best plan known so far: found by local search, judged by known outcomes and quick attacks, proved in the end."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.budget import Stop
from ratt_opt.solvers.maxmin.adversary import Adversary
from ratt_opt.solvers.maxmin.candidates import Candidates, climb
from ratt_opt.solvers.maxmin.params import or_default

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from ratt_opt._validation import IntArray
    from ratt_opt.attack.task import AttackResult
    from ratt_opt.budget import Budget
    from ratt_opt.problem import Problem
    from ratt_opt.solvers.maxmin.outcome_pool import OutcomePool
    from ratt_opt.solvers.maxmin.params import MaxMinParams

__all__ = ["PROVED", "Incumbent", "ProvedPlan"]

PROVED = 2e-10
"""Relative difference between a plan's known and its proved value that counts as none. The search leaves it out of its
own gap, so that both together stay within 1e-9, the smallest gap that a caller may set."""


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

    def attack(self, plan: IntArray, budget: Budget, aim: float = -np.inf) -> None:
        """Attack a plan exactly within a budget, and keep it if more is proved of it than of the one kept.

        An attack that leaves it no more than that, or than ``aim``, ends it: it is of no use then.

        Raises ``OutOfBudget`` : the user interrupted the attack; what it had proved counts.
        """
        result = self.adversary.attack(plan, budget, max(self.lower, aim))
        self._keep(plan, result)
        if result.stop not in {Stop.CLOSED, Stop.EXHAUSTED, Stop.GAP}:
            self.unproved_stop = result.stop
        self.adversary.raise_if_interrupted(result)

    def evaluate_quickly(self, plan: IntArray, budget: Budget) -> None:
        """Keep a plan if more is known of it at once than is proved of the one kept.

        The attack that comes with it teaches nothing: of the outcomes a search begins with, these are not the worst.

        Raises ``OutOfBudget`` : the user interrupted it; what was known counts.
        """
        result = self.adversary.evaluate_quickly(plan, budget)
        self._keep(plan, result)
        self.adversary.raise_if_interrupted(result)

    def _keep(self, plan: IntArray, result: AttackResult) -> None:
        self.evaluations += result.evaluations
        if result.lower > self.lower:
            self.elements, self.lower, self.worst_case = plan.copy(), result.lower, result


class Incumbent:
    """Plans are offered and improved as candidates; the best of them is attacked exactly in the end.

    ``params`` : of the search
    """

    def __init__(
        self,
        problem: Problem,
        pool: OutcomePool,
        first: IntArray,
        budget: Budget,
        params: MaxMinParams | None = None,
    ) -> None:
        self.problem, self.pool, self.budget = problem, pool, budget
        self.params = or_default(params)
        self._shares = self.params.incumbent
        self.candidates = Candidates(pool, first)
        self.adversary = Adversary(problem, pool, budget, self.params.adversary)
        self.proved = ProvedPlan(self.adversary, first)
        self.on_improvement: Callable[[IntArray], object] | None = None
        """Called with each plan that becomes the best."""
        self._started: set[bytes] = set()
        self.rivals: set[bytes] = set()
        """Plans that were attacked once more before the best one (``stages/proof.py``)."""

    @property
    def is_proved(self) -> bool:
        """True if the best plan's value is proved."""
        level = self.candidates.level
        return self.proved.lower >= level - PROVED * abs(level) - self.problem.objective.rounding

    def meet(self, plans: Sequence[IntArray]) -> None:
        """Attack some plans quickly, improve the most promising one, and offer the others."""
        for plan in plans:
            self.adversary.learn(plan)
        self.improve(max(plans, key=self.pool.plan_value))
        for plan in plans:
            self.offer(plan)

    def offer(self, plan: IntArray, part: Budget | None = None) -> bool:
        """Attack a plan that is better on the known outcomes; return whether it became the best.

        ``part`` : of the budget, for attacking it again and again; by default as for :meth:`improve`
        """
        if self.budget.is_over or not self.candidates.is_better(plan) or not self.candidates.meet(plan):
            return False
        part = self.budget.part(self._shares.improved) if part is None else part
        while self.adversary.learn(plan) and self.candidates.is_better(plan) and not part.is_over:
            pass  # what was learnt may be weaker than what there is to learn
        if self.candidates.is_better(plan) and self.adversary.is_exact_cheaply:
            self.proved.attack(plan, self.budget.part())
        is_best = self.candidates.add(plan)
        if is_best and self.on_improvement is not None:
            self.on_improvement(plan)
        return is_best

    def improve(self, plan: IntArray) -> None:
        """Local search from a plan, judged by the known outcomes.

        Only if no step is left the plan is attacked, and the search goes on against what that attack adds.
        """
        if (key := plan.tobytes()) in self._started:
            return
        self._started.add(key)
        current, part = plan, self.budget.part(self._shares.improved)
        for _ in range(self._shares.rounds):
            if part.is_over:
                self.offer(current, part)
                return
            current = climb(self.pool, current, part, self._shares.block)
            known = len(self.pool)
            if not self.adversary.learn(current):
                self.offer(current, part)
            if len(self.pool) == known:
                return
