"""The best plan known so far: found by local search, judged by known outcomes and quick attacks, proved in the end."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ratt_opt.solvers.maxmin.plans.adversary import Adversary
from ratt_opt.solvers.maxmin.plans.candidates import Candidates
from ratt_opt.solvers.maxmin.plans.local_search import climb
from ratt_opt.solvers.maxmin.plans.proved_plan import ProvedPlan
from ratt_opt.stopping import Stop

if TYPE_CHECKING:
    from collections.abc import Sequence

    from ratt_opt._validation import IntArray
    from ratt_opt.budget import Budget
    from ratt_opt.problem import Problem
    from ratt_opt.solvers.maxmin.plans.outcome_pool import OutcomePool

__all__ = ["Incumbent"]

LOCAL_SEARCH_ROUNDS = 50
"""Rounds of climbing and attacking after which a plan is left as it is; a safeguard, as hardly any needs ten."""
FIRST_PROOF, FIRST_SHARE = 500_000, 0.1
"""Nodes, and share of the time, spent at once on a first lower bound for a large team."""


class Incumbent:
    """Plans are offered and improved as candidates; the best of them is attacked exactly in the end."""

    def __init__(self, problem: Problem, pool: OutcomePool, first: IntArray, budget: Budget) -> None:
        self.problem, self.pool, self.budget = problem, pool, budget
        self.candidates = Candidates(pool, first)
        self.adversary = Adversary(problem, pool, budget)
        self.proved = ProvedPlan(self.adversary, first)
        self._started: set[bytes] = set()

    @property
    def is_proved(self) -> bool:
        """Whether the best plan's value is proved."""
        return self.proved.reaches(self.candidates.level)

    def start(self, plans: Sequence[IntArray]) -> None:
        """Improve the most promising of some plans, beat all of them, and attack the best one briefly."""
        # What is known at once of the first plan: whatever interrupts the rest, the bracket is not empty.
        self.proved.attack(plans[0], self.budget.part(max_nodes=0))
        for plan in plans:
            self.adversary.learn(plan)
        self.improve(max(plans, key=self.pool.plan_value))
        for plan in plans:
            self.offer(plan)
        self.proved.attack(self.candidates.best, self.budget.part(FIRST_SHARE, max_nodes=FIRST_PROOF))

    def offer(self, plan: IntArray) -> bool:
        """Attack a plan that is better on the known outcomes; return whether it became the best."""
        if not self.candidates.is_better(plan) or not self.candidates.meet(plan):
            return False
        self.adversary.learn(plan)
        if self.candidates.is_better(plan) and self.adversary.is_exact_cheaply:
            self.proved.attack(plan, self.budget.part())
        return self.candidates.add(plan)

    def improve(self, plan: IntArray) -> None:
        """Local search from a plan, judged by the known outcomes.

        Only where no step is left the plan is attacked, and the search goes on against what that attack adds.
        """
        if (key := plan.tobytes()) in self._started:
            return
        self._started.add(key)
        current = plan
        for _ in range(LOCAL_SEARCH_ROUNDS):
            current = climb(self.problem, self.pool, current, self.budget)
            known = len(self.pool.attacks)
            if not self.adversary.learn(current):
                self.offer(current)
            if len(self.pool.attacks) == known:
                return

    def prove(self) -> bool:
        """Attack the best plan exactly in the time left; return whether the search can go on with what was learnt."""
        if self.is_proved or self.budget.stop() not in {None, Stop.NODES}:
            return False
        level = self.candidates.level
        self.proved.attack(self.candidates.best, self.budget.part())
        return self.is_proved or self.candidates.level < level
