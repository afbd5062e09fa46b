"""Attacks on plans, whose outcomes enter the pool."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.attackers.exact import worst_case_attack
from ratt_opt.attackers.heuristics.bounded_rational import bounded_rational_attack
from ratt_opt.attackers.heuristics.greedy import greedy_attack
from ratt_opt.budget import Budget, OutOfBudget
from ratt_opt.solvers.maxmin.plans.lasting_attack import LastingAttacks
from ratt_opt.stopping import Stop

if TYPE_CHECKING:
    from ratt_opt._validation import FloatArray, IntArray
    from ratt_opt.attackers.result import AttackResult
    from ratt_opt.problem import Attack, Problem
    from ratt_opt.solvers.maxmin.plans.outcome_pool import OutcomePool

__all__ = ["Adversary"]

SEARCHED_BY_SIZE = 12
"""Larger teams with all links alike are attacked by exchanges first (``by_size``): fast and hardly ever wrong."""
SAME_VALUE = 1e-12
"""Relative difference of team values under two attacks that counts as none."""


class Adversary:
    """Attacks one problem's plans, quickly or exactly; every outcome enters the pool.

    Raises
    ------
    OutOfBudget : the user interrupted an attack; its outcome has entered the pool.
    """

    def __init__(self, problem: Problem, pool: OutcomePool, budget: Budget) -> None:
        self.problem, self.pool, self.budget = problem, pool, budget
        self._lasting = LastingAttacks(problem)

    @property
    def is_exact_cheaply(self) -> bool:
        """Whether an exact attack costs little, and says more than the known outcomes do."""
        return self.problem.n_robots <= SEARCHED_BY_SIZE and not self.pool.complete

    def learn(self, plan: IntArray) -> bool:
        """Attack a plan quickly, unless all outcomes are known; whether that found a new outcome."""
        known = len(self.pool.attacks)
        if not self.pool.complete:
            self._remember(self.problem, plan, self._quick_attack(self.problem, plan))
        return len(self.pool.attacks) > known

    def learn_relaxed(self, of_robot: FloatArray) -> bool:
        """The same for a relaxed plan, as if it were one: its robots contribute ``of_robot`` (N, M, d, d)."""
        known = len(self.pool.attacks)
        owners = np.arange(self.problem.n_robots)
        objective = self.pool.objective.with_information(of_robot)
        relaxed = replace(self.problem, objective=objective, robot=owners)
        if len(owners) <= SEARCHED_BY_SIZE:
            self.pool.add(greedy_attack(relaxed, owners).attack)
        self._remember(relaxed, owners, self._quick_attack(relaxed, owners))
        return len(self.pool.attacks) > known

    def attack(self, plan: IntArray, budget: Budget) -> AttackResult:
        """Exact worst case of a plan within a part of the budget."""
        result = worst_case_attack(self.problem, plan, max_nodes=budget.max_nodes, budget=budget)
        self._remember(self.problem, plan, result.attack)
        return result

    def heed(self, result: AttackResult) -> None:
        """Stop the search where the user interrupted an attack, once what the attack proved is kept."""
        if result.stop is Stop.INTERRUPTED:
            raise OutOfBudget(self.budget.interrupt())

    def _remember(self, problem: Problem, plan: IntArray, attack: Attack) -> None:
        """Add an attack on a plan to the pool; the lasting one in its place where that hurts this plan as much."""
        lasting = self._lasting.of(attack)
        self.pool.add(lasting)
        value = problem.team_value(plan, attack)
        if problem.team_value(plan, lasting) > value + SAME_VALUE * abs(value):
            self.pool.add(attack)

    def _quick_attack(self, problem: Problem, plan: IntArray) -> Attack:
        if problem.n_robots <= SEARCHED_BY_SIZE:
            return bounded_rational_attack(problem, plan).attack
        if not problem.threat.links_alike:
            return greedy_attack(problem, plan).attack
        found = worst_case_attack(problem, plan, max_nodes=0, budget=self.budget)
        self.heed(found)
        return found.attack
