"""Plans for any set function, known by its values alone: a bracket of any size, within any number of values.

Small problems are enumerated (``exhaustive.py``). Beyond: plans improved element by element against the attacks known
so far, which are attacked in turn; then, as long as there is time, all others by branch and bound (``plan_tree.py``),
which ends with exact attacks on those that nothing else rules out.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ratt_opt._validation import readonly
from ratt_opt.attack.task import CLOSED_WIDTH
from ratt_opt.attackers.any_function import metered_problem
from ratt_opt.budget import Budget, OutOfBudget, Stop
from ratt_opt.curvatures.domains import domain_of
from ratt_opt.curvatures.marginals import enumerate_marginals
from ratt_opt.errors import InputError
from ratt_opt.graph.outcomes import count_outcomes
from ratt_opt.setfunctions.base import TableFunction, checked_values
from ratt_opt.setfunctions.metered import unmetered
from ratt_opt.solvers.by_values.climbing import Climbing
from ratt_opt.solvers.by_values.plan_attacks import ATTACK_SHARE, PlanAttacks
from ratt_opt.solvers.by_values.plan_bounds import guarantee_bound, pooling_bound
from ratt_opt.solvers.by_values.plan_tree import PlanTree
from ratt_opt.solvers.exhaustive import exhaustive_optimum
from ratt_opt.solvers.ratt import alpha_cs_in_share, bait_and_greedy
from ratt_opt.solvers.result import MaxMinResult

if TYPE_CHECKING:
    from ratt_opt._validation import FloatArray, IntArray
    from ratt_opt.problem import Problem

__all__ = ["check_small_monotone", "search_any"]

CHECKED_SETS, CHECKED_TABLE = 2**12, 2**18
"""Feasible sets up to which a function, and one given as a table, is checked to be non-decreasing: milliseconds."""
ENUMERATION_SHARE, SINGLES_SHARE, PLAN_SHARE, CLIMB_SHARE = 0.5, 0.7, 0.3, 0.5
"""Shares of the seconds and values left: for the enumeration of a small problem, for individual values, which plans
begin with and first bounds need, for the rest of RATT's plan, and for climbing from plan to plan with attacks on each;
then those that their share ended go on. Not tuned."""
MOST_OUTCOMES = 200_000
"""Outcomes that are gone through: some seconds if plans are few."""
ROUNDS, NODES, SOON_VALUED = 50, 200, 12
"""Times that plans are climbed to, if no limit ends it before, and nodes of plans if nothing is limited, of teams
of that many robots at most (80 took 46 s for these nodes, and proved nothing)."""
DONE = {Stop.EXHAUSTED, Stop.CLOSED}


def check_small_monotone(problem: Problem, budget: Budget) -> None:
    """Refuse a small function that falls, showing where; what cannot be looked at in time is relied on.

    Raises
    ------
    InputError : the objective is not non-decreasing over feasible sets.
    """
    f = unmetered(problem.objective)
    domain = domain_of(f, problem.robot, None)
    if f.is_non_decreasing or domain.count > (CHECKED_TABLE if isinstance(f, TableFunction) else CHECKED_SETS):
        return
    try:
        enumerate_marginals(domain, budget.part(ATTACK_SHARE))
    except OutOfBudget:
        return


def search_any(problem: Problem, budget: Budget, gap: float = 1e-9, alpha_cs: int | None = None) -> MaxMinResult:
    """Bracket the optimum of any non-decreasing function; ``alpha_cs`` : what RATT was asked before, if it was.

    Relies on that (checked if it is small). A spent budget or an interrupt returns the bracket.

    Raises
    ------
    InputError : the function falls, if that is checked, or a value is no finite number.
    """
    search = None
    try:
        check_small_monotone(problem, budget)
        found = _enumerated(problem, budget)
        if found is not None and found.stop in DONE:
            return found
        search = _Search(problem, budget, found)
        stop = search.run(gap, alpha_cs)
    except OutOfBudget as out:
        stop = out.stop
    except KeyboardInterrupt:
        stop = budget.interrupt()
    return (search or _Search(problem, budget, None)).result(stop)


def _enumerated(problem: Problem, budget: Budget) -> MaxMinResult | None:
    """What the enumeration of plans and outcomes says within its share; ``None`` if there are too many."""
    if problem.threat.links_alike and count_outcomes(problem.threat, enough=MOST_OUTCOMES) > MOST_OUTCOMES:
        return None
    try:
        return exhaustive_optimum(problem, budget=budget.part(ENUMERATION_SHARE))
    except InputError as error:
        if error.argument in {"problem", "graph"}:
            return None
        raise


class _Search:
    """The bracket, valid at any moment."""

    def __init__(self, problem: Problem, budget: Budget, known: MaxMinResult | None) -> None:
        self._given, self._budget = problem, budget
        elements = np.array([choice[0] for choice in problem.choices]) if known is None else known.elements
        empty, full = np.zeros((2, problem.objective.n), dtype=np.bool_)
        full[:] = True
        ends = checked_values(unmetered(problem.objective), np.array([empty, full]))  # whatever the limits
        lower, self.upper = float(ends[0]), float(ends[1])
        if known is not None:
            lower, self.upper = max(lower, known.lower), min(self.upper, known.upper)
        self._attacks = PlanAttacks(problem, budget, elements, lower)
        self._climbing = Climbing(problem, self._attacks, budget)

    def run(self, gap: float, alpha_cs: int | None) -> Stop:
        """RATT's plan first, then bounds on all plans, then climbing and attacking in turn, then all plans."""
        attacks = self._attacks
        planned = self._planned(alpha_cs)
        plan = attacks.elements if planned is None else planned
        first = attacks.first(plan)
        self._bound(pooling_bound(self._given, attacks, self._budget))
        if planned is not None and not self._budget.is_over:
            self._bound(guarantee_bound(attacks.problem, first.upper))
        current = plan
        for _ in range(ROUNDS):
            known = len(attacks.known)
            current = self._improved(current, gap)
            for one in (plan, current):
                attacks.go_on(one)
            if self._is_closed(gap):
                return Stop.CLOSED
            if len(attacks.known) == known:
                break
        return self._divided(gap)

    def _divided(self, gap: float) -> Stop:
        """Divide the plans that are left; if nothing is limited, for a fixed number of nodes."""
        budget, tree = self._budget, PlanTree(self._given, self._attacks, self._climbing.worth, self.upper)
        has_limit = min(budget.seconds_left, budget.evaluations_left, budget.max_nodes or np.inf) < np.inf
        last = np.inf if has_limit else NODES if self._given.n_robots <= SOON_VALUED else 0
        while not (self._is_closed(gap) or tree.is_finished or budget.stop() or budget.nodes >= last):
            tree.divide(budget)
            self._bound(tree.upper)
        return Stop.CLOSED if self._is_closed(gap) else budget.stop() or Stop.HEURISTIC

    def _bound(self, upper: float) -> None:
        self.upper = max(min(self.upper, upper), self._attacks.lower)

    def _is_closed(self, gap: float) -> bool:
        width = max(gap, CLOSED_WIDTH) * abs(self.upper) + self._given.objective.rounding
        return self.upper - self._attacks.lower <= width

    def _improved(self, current: IntArray, gap: float) -> IntArray:
        """Climb from a plan, attack the one that is reached, climb on, until an attack teaches nothing."""
        part, known = self._budget.part(CLIMB_SHARE), -1
        while known < len(self._attacks.known) and not (self._is_closed(gap) or part.is_over):
            known = len(self._attacks.known)
            current = self._climbing.climbed(current, part)
            if not part.is_over:
                self._attacks.attack(current, part.part(ATTACK_SHARE))
        return current

    def _planned(self, alpha_cs: int | None) -> IntArray | None:
        """RATT's plan; ``None`` if its shares of the budget do not do for it; as far as it came it is a plan."""
        single = self._individual(self._budget.part(SINGLES_SHARE))
        part = self._budget.part(PLAN_SHARE)
        alpha_cs = alpha_cs_in_share(self._given, part) if alpha_cs is None else alpha_cs
        asked = metered_problem(self._attacks.problem, part)
        elements = bait_and_greedy(asked, self._given.alpha_s + alpha_cs, part, single).elements
        self._attacks.elements = elements
        return None if part.is_over or not np.isfinite(single).all() else elements

    def _individual(self, part: Budget) -> FloatArray:
        """(E,) individual values, ``-inf`` if the part does not do for it: of as many elements of each robot."""
        objective, choices = metered_problem(self._attacks.problem, part).objective, self._given.choices
        single, nothing = np.full(objective.n, -np.inf), np.array([], dtype=np.int64)
        try:
            for k in range(max(map(len, choices))):
                elements = np.array([choice[k] for choice in choices if len(choice) > k])
                single[elements] = objective.extensions(nothing, elements)
        except OutOfBudget as out:
            if out.stop is Stop.INTERRUPTED:
                raise
        return single

    def result(self, stop: Stop) -> MaxMinResult:
        """What is known."""
        attacks = self._attacks
        return MaxMinResult(
            elements=readonly(np.asarray(attacks.elements)),
            lower=attacks.lower,
            upper=max(self.upper, attacks.lower),
            stop=stop,
            evaluations=self._budget.evaluations,
            nodes=self._budget.nodes,
            worst_case=attacks.worst_case,
        )
