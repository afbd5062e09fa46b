"""The best plan known so far, with its exact worst case."""

from __future__ import annotations

import time
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.attackers.bounded_rational import bounded_rational_attack
from ratt_opt.attackers.exact import worst_case_attack
from ratt_opt.attackers.greedy import greedy_attack
from ratt_opt.solvers.baselines import greedy, myopic
from ratt_opt.solvers.ratt import ratt
from ratt_opt.stopping import Stop

if TYPE_CHECKING:
    from ratt_opt._validation import FloatArray, IntArray
    from ratt_opt.attackers.result import AttackResult
    from ratt_opt.problem import Attack, Problem
    from ratt_opt.solvers.outcome_pool import OutcomePool

__all__ = ["Incumbent"]

LOCAL_SEARCH_ROUNDS = 50
ATTACK_SHARE = 0.25
"""Share of the time left that one exact attack may take."""
SEARCHED_BY_SIZE = 12
"""Larger teams with all links alike are attacked by exchanges first (``attackers/large_team.py``): fast and hardly
ever wrong."""


class Incumbent:
    """Plans are screened against the known outcomes and a quick attack, and believed only after an exact one.

    ``lower`` is the proved worst-case value of ``elements``. ``level`` is the value that the best plan has under
    the worst attack found, proved or not: no plan of a smaller bound is worth looking for. The two
    differ only where an exact attack did not close (``attack_stop`` says why). Every attack enters the pool.
    """

    def __init__(self, problem: Problem, pool: OutcomePool, deadline: float | None) -> None:
        self.problem = problem
        self.pool = pool
        self.elements: IntArray = ratt(problem).elements
        self.lower = -np.inf
        self.level = -np.inf
        self.evaluations = 0
        self.attack_stop = Stop.HEURISTIC
        self._best: IntArray = self.elements
        self._deadline = deadline
        self._tried: set[bytes] = set()
        self._started: set[bytes] = set()

    def start(self) -> None:
        """Improve the most promising of RATT's, the greedy and the myopic plan by local search, and beat all three."""
        plans = [planner(self.problem).elements for planner in (ratt, greedy, myopic)]
        for plan in plans:
            self.pool.add(self._quick_attack(self.problem, plan))
        self.improve(max(plans, key=self.pool.plan_value))
        for plan in plans:
            self.offer(plan)

    def offer(self, plan: IntArray) -> bool:
        """Attack a plan that is better on the known outcomes; return whether it became the best."""
        key = plan.tobytes()
        if key in self._tried or self.pool.plan_value(plan) <= self.level:
            return False
        self._tried.add(key)
        self.pool.add(self._quick_attack(self.problem, plan))
        if self.pool.plan_value(plan) <= self.level:
            return False
        result = self.attack(plan)
        if result.upper > self.level:
            self.level, self._best = result.upper, plan.copy()
            return True
        return False

    def attack(self, plan: IntArray, share: float = ATTACK_SHARE) -> AttackResult:
        """Exact worst case of a plan, as far as time allows; what it proves and its outcome are remembered.

        Raises
        ------
        KeyboardInterrupt : the user interrupted the attack; what it had proved counts.
        """
        left = None if self._deadline is None else max(share * (self._deadline - time.monotonic()), 0.0)
        result = worst_case_attack(self.problem, plan, time_limit=left)
        self.evaluations += result.evaluations
        self.pool.add(result.attack)
        if result.lower > self.lower:
            self.elements, self.lower, self.attack_stop = plan.copy(), result.lower, result.stop
        if result.stop is Stop.INTERRUPTED:
            raise KeyboardInterrupt
        return result

    def prove(self) -> None:
        """Spend the time left on proving the best plan's value, where an exact attack was cut short."""
        if self._deadline is not None and self.lower < self.level * (1 - 1e-9) and time.monotonic() < self._deadline:
            self.attack(self._best, share=1.0)

    def _quick_attack(self, problem: Problem, plan: IntArray) -> Attack:
        if problem.n_robots <= SEARCHED_BY_SIZE:
            return bounded_rational_attack(problem, plan).attack
        if problem.threat.links_alike:
            return worst_case_attack(problem, plan, max_nodes=0).attack
        return greedy_attack(problem, plan).attack

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
        if n_robots <= SEARCHED_BY_SIZE:
            return [greedy_attack(relaxed, plan).attack, bounded_rational_attack(relaxed, plan).attack]
        return [self._quick_attack(relaxed, plan)]

    def improve(self, plan: IntArray) -> None:
        """Local search from a plan: the best change of one robot after the other, while that helps.

        Steps are judged by the known outcomes; only where none is left the plan is attacked,
        and the search goes on against what that attack adds.
        """
        current = plan
        if (key := plan.tobytes()) in self._started:
            return
        self._started.add(key)
        for _ in range(LOCAL_SEARCH_ROUNDS):
            current = self._climb(current)
            known = len(self.pool.attacks)
            self.pool.add(self._quick_attack(self.problem, current))
            if len(self.pool.attacks) == known:
                self.offer(current)
            if len(self.pool.attacks) == known:
                return

    def _climb(self, plan: IntArray) -> IntArray:
        """Pass over the robots, each taking the element of largest value on the known outcomes, until none changes."""
        objective, pool = self.pool.objective, self.pool
        current = plan.copy()
        points = pool.group_points(objective.information[current])
        base = objective.value(points)
        value = float(pool.outcome_values(base).min(initial=np.inf))
        unchanged, i = 0, 0
        while unchanged < self.problem.n_robots:
            choice = self.problem.choices[i]
            rows = np.flatnonzero(pool.membership()[:, i])
            others = choice[choice != current[i]]
            unchanged += 1
            if len(others) and len(rows):
                change = objective.information[others] - objective.information[current[i]]
                values = np.repeat(base[None], len(others), axis=0)
                values[:, rows] = objective.value(points[rows][None] + change[:, None])
                worst = pool.outcome_values(values).min(axis=1)
                k = int(worst.argmax())
                if worst[k] > value * (1 + 1e-12):
                    current[i], value, base = others[k], float(worst[k]), values[k]
                    points[rows] += change[k]
                    unchanged = 0
            i = (i + 1) % self.problem.n_robots
        return current
