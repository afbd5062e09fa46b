"""The best plan known so far, and the best one whose worst case is proved."""

from __future__ import annotations

import heapq
import time
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.attackers.exact import worst_case_attack
from ratt_opt.attackers.heuristics.bounded_rational import bounded_rational_attack
from ratt_opt.attackers.heuristics.greedy import greedy_attack
from ratt_opt.solvers.baselines import greedy, myopic
from ratt_opt.solvers.local_search import climb
from ratt_opt.solvers.maxmin.lasting_attack import LastingAttacks
from ratt_opt.solvers.ratt import ratt
from ratt_opt.stopping import Stop

if TYPE_CHECKING:
    from ratt_opt._validation import FloatArray, IntArray
    from ratt_opt.attackers.result import AttackResult
    from ratt_opt.problem import Attack, Problem
    from ratt_opt.solvers.maxmin.outcome_pool import OutcomePool

__all__ = ["PROVED", "Incumbent"]

LOCAL_SEARCH_ROUNDS = 50
SEARCHED_BY_SIZE = 12
"""Larger teams with all links alike are attacked by exchanges first (``by_size``): fast and hardly ever wrong."""
FIRST_PROOF, FIRST_SHARE = 500_000, 0.1
"""Nodes, and share of the time, spent at once on a first lower bound for a large team."""
SEARCH_SHARE = 0.25
"""Share of the time left that is searched before an unproved plan is attacked exactly."""
PROVED = 2e-10
"""Relative difference between a plan's known and its proved value that counts as none."""


