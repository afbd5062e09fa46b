"""Attacks on plans of a function known by its values: the known ones, and the plan with the best worst case."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.attack.exact import worst_case_attack_unrounded
from ratt_opt.attack.task import AttackMemory, AttackOptions, metered_problem
from ratt_opt.budget import OutOfBudget, Stop

if TYPE_CHECKING:
    from collections.abc import Callable

    from ratt_opt._validation import IntArray
    from ratt_opt.attack.task import AttackResult
    from ratt_opt.budget import Budget
    from ratt_opt.problem import Attack, Problem
    from ratt_opt.solvers.maxmin.params import FirstPlanParams

__all__ = ["PlanAttacks"]


class PlanAttacks:
    """``elements`` keep ``lower`` under every attack, as ``worst_case`` proved, once there is one.

    ``known`` : attacks found so far, and the unblinded robots of the groups that each leaves
    """

    def __init__(
        self, problem: Problem, budget: Budget, elements: IntArray, lower: float, params: FirstPlanParams
    ) -> None:
        self._given, self._params, self.budget = problem, params, budget
        self.problem = metered_problem(problem, budget)
        self.elements, self.lower = elements, lower
        self.worst_case: AttackResult | None = None
        self._is_kept = False
        """True if ``lower`` was proved of ``elements``, here or by another search."""
        self.on_improvement: Callable[[IntArray], object] | None = None
        """Called with each plan that is kept."""
        self.known: dict[Attack, list[frozenset[int]]] = {}
        self._begun: dict[bytes, AttackMemory] = {}
        """Memories of attacks that can go on: on the first plans, and on the last other one; some megabytes each."""
        self._first: set[bytes] = set()
        self._cut_short: set[bytes] = set()
        """Plans whose last attack a share of the budget ended."""

    def first(self, elements: IntArray) -> AttackResult:
        """Attack one of the plans that all others are compared with."""
        tables = not self._first and self.budget.evaluations_left < np.inf
        self._first.add(elements.tobytes())
        return self.attack(elements, self.budget.part(self._params.table) if tables else None)

    def attack(self, elements: IntArray, part: Budget | None = None, aim: float | None = None) -> AttackResult:
        """Attack a plan, from where that ended; keep it if more is proved of it than of the one kept.

        ``part`` : a share of what is left if absent; ``aim`` : what an attack has to leave at most to end it, what the
            plan kept is worth if absent

        Raises
        ------
        OutOfBudget : the user interrupted it; what it had proved counts.
        """
        part = self.budget.part(self._params.attack) if part is None else part
        key = elements.tobytes()
        memory = self._begun.pop(key, None) or AttackMemory()
        if aim is None:
            aim = self._of_use
        result = worst_case_attack_unrounded(
            self.problem, elements, AttackOptions(budget=part, aim=aim, memory=memory, brief=True)
        )
        self._cut_short.discard(key)
        if result.stop in {Stop.TIME, Stop.EVALUATIONS}:
            self._cut_short.add(key)
        if result.stop in {Stop.TIME, Stop.EVALUATIONS, Stop.HEURISTIC, Stop.GAP}:
            self._begun = {k: one for k, one in self._begun.items() if k in self._first} | {key: memory}
        self.known.setdefault(result.attack, self._given.groups_left(result.attack))
        if not self._is_kept or result.lower > self.lower:
            self._keep(elements.copy(), max(result.lower, self.lower), result)
        if result.stop is Stop.INTERRUPTED:
            raise OutOfBudget(result.stop)
        return result

    def attack_if_better(self, elements: IntArray) -> None:
        """Attack a plan if the known attacks leave more of it than of the best one."""
        groups = list(self.known.values())
        sets = [elements[sorted(group)].tolist() for parts in groups for group in parts]
        flat = iter(self.problem.objective.values_of(sets).tolist())
        if min(max(next(flat) for _ in parts) for parts in groups) > self.lower:
            self.attack(elements)

    def learn(self, elements: IntArray, lower: float) -> None:
        """Keep a plan of which another search proved more."""
        if lower > self.lower:
            self._keep(elements, lower, None)

    def _keep(self, elements: IntArray, lower: float, worst_case: AttackResult | None) -> None:
        self.elements, self.lower, self.worst_case, self._is_kept = elements, lower, worst_case, True
        if self.on_improvement is not None:
            self.on_improvement(elements)

    def go_on(self, elements: IntArray, *, at_first: bool = False) -> None:
        """Attack a plan with all that is left if a share ended its last attack; ``at_first`` : with some of it."""
        if elements.tobytes() in self._cut_short & self._begun.keys() and not self.budget.is_over:
            params, left = self._params, self.budget.seconds_left
            seconds = min(params.longer, params.longer_share * left) if at_first else left
            self.attack(elements, self.budget.part(params.attack if at_first else 1.0, at_least=seconds))

    @property
    def _of_use(self) -> float:
        """Worst-case value that a plan has to exceed to be of use."""
        return self.lower if self._is_kept else -np.inf

    def settle(self, elements: IntArray, aim: float) -> AttackResult:
        """Attack a plan exactly with all that is left, until its worst case is proved to be at most ``aim``.

        If first attacks end as ``HEURISTIC`` the second one goes on to the end; so do both if nothing is limited.
        """
        aim = max(aim, self._of_use)
        result = self.attack(elements, self.budget.part(), aim)
        return self.attack(elements, self.budget.part(), aim) if result.stop is Stop.HEURISTIC else result
