"""The bracket of the best plan by values: first plans, exchanges, rows, walks and branch and bound."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from ratt_opt._validation import readonly
from ratt_opt.attack.task import CLOSED_WIDTH, metered_problem
from ratt_opt.budget import OutOfBudget, Stop
from ratt_opt.setfunctions.base import checked_values
from ratt_opt.setfunctions.metered import unmetered
from ratt_opt.solvers.by_values.climbing import Climbing
from ratt_opt.solvers.by_values.part_row import down_to_multiple
from ratt_opt.solvers.by_values.plan_attacks import PlanAttacks
from ratt_opt.solvers.by_values.plan_bounds import guarantee_bound, pooling_bound
from ratt_opt.solvers.by_values.plan_tree import PlanTree
from ratt_opt.solvers.by_values.reliance import refuse_along, relied_on
from ratt_opt.solvers.by_values.row_tree import RowTree
from ratt_opt.solvers.by_values.whole_function import parts_of
from ratt_opt.solvers.maxmin.params import or_default
from ratt_opt.solvers.ratt import alpha_cs_in_share, bait_and_greedy
from ratt_opt.solvers.result import MaxMinResult

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from ratt_opt._validation import FloatArray, IntArray
    from ratt_opt.attack.task import AttackResult
    from ratt_opt.budget import Budget
    from ratt_opt.problem import Plan, Problem
    from ratt_opt.solvers.maxmin.params import MaxMinParams

__all__ = ["PlanSearch"]


class PlanSearch:
    """The bracket, valid at any moment.

    First plans and exchanges from them may overrun the budget (``first_plans.beyond``).
    """

    def __init__(
        self,
        problem: Problem,
        budget: Budget,
        params: MaxMinParams | None = None,
        *,
        seed: int = 0,
        on_improvement: Callable[[IntArray], object] | None = None,
    ) -> None:
        self._given, self._whole, self._params = problem, budget, or_default(params)
        first = self._params.first_plans
        elements = np.array([choice[0] for choice in problem.choices]) if problem.at_most is None else problem.idle
        empty, full = np.zeros((2, problem.objective.n), dtype=np.bool_)
        full[:] = True
        ends = checked_values(unmetered(problem.objective), np.array([empty, full]))  # whatever the limits
        lower, self.upper = float(ends[0]), float(ends[1])
        self._budget = budget.beyond(first.beyond)
        self._attacks = PlanAttacks(problem, self._budget, elements, lower, first)
        self._attacks.on_improvement = on_improvement
        self._climbing = Climbing(problem, self._attacks, first.kept)
        self._rng = np.random.default_rng(seed)
        self.kicks = 0
        self._rows: RowTree | None = None
        self.plans: list[IntArray] = []
        """RATT's, the greedy and the myopic plan, as far as they differ."""
        self.ratts: Plan | None = None
        self._ratts: AttackResult | None = None
        """The attack on RATT's plan, if that was planned to its end."""

    def start(self, alpha_cs: int | None) -> None:
        """Attack RATT's plan, the greedy and the myopic one, then go on with the one that seems best."""
        params = self._params.first_plans
        single = self._individual(self._budget.part(params.singles))
        part = self._budget.part(params.plan)
        alpha_cs = alpha_cs_in_share(self._given, part) if alpha_cs is None else alpha_cs
        for alpha in (self._given.alpha_s + alpha_cs, 0, self._given.n_robots):
            made, is_whole = self._planned(alpha, single)
            plan = made.elements
            if any(np.array_equal(plan, known) for known in self.plans):
                continue
            found = self._attacks.first(plan)
            if not self.plans:
                self.ratts = replace(made, alpha_cs=alpha_cs)
                self._ratts = found if is_whole else None
            self.plans.append(plan)
        self._attacks.go_on(max(self.plans, key=self._climbing.value), at_first=True)

    def learn(self, found: MaxMinResult | None) -> None:
        """Take over what an enumeration proved before its share ended it."""
        if found is None:
            return
        self._bound(found.upper)
        self._attacks.learn(found.elements, found.lower)

    def climb_first(self, gap: float, others: Sequence[IntArray] = ()) -> bool:
        """Exchange elements of the first plans, and of others; whether that closes. What follows keeps the limits."""
        for plan in others:
            self._attacks.attack(plan)
        plans = sorted([*others, *self.plans], key=self._climbing.value, reverse=True)
        if not any(self._climbed(plan, gap) for plan in plans):
            params = self._params.first_plans
            part = self._budget.part(params.exchanges, at_least=params.beyond)
            for plan in self.plans:
                self._climbing.climbed(plan, part, attacks=True)
        self._budget.keep_to(self._whole)
        return self._is_closed(gap)

    def run(self, gap: float) -> Stop:
        """Bound all plans, walk on from the best one, then divide all plans."""
        if self._ratts is not None and not self._budget.is_over:
            self._bound(guarantee_bound(self._attacks.problem, self._ratts.upper))
        return Stop.CLOSED if self._is_closed(gap) or self._bounded_by_rows(gap) else self._divided(gap)

    def bound_first(self) -> None:
        """Bound all plans by attacks on robots that hold all their elements, and by the first rows of parts."""
        self._bound(pooling_bound(self._given, self._attacks, self._budget.part(self._params.first_plans.attack)))
        self._bound_by_rows(self._params.value_turns.first_rows)

    def _bounded_by_rows(self, gap: float) -> bool:
        """Lower the upper end by rows of parts, and climb from a plan near the fractional one; whether that closes."""
        self._bound_by_rows(self._params.value_turns.rows)
        return self._is_closed(gap) or (self._rows is not None and self._climbed(self._rows.rounded(), gap))

    def _bound_by_rows(self, share: float) -> None:
        """Bound the root of the tree by rows, within a share of what is left."""
        f, part = unmetered(self._given.objective), self._budget.part(share)
        asked = metered_problem(self._attacks.problem, part).objective
        parts = parts_of(f, self._attacks.problem.objective)
        if parts is None or part.is_over:
            return
        try:
            if self._rows is None:
                single = asked.singletons() if f.is_submodular else None
                self._rows = RowTree(self._given, parts, self._attacks, single, (self.upper, part), self._params)
            if self._rows.is_at_root:
                self._rows.divide(part)
        except OutOfBudget:
            self._budget.check()
        finally:
            if self._rows is not None:
                self._bound(self._rows.upper if self._rows.relies_on_caps else self._rows.largest)

    def _climbed(self, plan: IntArray, gap: float) -> bool:
        """Climb from one plan until attacks teach nothing; whether that closes the bracket."""
        current = plan
        for _ in range(self._params.first_plans.rounds):
            known = len(self._attacks.known)
            current = self._improved(current, gap)
            for one in (plan, current):
                self._attacks.go_on(one)
            if self._is_closed(gap) or len(self._attacks.known) == known:
                break
        return self._is_closed(gap)

    def refine(self, plans: list[IntArray], share: float, most_kicks: float, patience: float) -> None:
        """Climb from the first plans and others, and walk on from the best; no bounds on all plans."""
        self.climb_first(0.0, plans)
        self._walked(patience, 0.0, share, most_kicks)
        self._attacks.go_on(self._attacks.elements)

    def _walked(self, patience: float, gap: float, share: float | None = None, most: float = np.inf) -> None:
        """Kick the best plan and climb until that is in vain for some kicks (Lourenço, Martin and Stützle 2003)."""
        params, in_vain, until = self._params.value_walk, 0, self.kicks + most
        part = self._budget.part(params.share if share is None else share)
        while not (self._is_closed(gap) or part.is_over) and in_vain < patience and self.kicks < until:
            self.kicks += 1
            before, robots = self._attacks.lower, int(self._rng.integers(1, params.most_robots + 1))
            climbed = self._climbing.climbed(self._climbing.kicked(self._attacks.elements, self._rng, robots), part)
            if not part.is_over and self._climbing.value(climbed) > before:
                self._attacks.attack(climbed, part.part(self._params.first_plans.attack))
            in_vain = 0 if self._attacks.lower > before else in_vain + 1

    def _divided(self, gap: float) -> Stop:
        """Walk and divide the plans that are left in turns, each longer than before, until nothing is left to prove.

        A turn's length is counted in values and nodes, so that the result is the same on every run.
        """
        budget, turns = self._whole, self._params.value_turns
        known = self.upper, turns.most_open
        tree = self._rows or PlanTree(self._given, self._attacks, self._climbing.worth, known)
        nodes, patience = turns.nodes, self._params.value_walk.patience
        while True:
            begun = budget.evaluations
            self._walked(patience, gap)
            until, last = 2 * budget.evaluations - begun, budget.nodes + nodes
            while not (self._is_closed(gap) or tree.is_finished or budget.stop() or budget.nodes >= last):
                tree.divide(budget)
                self._bound(tree.upper)
                if budget.nodes >= last and budget.evaluations < until:
                    last += 1
            if self._is_closed(gap):
                return Stop.CLOSED
            if (stop := budget.stop()) or tree.is_finished:
                return stop or Stop.HEURISTIC
            patience, nodes = turns.growth * patience, turns.growth * nodes

    def _bound(self, upper: float) -> None:
        attacks, f = self._attacks, unmetered(self._given.objective)
        upper = down_to_multiple(upper, f.spacing)
        if f.is_submodular and upper < attacks.lower - f.least_improvement(attacks.lower, terms=4):
            refuse_along(f, np.asarray(attacks.elements))
        self.upper = max(min(self.upper, upper), attacks.lower)

    def _is_closed(self, gap: float) -> bool:
        width = max(gap, CLOSED_WIDTH) * abs(self.upper) + self._given.objective.rounding
        return self.upper - self._attacks.lower <= width

    def _improved(self, current: IntArray, gap: float) -> IntArray:
        """Climb from a plan, attack the one that is reached, climb on, until an attack teaches nothing."""
        part, known = self._budget.part(self._params.first_plans.climb), -1
        while known < len(self._attacks.known) and not (self._is_closed(gap) or part.is_over):
            known = len(self._attacks.known)
            current = self._climbing.climbed(current, part)
            if not part.is_over:
                self._attacks.attack(current, part.part(self._params.first_plans.attack))
        return current

    def _planned(self, alpha: int, single: FloatArray) -> tuple[Plan, bool]:
        """Bait for ``alpha`` robots, greedy for the others, as far as a share lasts; whether it lasted."""
        # The greedy algorithm values at most this many sets: half of all pairs of an element and a round.
        values = float(self._given.objective.n) * max(self._given.n_robots - alpha, 0) / 2
        params, left = self._params.first_plans, max(self._budget.evaluations_left, 1.0)
        part = self._budget.part(max(params.plan, min(values / left, params.most_plan)))
        asked = metered_problem(self._attacks.problem, part)
        return bait_and_greedy(asked, alpha, part, single), bool(np.isfinite(single).all()) and not part.is_over

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
        """Return the result so far."""
        attacks = self._attacks
        return MaxMinResult(
            elements=readonly(np.asarray(attacks.elements)),
            lower=attacks.lower,
            upper=max(self.upper, attacks.lower),
            stop=stop,
            evaluations=self._whole.evaluations,
            nodes=self._whole.nodes,
            worst_case=attacks.worst_case,
            relies_on=relied_on(unmetered(self._given.objective)),
        )
