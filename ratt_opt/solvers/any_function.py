"""Plans for any set function, known by its values alone: a bracket of any size, within any number of values.

Small problems are enumerated (``exhaustive.py``). Beyond: plans improved element by element against the attacks known
so far, which are attacked in turn; then, as long as there is time, all others by branch and bound (``plan_tree.py``).
No plan is worth more than

- what the worst attack found leaves of a team in which every robot holds all its elements (monotonicity), or, where
  theory proves the function submodular, of the sum of the robots' largest individual values;
- RATT's plan under any attack, divided by the share of the optimum that RATT keeps (``1 - k`` of a submodular
  function, ``(1 - c)^2`` of one that states a bound on its total curvature).
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from ratt_opt._validation import readonly
from ratt_opt.attackers.any_function import metered_problem
from ratt_opt.attackers.by_partition.threshold_search import LARGEST_PLAIN
from ratt_opt.attackers.exact import worst_case_attack
from ratt_opt.attackers.task import AttackMemory
from ratt_opt.bounds.guarantees import pattern_free_bound
from ratt_opt.budget import Budget, OutOfBudget
from ratt_opt.curvatures.domains import domain_of
from ratt_opt.curvatures.marginals import enumerate_marginals
from ratt_opt.errors import InputError
from ratt_opt.graph.outcomes import count_outcomes
from ratt_opt.setfunctions.base import TableFunction, checked_values
from ratt_opt.setfunctions.metered import unmetered
from ratt_opt.solvers.exhaustive import exhaustive_optimum
from ratt_opt.solvers.plan_tree import PlanTree, Pooled
from ratt_opt.solvers.ratt import alpha_cs_in_share, bait_and_greedy
from ratt_opt.solvers.result import MaxMinResult
from ratt_opt.stopping import Stop

if TYPE_CHECKING:
    from ratt_opt._validation import FloatArray, IntArray
    from ratt_opt.attackers.task import AttackResult
    from ratt_opt.problem import Attack, Problem

__all__ = ["check_small_monotone", "search_any"]

CHECKED_SETS, CHECKED_TABLE = 2**12, 2**18
"""Feasible sets up to which a function, and one given as a table, is checked to be non-decreasing: milliseconds."""
ENUMERATION_SHARE, SINGLES_SHARE, PLAN_SHARE, ATTACK_SHARE, CLIMB_SHARE = 0.5, 0.7, 0.3, 0.2, 0.5
"""Shares of the seconds and values left: for the enumeration of a small problem, for individual values, which plans
begin with and first bounds need, for the rest of RATT's plan, for each attack on a plan, and for climbing from plan to
plan with such attacks; then those that their share ended go on. Not tuned."""
FIRST_SECONDS, SHORT_SHARE = 1.0, 0.8
"""So many seconds at least for the first attack, if that is no more than this share of those left: with a fifth of one
second, three quarters of what a second proves of RATT's plan for 20 robots were left unproved."""
MOST_OUTCOMES = 200_000
"""Outcomes that are gone through: some seconds where plans are few."""
ROUNDS, NODES = 50, 200
"""Times that plans are climbed to, where no limit ends it before, and nodes of plans where nothing is limited, of teams
whose sets are soon tabulated (80 robots took 46 s for these nodes, and proved nothing)."""
MOST_KEPT = 500_000
"""Values kept, some hundred megabytes at most; then they are asked for anew."""
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

    Relies on that (checked where it is small). A spent budget or an interrupt returns the bracket.

    Raises
    ------
    InputError : the function falls, where that is checked, or a value is no finite number.
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
    """What the enumeration of plans and outcomes says within its share; ``None`` where there are too many."""
    if problem.threat.links_alike and count_outcomes(problem.threat, enough=MOST_OUTCOMES) > MOST_OUTCOMES:
        return None
    try:
        return exhaustive_optimum(problem, budget=budget.part(ENUMERATION_SHARE))
    except InputError as error:
        if error.argument in {"problem", "graph"}:
            return None
        raise