class Incumbent:
    """Plans are judged by the known outcomes and a quick attack; the best of them is attacked exactly in the end.

    ``level`` is the value of ``best`` under the known outcomes: no plan of a smaller bound is worth looking for. A new
    outcome may lower it; then another of the plans offered may become ``best``. ``lower`` is the proved worst-case
    value of ``elements``. Every attack enters the pool.
    """

    def __init__(self, problem: Problem, pool: OutcomePool, deadline: float | None) -> None:
        self.problem, self.pool = problem, pool
        self.elements: IntArray = ratt(problem).elements
        self.lower = problem.objective([])  # whatever the plan
        self.worst_case: AttackResult | None = None
        self.evaluations = 0
        self.unproved_stop = Stop.HEURISTIC
        """Why the last exact attack that did not close stopped."""
        self._lasting = LastingAttacks(problem)
        self._candidates: list[tuple[float, int, int, IntArray]] = []
        self._deadline = deadline
        self._began = time.monotonic()
        self._tried: set[bytes] = set()
        self._started: set[bytes] = set()

    # -- the best plan -----------------------------------------------------------------------------------------

    @property
    def level(self) -> float:
        """Value of :attr:`best` under all known outcomes."""
        return -self._top()[0]

    @property
    def best(self) -> IntArray:
        """The plan of largest value under all known outcomes; the first offered among equals."""
        return self._top()[3]

    def _top(self) -> tuple[float, int, int, IntArray]:
        """The best candidate; a stored value is out of date, and too large, where outcomes were found since."""
        known = len(self.pool.attacks)
        while self._candidates and self._candidates[0][2] < known:
            _, serial, _, plan = self._candidates[0]
            heapq.heapreplace(self._candidates, (-self.pool.plan_value(plan), serial, known, plan))
        return self._candidates[0] if self._candidates else (np.inf, 0, known, self.elements)

    def start(self, *more: IntArray) -> None:
        """Improve the most promising of RATT's, the greedy, the myopic and ``more`` plans, and beat all of them."""
        plans = [*(planner(self.problem).elements for planner in (ratt, greedy, myopic)), *more]
        for plan in plans:
            self._learn(plan)
        self.improve(max(plans, key=self.pool.plan_value))
        for plan in plans:
            self.offer(plan)
        left = None if self._deadline is None else FIRST_SHARE * max(self._deadline - time.monotonic(), 0.0)
        self._attack(self.best, time_limit=left, max_nodes=FIRST_PROOF)

    def offer(self, plan: IntArray) -> bool:
        """Attack a plan that is better on the known outcomes; return whether it became the best."""
        key = plan.tobytes()
        if key in self._tried or self.pool.plan_value(plan) <= self.level:
            return False
        self._tried.add(key)
        self._learn(plan)
        if self.pool.plan_value(plan) > self.level and self._cheap:
            self._attack(plan)
        value = self.pool.plan_value(plan)
        better = value > self.level
        heapq.heappush(self._candidates, (-value, len(self._tried), len(self.pool.attacks), plan.copy()))
        return better

    @property
    def _cheap(self) -> bool:
        """Whether an exact attack costs little, and says more than the known outcomes do."""
        return self.problem.n_robots <= SEARCHED_BY_SIZE and not self.pool.complete

    def improve(self, plan: IntArray) -> None:
        """Local search from a plan, judged by the known outcomes.

        Only where no step is left the plan is attacked, and the search goes on against what that attack adds.
        """
        if (key := plan.tobytes()) in self._started:
            return
        self._started.add(key)
        current = plan
        for _ in range(LOCAL_SEARCH_ROUNDS):
            current = climb(self.problem, self.pool, current)
            known = len(self.pool.attacks)
            self._learn(current)
            if len(self.pool.attacks) == known:
                self.offer(current)
            if len(self.pool.attacks) == known:
                return

    # -- proof of its value ------------------------------------------------------------------------------------

    @property
    def proved(self) -> bool:
        """Whether the best plan's value is proved."""
        return self.lower >= self.level - PROVED * abs(self.level)

    @property
    def out_of_time(self) -> bool:
        """Whether it is time to stop the search: for good, or to prove the best plan's value."""
        if self._deadline is None:
            return False
        now = time.monotonic()
        pause = self._began + SEARCH_SHARE * (self._deadline - self._began)
        return now >= self._deadline or (now >= pause and not self.proved)

    def prove(self) -> bool:
        """Attack the best plan exactly in the time left; return whether the search can go on with what was learnt."""
        left = None if self._deadline is None else self._deadline - time.monotonic()
        if self.proved or (left is not None and left <= 0):
            return False
        level = self.level
        self._attack(self.best, time_limit=left)
        self._began = time.monotonic()
        return self.proved or self.level < level

    def _attack(self, plan: IntArray, *, time_limit: float | None = None, max_nodes: int | None = None) -> None:
        """Exact worst case of a plan within limits; what it proves and its outcome are remembered.

        Raises
        ------
        KeyboardInterrupt : the user interrupted the attack; what it had proved counts.
        """
        result = worst_case_attack(self.problem, plan, time_limit=time_limit, max_nodes=max_nodes)
        self.evaluations += result.evaluations
        self._remember(self.problem, plan, result.attack)
        if result.lower > self.lower:
            self.elements, self.lower, self.worst_case = plan.copy(), result.lower, result
        if result.stop not in {Stop.CLOSED, Stop.EXHAUSTED}:
            self.unproved_stop = result.stop
        if result.stop is Stop.INTERRUPTED:
            raise KeyboardInterrupt

    def _learn(self, plan: IntArray) -> None:
        """Add a quick attack's outcome to the known ones, unless all are known."""
        if not self.pool.complete:
            self._remember(self.problem, plan, self._quick_attack(self.problem, plan))

    def _remember(self, problem: Problem, plan: IntArray, attack: Attack) -> None:
        """Add an attack on a plan to the pool; the lasting one in its place where that hurts this plan as much."""
        lasting = self._lasting.of(attack)
        self.pool.add(lasting)
        value = problem.team_value(plan, attack)
        if problem.team_value(plan, lasting) > value + 1e-12 * abs(value):
            self.pool.add(attack)

    def _quick_attack(self, problem: Problem, plan: IntArray) -> Attack:
        if problem.n_robots <= SEARCHED_BY_SIZE:
            return bounded_rational_attack(problem, plan).attack
        if problem.threat.links_alike:
            return worst_case_attack(problem, plan, max_nodes=0).attack
        return greedy_attack(problem, plan).attack

    def attack_relaxed(self, of_robot: FloatArray) -> None:
        """Attack a relaxed plan, whose robots contribute ``of_robot`` (N, M, d, d), as if it were a plan."""
        objective, problem = self.pool.objective, self.problem
        n_robots = problem.n_robots
        relaxed = replace(
            problem,
            objective=type(objective)(objective.prior, of_robot, objective.weights),
            robot=np.arange(n_robots),
        )
        plan = np.arange(n_robots)
        if n_robots <= SEARCHED_BY_SIZE:
            self.pool.add(greedy_attack(relaxed, plan).attack)
        self._remember(relaxed, plan, self._quick_attack(relaxed, plan))
