"""Rows of modular bounds, part by part, that bound the plans of a node.

An outcome leaves the robots of one group; what a plan's set ``T`` of their elements is worth is at most
``sum_j w_j (alpha_j + beta_j(T))`` for any modular bounds of the parts. A *row* takes for each part the bound that is
lowest at the fractional plan in hand. Bounds of parts are kept in one pool: they serve every outcome and every node. Of
the linear program only the multipliers are used: the combined row is made anew, and bounds the plans of a node by its
largest value.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.bounds.cuts import ROUNDING
from ratt_opt.solvers.by_values.kept_rows import KeptRows
from ratt_opt.solvers.by_values.outcome_rows import OutcomeRows, blinds_alone
from ratt_opt.solvers.by_values.part_row import PartRow
from ratt_opt.solvers.by_values.plan_tree import Pooled
from ratt_opt.solvers.maxmin.relaxation import NodeProgram
from ratt_opt.solvers.maxmin.rows.exchanges import exchanged
from ratt_opt.solvers.maxmin.rows.inequalities import Inequalities, TargetInequality
from ratt_opt.solvers.maxmin.rows.pool import InequalityPool

if TYPE_CHECKING:
    from ratt_opt._validation import FloatArray
    from ratt_opt.budget import Budget
    from ratt_opt.problem import Problem
    from ratt_opt.setfunctions.decomposition import Decomposition, Overestimator
    from ratt_opt.solvers.by_values.columns import PlanColumns, PlanNode
    from ratt_opt.solvers.by_values.plan_attacks import PlanAttacks
    from ratt_opt.solvers.maxmin.params import MaxMinParams

__all__ = ["PartRows"]


class PartRows(KeptRows):
    """Rows that bound the plans of any node; ``columns`` of the linear program are the elements.

    ``single`` : (E,) individual values if the function is submodular
    ``budget`` : of the first bounds, which raise ``OutOfBudget``
    """

    def __init__(  # noqa: PLR0917
        self,
        problem: Problem,
        parts: Decomposition,
        columns: PlanColumns,
        attacks: PlanAttacks,
        single: FloatArray | None,
        budget: Budget,
        params: MaxMinParams,
    ) -> None:
        program = NodeProgram(len(columns.kinds), columns.of_kind, columns.limit)
        super().__init__(columns, program, problem.objective.spacing, params)
        self._problem, self._parts, self._attacks, self._effort = problem, parts, attacks, params.part_bounds
        self._touching = [parts.touching(j) for j in range(parts.n_parts)]
        self._pool = InequalityPool(problem.robot, parts.n_parts, self._first_bounds(budget), params.rows)
        self._outcomes = OutcomeRows(problem, attacks, None if blinds_alone(problem) else Pooled(problem, single))

    @property
    def leaves_out(self) -> bool:
        """True if groups of some outcomes may be left out, as they are worth no more than the best plan."""
        return self._outcomes.leaves_out

    def begin(self, node: PlanNode, budget: Budget) -> None:
        """Leave out rows that do not hold at a node, and those that were of no use lately."""
        self._outcomes.take_over()
        self._program.drop_idle(self._params.patience)
        self._keep_those_in_use()
        self._program.within(node.lower, node.upper)
        if not self._program.in_use:
            self.separate(node, self.columns.middle_of(node), np.inf, budget)

    def separate(self, node: PlanNode, point: FloatArray, level: float, budget: Budget) -> bool:
        """Add rows that cut a fractional plan (columns,) off, by bounds known or new ones; whether there are any.

        Rows are taken between the plan and a mean of earlier ones first, which needs fewer rounds.
        """
        fresh, between = self._params.fresh, self._inward(node, point)
        goal = level - self._params.tolerance * abs(level) if level < np.inf else level
        deep = goal - self._params.deep * max(goal - self._attacks.lower, 0.0) if level < np.inf else level
        if self._add_rows((between, point), deep, 0, budget):
            return True
        if self._add_rows((between, point), goal, fresh, budget):
            return True
        if self._add_rows((point, point), goal, fresh, budget):
            return True
        return self._learn(point, goal, budget) and self._add_rows((point, point), goal, fresh, budget)

    def _add_rows(self, plans: tuple[FloatArray, FloatArray], goal: float, fresh: int, budget: Budget) -> bool:
        """Add the lowest rows at the first plan that are below a goal at the second one; whether there are any."""
        (at, point), added = plans, False
        left = self._lowest(at)
        for inside in left[:fresh]:
            self._add_bounds(inside, at, budget)
        for inside in left:
            constant, scores = self._pool.combined(inside, at)
            if constant + float(scores @ point) < goal:
                self._use(PartRow(constant, scores), scores)
                added = True
        return added

    def _lowest(self, share: FloatArray) -> list[FloatArray]:
        """(E,) what the outcomes leave whose rows are lowest at a fractional plan."""
        worth = self._pool.target_bounds(self._outcomes.left, self._pool.by_robot(share)).sum(axis=1)
        lowest = np.argsort(worth, kind="stable")[: self._params.rows].tolist()
        return [self._outcomes.left[k][self._problem.robot] for k in lowest]

    def children(self, node: PlanNode, point: FloatArray, bound: float) -> list[PlanNode]:  # noqa: ARG002
        """Divide a node into all elements of one robot."""
        return self.columns.children(node, point)

    def _add_bounds(self, inside: FloatArray, share: FloatArray, budget: Budget) -> None:
        """Keep bounds of parts that are lower than those known at what an outcome leaves of a fractional plan."""
        left = share * inside
        known = self._pool.target_bounds(np.ones((1, self._problem.n_robots)), self._pool.by_robot(left))[0]
        new: list[tuple[int, Overestimator]] = []
        for j, touching in enumerate(self._touching):
            budget.check()
            bound = self._parts.overestimator(j, left[touching], self._effort)
            if self._parts.weights[j] * bound.at(left[touching]) < known[j] - self._params.tolerance * abs(known[j]):
                new.append((j, bound))
        if new:
            self._pool.add([self._inequalities(new)])

    def _first_bounds(self, budget: Budget) -> list[Inequalities]:
        """A bound of each part for all robots with all their elements, and one for nothing."""
        found = []
        for share in (1.0, 0.0):
            bounds = []
            for j, touching in enumerate(self._touching):
                budget.check()
                bounds.append((j, self._parts.overestimator(j, np.full(len(touching), share), self._effort)))
            found.append(self._inequalities(bounds))
        return found

    def _inequalities(self, bounds: list[tuple[int, Overestimator]]) -> Inequalities:
        targets, weights = np.array([j for j, _ in bounds]), self._parts.weights
        scores = np.zeros((self._problem.objective.n, len(bounds)))
        for k, (j, bound) in enumerate(bounds):
            scores[self._touching[j], k] = weights[j] * bound.gains * (1 + ROUNDING)
        exact = np.array([weights[j] * bound.constant for j, bound in bounds])
        constants = exact + ROUNDING * np.abs(exact)
        origins = tuple(TargetInequality(target=j) for j, _ in bounds)
        return Inequalities(targets=targets, constants=constants, scores=scores, origins=origins)

    def _learn(self, point: FloatArray, goal: float, budget: Budget) -> bool:
        """Look for outcomes that leave less of a fractional plan, then attack a plan near it; whether one is new."""
        known = len(self._outcomes.left)
        by_robot = self._pool.by_robot(point)
        worth = self._pool.target_bounds(self._outcomes.left, by_robot).sum(axis=1)
        lowest = np.argsort(worth, kind="stable")[: self._of_pool.starts].tolist()
        starts = [self._outcomes.attacks[k] for k in lowest]
        for attack in exchanged(self._problem, self._pool, by_robot, starts, (goal, budget)):
            self._attacks.known.setdefault(attack, self._problem.groups_left(attack))
        self._outcomes.take_over()
        if len(self._outcomes.left) == known:
            self._attacks.attack_if_better(self.columns.rounded(point))
            self._outcomes.take_over()
        return len(self._outcomes.left) > known
