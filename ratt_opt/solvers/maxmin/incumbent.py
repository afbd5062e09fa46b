"""The best plan known so far: found by local search, judged by known outcomes and quick attacks, proved in the end."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.budget import Stop
from ratt_opt.problem import Attack
from ratt_opt.solvers.maxmin.adversary import Adversary
from ratt_opt.solvers.maxmin.candidates import Candidates, climb
from ratt_opt.solvers.maxmin.outcome_pool import OutcomePool
from ratt_opt.solvers.maxmin.params import or_default

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Sequence

    from ratt_opt._validation import IntArray
    from ratt_opt.attack.task import AttackResult
    from ratt_opt.budget import Budget
    from ratt_opt.problem import Problem
    from ratt_opt.solvers.maxmin.params import MaxMinParams

__all__ = ["PROVED", "Incumbent", "ProvedPlan", "break_ties"]

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
        self._rivals: set[bytes] = set()

    @property
    def is_proved(self) -> bool:
        """True if the best plan's value is proved."""
        level = self.candidates.level
        return self.proved.lower >= level - PROVED * abs(level) - self.problem.objective.rounding

    def start(self, plans: Sequence[IntArray]) -> None:
        """Attack the first of some plans, improve the most promising one, beat all of them, and attack the best one.

        Whatever ends the rest, what the first attack proved is kept, and what is known of the others at once: it can be
        more if time is short.
        """
        self.proved.attack(plans[0], self._first_part())
        for plan in plans[1:]:
            self.proved.evaluate_quickly(plan, self.budget)
        if self.budget.is_over:
            return
        for plan in plans:
            self.adversary.learn(plan)
        self.improve(max(plans, key=self.pool.plan_value))
        for plan in plans:
            self.offer(plan)
        is_new = not np.array_equal(self.candidates.best, plans[0])
        if is_new and not self.is_proved and not self.budget.is_over:
            self.proved.attack(self.candidates.best, self._first_part())

    def _first_part(self) -> Budget:
        seconds = min(self._shares.first_seconds, self._shares.short * self.budget.seconds_left)
        if self.adversary.on_network and np.isfinite(seconds):
            return self.budget.part(self._shares.first_on_network, at_least=seconds)
        return self.budget.part(self._shares.first, max_nodes=self._shares.first_nodes, at_least=seconds)

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
            current = climb(self.problem, self.pool, current, part)
            known = len(self.pool)
            if not self.adversary.learn(current):
                self.offer(current, part)
            if len(self.pool) == known:
                return

    def prove(self) -> bool:
        """Attack the best plan exactly in the time left; return whether the search can go on with what was learnt.

        If the attacks at the start proved more of another plan, that one is attacked once more before. On networks
        the first plan and the best one are for a while, and then the one of which more is proved.
        """
        if self.is_proved or self.budget.stop() not in {None, Stop.NODES}:
            return False
        level, best = self.candidates.level, self.candidates.best
        for plan, share in self._contenders():
            aim = self._aim() if plan is best else -np.inf
            self.proved.attack(plan, self.budget.part(share), aim)
            # Where several plans are worth the same, the level stays as the first of them falls.
            if self.is_proved or self.candidates.level < level or self.candidates.best is not best:
                return True
        return False

    def _contenders(self) -> Iterator[tuple[IntArray, float]]:
        """Plans to attack one after the other, the best one last, and the shares of the time left for them."""
        best, rival = self.candidates.best, self._rival()
        if rival is not None:
            self._rivals.add(rival.tobytes())
            if self.adversary.on_network:
                yield rival, self._shares.race
                yield best, self._shares.race
                if np.array_equal(self.proved.elements, rival):
                    yield rival, 1.0
            else:
                yield rival, self._shares.rival
        yield best, 1.0

    def _aim(self) -> float:
        """Return the value of the best plan under attack at which a search for other plans comes before its proof."""
        limit, level = self.budget.time_limit, self.candidates.level
        if not self.adversary.on_network or limit is None or self.budget.elapsed > self._shares.early * limit:
            return -np.inf
        return level - self._shares.left_early * (level - self.proved.lower)

    def _rival(self) -> IntArray | None:
        """The plan of which most is proved, unless it is the best one, was a rival, or no more is to be proved of it.

        On networks the first plan. None without a time limit: then the proof of the best one comes to its end.
        """
        on_network, is_limited = self.adversary.on_network, np.isfinite(self.budget.seconds_left)
        plan = self.candidates.first if on_network else self.proved.elements
        was_rival = plan.tobytes() in self._rivals and not on_network
        if was_rival or not is_limited or np.array_equal(plan, self.candidates.best):
            return None
        is_open = self.pool.plan_value(plan) > self.proved.lower * (1 + PROVED) + self.problem.objective.rounding
        return plan if is_open else None


NO_MORE = 1e-9
"""Relative difference of values without attack that counts as none."""


def break_ties(incumbent: Incumbent, budget: Budget) -> None:
    """Exchange elements of the proved plan while its worst case stays as it is and its value without attack rises.

    The new plan is attacked exactly, and kept only if as much is proved of it.

    Raises ``OutOfBudget`` : the user interrupted the attack; the old plan stays.
    """
    params, proved = incumbent.params.ties, incumbent.proved
    part = budget.part(params.share)
    for _ in range(params.rounds):
        plan = _richer(incumbent, proved.elements, part)
        if np.array_equal(plan, proved.elements) or part.is_over:
            return
        tied = ProvedPlan(incumbent.adversary, plan)
        tied.attack(plan, part.part(max_nodes=params.nodes))
        tied.evaluations += proved.evaluations
        if tied.worst_case is not None and tied.lower >= proved.lower - PROVED * abs(proved.lower):
            incumbent.proved = tied
            return


def _richer(incumbent: Incumbent, plan: IntArray, budget: Budget) -> IntArray:
    """A plan of no smaller value under the known outcomes that no exchange makes worth more without attack."""
    problem, pool, limit = incumbent.problem, incumbent.pool, incumbent.problem.choice_limit
    rounding, unattacked = problem.objective.rounding, OutcomePool(problem)
    unattacked.add(Attack())
    least = min(incumbent.proved.lower, pool.plan_value(plan))
    least -= PROVED * abs(least) + rounding
    best, current = unattacked.plan_value(plan), plan.copy()
    improved = True
    while improved:
        improved = False
        for i, choice in enumerate(problem.choices):
            for e in choice.tolist():
                if budget.is_over:
                    return current
                other = current.copy()
                other[i] = e
                if limit is not None and not limit.allows(other):
                    continue
                value = unattacked.plan_value(other)
                if value > best + NO_MORE * abs(best) + rounding and pool.plan_value(other) >= least:
                    best, current, improved = value, other, True
    return current
