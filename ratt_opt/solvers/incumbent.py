"""The best plan known so far, with its exact worst case."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.attackers.bounded_rational import bounded_rational_attack
from ratt_opt.attackers.exact import worst_case_attack
from ratt_opt.attackers.greedy import greedy_attack
from ratt_opt.solvers.baselines import greedy, myopic
from ratt_opt.solvers.ratt import ratt

if TYPE_CHECKING:
    from ratt_opt._validation import FloatArray, IntArray
    from ratt_opt.attackers.result import AttackResult
    from ratt_opt.problem import Attack, Problem
    from ratt_opt.solvers.outcome_pool import OutcomePool

__all__ = ["Incumbent"]

LOCAL_SEARCH_ROUNDS = 50


class Incumbent:
    """Plans are screened against the known outcomes, and believed only after an exact attack.

    ``lower`` is the proved worst-case value of ``elements``. Every exact attack enters the pool.
    """

    def __init__(self, problem: Problem, pool: OutcomePool, attack_time: float | None) -> None:
        self.problem = problem
        self.pool = pool
        self.elements: IntArray = ratt(problem).elements
        self.lower = -np.inf
        self.evaluations = 0
        self._attack_time = attack_time
        self._tried: set[bytes] = set()

    def start(self) -> None:
        """Improve the most promising of RATT's, the greedy and the myopic plan, then try what these plans are worth."""
        plans = [planner(self.problem).elements for planner in (ratt, greedy, myopic)]
        for plan in plans:
            self._quick_attack(plan)
        self.improve(max(plans, key=self.pool.plan_value))
        for plan in plans:
            self.offer(plan)

    def offer(self, plan: IntArray) -> bool:
        """Attack a plan that is better on the known outcomes; return whether it became the incumbent."""
        key = plan.tobytes()
        if key in self._tried or self.pool.plan_value(plan) <= self.lower:
            return False
        self._tried.add(key)
        if self._quick_attack(plan) <= self.lower:
            return False
        result = self.attack(plan)
        if result.lower > self.lower:
            self.lower, self.elements = result.lower, plan.copy()
            return True
        return False

    def attack(self, plan: IntArray) -> AttackResult:
        """Exact worst case of a plan; its outcome is remembered."""
        result = worst_case_attack(self.problem, plan, time_limit=self._attack_time)
        self.evaluations += result.evaluations
        self.pool.add(result.attack)
        return result

    def _quick_attack(self, plan: IntArray) -> float:
        """Value that an attack found in a single node leaves, and remember its outcome.

        In large teams this attack is nearly the worst one at a hundredth of the cost, so the exact attack,
        which alone makes an incumbent, is kept for the plans that withstand this one.
        """
        result = worst_case_attack(self.problem, plan, max_nodes=1, time_limit=self._attack_time)
        self.evaluations += result.evaluations
        self.pool.add(result.attack)
        return result.upper

    def attack_relaxed(self, of_robot: FloatArray) -> list[Attack]:
        """Attacks on a relaxed plan, whose robots contribute ``of_robot`` (N, M, d, d), as if it were a plan."""
        objective, problem = self.pool.objective, self.problem
        n_robots = problem.n_robots
        relaxed = replace(
            problem,
            objective=type(objective)(objective.prior, of_robot, objective.weights),
            robot=np.arange(n_robots),
        )
        plan = np.arange(n_robots)
        return [attacker(relaxed, plan).attack for attacker in (greedy_attack, bounded_rational_attack)]

    def improve(self, plan: IntArray | None = None) -> None:
        """Local search from a plan (the incumbent by default): best single-robot change, while that helps.

        Steps are judged by the known outcomes and a cheap attack on each. Where no step is left the plan is
        attacked in earnest, first quickly and then exactly, and the search goes on against what that adds.
        """
        current = self.elements if plan is None else plan
        for _ in range(LOCAL_SEARCH_ROUNDS):
            candidate = self._best_swap(current)
            if candidate is not None:
                self.pool.add(bounded_rational_attack(self.problem, candidate).attack)
                current = candidate
                continue
            known = len(self.pool.attacks)
            self._quick_attack(current)
            if len(self.pool.attacks) == known:
                self.offer(current)
            if len(self.pool.attacks) == known:
                return
        self.offer(current)

    def _best_swap(self, plan: IntArray) -> IntArray | None:
        """The single-robot change with the largest value on the known outcomes, if it beats the plan's."""
        objective, pool = self.pool.objective, self.pool
        points = pool.group_points(objective.information[plan])
        base = objective.value(points)
        best, best_value = None, pool.plan_value(plan)
        for i, choice in enumerate(self.problem.choices):
            rows = np.flatnonzero(pool.membership()[:, i])
            others = choice[choice != plan[i]]
            if not len(others) or not len(rows):
                continue
            change = objective.information[others] - objective.information[plan[i]]
            values = np.repeat(base[None], len(others), axis=0)
            values[:, rows] = objective.value(points[rows][None] + change[:, None])
            worst = pool.outcome_values(values).min(axis=1)
            k = int(worst.argmax())
            if worst[k] > best_value * (1 + 1e-12):
                best, best_value = plan.copy(), float(worst[k])
                best[i] = others[k]
        return best