class _Search:
    """The bracket, valid at any moment, and the attacks known so far."""

    def __init__(self, problem: Problem, budget: Budget, known: MaxMinResult | None) -> None:
        self._given, self._budget = problem, budget
        self._problem = metered_problem(problem, budget)
        self.elements = np.array([choice[0] for choice in problem.choices]) if known is None else known.elements
        empty, full = np.zeros((2, problem.objective.n), dtype=np.bool_)
        full[:] = True
        ends = checked_values(unmetered(problem.objective), np.array([empty, full]))  # whatever the limits
        self.lower, self.upper = float(ends[0]), float(ends[1])
        if known is not None:
            self.lower, self.upper = max(self.lower, known.lower), min(self.upper, known.upper)
        self.worst_case: AttackResult | None = None
        self.attacks: dict[Attack, list[frozenset[int]]] = {}
        self._known: dict[frozenset[int], float] = {}
        self._begun: dict[bytes, AttackMemory] = {}
        """Attacks that a share of the budget ended: on RATT's plan, and on the last other one."""
        self._first = b""
        self._asked = self._problem.objective

    def run(self, gap: float, alpha_cs: int | None) -> Stop:
        """RATT's plan first, then bounds on all plans, then climbing and attacking in turn."""
        planned = self._planned(alpha_cs)
        plan = self.elements if planned is None else planned
        self._first = plan.tobytes()
        first = self._attack(plan, self._first_part())
        self._bound_by_pooling()
        if planned is not None:
            self._bound_by_guarantee(first)
        current = plan
        for _ in range(ROUNDS):
            known = len(self.attacks)
            current = self._improved(current, gap)
            for one in (plan, current):
                self._go_on(one)
            if self._is_closed(gap):
                return Stop.CLOSED
            if len(self.attacks) == known:
                break
        return self._divided(gap)

    def _divided(self, gap: float) -> Stop:
        """Divide the plans that are left; where nothing is limited, for a fixed number of nodes."""
        budget, tree = self._budget, PlanTree(self._given, self, self.upper)
        has_limit = min(budget.seconds_left, budget.evaluations_left, budget.max_nodes or np.inf) < np.inf
        last = np.inf if has_limit else NODES if self._given.n_robots <= LARGEST_PLAIN else 0
        self._asked = self._problem.objective
        while not (self._is_closed(gap) or tree.is_finished or budget.stop() or budget.nodes >= last):
            tree.divide(budget)
            self.upper = min(self.upper, max(tree.upper, self.lower))
        return Stop.CLOSED if self._is_closed(gap) else budget.stop() or Stop.HEURISTIC

    def _first_part(self) -> Budget:
        seconds = min(FIRST_SECONDS, SHORT_SHARE * self._budget.seconds_left)
        # Of evaluations it does not need what a short time may not do for: a table takes a known number of them.
        share = ATTACK_SHARE if np.isinf(self._budget.evaluations_left) else SHORT_SHARE
        return self._budget.part(share, at_least=seconds)

    def _is_closed(self, gap: float) -> bool:
        return self.upper - self.lower <= gap * abs(self.upper)

    def _improved(self, current: IntArray, gap: float) -> IntArray:
        """Climb from a plan, attack the one that is reached, climb on, until an attack teaches nothing."""
        part, known = self._budget.part(CLIMB_SHARE), -1
        while known < len(self.attacks) and not (self._is_closed(gap) or part.is_over):
            known = len(self.attacks)
            current = self._climbed(current, part)
            if not part.is_over:
                self._attack(current, part.part(ATTACK_SHARE))
        return current

    def _go_on(self, elements: IntArray) -> None:
        """Attack a plan with all that is left where a share ended its last attack."""
        if elements.tobytes() in self._begun and not self._budget.is_over:
            self._attack(elements, self._budget.part())

    def _planned(self, alpha_cs: int | None) -> IntArray | None:
        """RATT's plan; ``None`` where its shares of the budget do not do for it; as far as it came it is a plan."""
        single = self._individual(self._budget.part(SINGLES_SHARE))
        part = self._budget.part(PLAN_SHARE)
        alpha_cs = alpha_cs_in_share(self._given, part) if alpha_cs is None else alpha_cs
        asked = metered_problem(self._problem, part)
        self.elements = bait_and_greedy(asked, self._given.alpha_s + alpha_cs, part, single).elements
        return None if part.is_over or not np.isfinite(single).all() else self.elements

    def _individual(self, part: Budget) -> FloatArray:
        """(E,) individual values, ``-inf`` where the part does not do for it: of as many elements of each robot."""
        objective, choices = metered_problem(self._problem, part).objective, self._given.choices
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
        return MaxMinResult(
            elements=readonly(np.asarray(self.elements)),
            lower=self.lower,
            upper=max(self.upper, self.lower),
            stop=stop,
            evaluations=self._budget.evaluations,
            nodes=self._budget.nodes,
            worst_case=self.worst_case,
        )

    def attack(self, elements: IntArray) -> AttackResult:
        """Attack a plan within a share of what is left, as the tree asks."""
        return self._attack(elements, self._budget.part(ATTACK_SHARE))

    def _attack(self, elements: IntArray, part: Budget) -> AttackResult:
        """Attack a plan, from where that ended; keep it where more is proved of it than of the one kept."""
        key = elements.tobytes()
        memory = self._begun.pop(key, None) or AttackMemory()
        aim = -np.inf if self.worst_case is None else self.lower  # a plan that keeps no more is of no use
        result = worst_case_attack(self._problem, elements, budget=part, aim=aim, memory=memory)
        if result.stop in {Stop.TIME, Stop.EVALUATIONS}:
            first = {k: self._begun[k] for k in [self._first] if k in self._begun}
            self._begun = first | {key: memory}  # some megabytes each
        self.attacks.setdefault(result.attack, self._given.groups_left(result.attack))
        if self.worst_case is None or result.lower > self.lower:
            self.elements, self.lower, self.worst_case = elements.copy(), max(result.lower, self.lower), result
        if result.stop is Stop.INTERRUPTED:
            raise OutOfBudget(result.stop)
        return result

    def _climbed(self, elements: IntArray, part: Budget) -> IntArray:
        """Change one robot's element at a time while the known attacks leave more, within a part of the budget."""
        self._asked = metered_problem(self._problem, part).objective
        current = elements.copy()
        try:
            value, unchanged, i = self._value(elements), 0, 0
            while unchanged < len(current):
                unchanged += 1
                for e in self._given.choices[i]:
                    other = current.copy()
                    other[i] = e
                    if e != current[i] and (better := self._value(other)) > value:
                        current, value, unchanged = other, better, 0
                i = (i + 1) % len(current)
        except OutOfBudget:
            self._budget.check()
        return current

    def _value(self, elements: IntArray) -> float:
        """What the known attacks leave of a plan."""
        return min(max(self._worth(elements, group) for group in groups) for groups in self.attacks.values())

    def _worth(self, elements: IntArray, group: frozenset[int]) -> float:
        return self.worth(frozenset(elements[sorted(group)].tolist()))

    def worth(self, elements: frozenset[int]) -> float:
        """Value of a set of elements, within the part of the budget that is being spent."""
        if elements not in self._known:
            if len(self._known) > MOST_KEPT:
                self._known.clear()
            self._known[elements] = self._asked(elements)
        return self._known[elements]

    def _bound_by_pooling(self) -> None:
        """What the worst attack found leaves of robots that hold all their elements."""
        everyone = np.arange(self._given.n_robots)
        team = replace(self._given, objective=Pooled(self._given, self._singles()), robot=everyone)
        worst = worst_case_attack(team, everyone, budget=self._budget.part(ATTACK_SHARE)).attack
        team = metered_problem(team, self._budget)
        for attack in [*self.attacks, worst]:
            self.upper = min(self.upper, team.team_value(everyone, attack))

    def _singles(self) -> FloatArray | None:
        """(E,) individual values where theory proves the function submodular."""
        return self._problem.objective.singletons() if unmetered(self._given.objective).is_submodular else None

    def _bound_by_guarantee(self, first: AttackResult) -> None:
        """RATT's plan keeps a share of the optimum, so the optimum is at most its value over that share."""
        f, share = unmetered(self._given.objective), 0.0
        if (single := self._singles()) is not None:
            metered = self._problem.objective
            top = np.maximum(metered(range(f.n)) - metered.evaluate(~np.eye(f.n, dtype=np.bool_)), 0.0)
            share = float((top[single > 0] / single[single > 0]).min(initial=1.0))
            share = float(pattern_free_bound(k=min(max(1.0 - share, 0.0), 1.0)))
        elif f.most_total_curvature < 1:
            share = float(pattern_free_bound(c=f.most_total_curvature))
        if share > 0 and not self._budget.is_over:
            self.upper = min(self.upper, first.upper / share)
