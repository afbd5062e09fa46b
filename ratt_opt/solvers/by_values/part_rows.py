"""Rows of modular bounds, part by part, that bound the plans of a node.

An outcome leaves the robots of one group; what a plan's set ``T`` of their elements is worth is at most
``sum_j w_j (alpha_j + beta_j(T))`` for any modular bounds of the parts. A *row* takes for each part the bound that is
lowest at the fractional plan in hand. Bounds of parts are kept in one pool: they serve every outcome and every node. Of
the linear program only the multipliers are used: the combined row is made anew, and bounds the plans of a node by its
largest value.

If robots have the same elements and any of them may be blinded, an attack is as good as its images under permutations
of these robots. The mean of all images leaves each robot to a share: one outcome stands for all, and one column for the
elements that are equal. If no two robots choose a column, the robot of any column may be blinded.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.bounds.cuts import ROUNDING
from ratt_opt.setfunctions.best_elements import BestElements
from ratt_opt.solvers.by_values.columns import PlanColumns
from ratt_opt.solvers.by_values.outcome_rows import OutcomeRows, blinds_alone
from ratt_opt.solvers.by_values.part_row import SUM, PartRow, combine, down_to_multiple
from ratt_opt.solvers.by_values.plan_tree import Pooled
from ratt_opt.solvers.maxmin.relaxation import NodeProgram
from ratt_opt.solvers.maxmin.rows.exchanges import exchanged
from ratt_opt.solvers.maxmin.rows.inequalities import Inequalities, TargetInequality
from ratt_opt.solvers.maxmin.rows.pool import InequalityPool

if TYPE_CHECKING:
    from ratt_opt._validation import FloatArray, IntArray
    from ratt_opt.budget import Budget
    from ratt_opt.problem import Problem
    from ratt_opt.setfunctions.decomposition import Decomposition, Overestimator
    from ratt_opt.solvers.by_values.columns import PlanNode
    from ratt_opt.solvers.by_values.plan_attacks import PlanAttacks
    from ratt_opt.solvers.maxmin.params import MaxMinParams
    from ratt_opt.solvers.maxmin.relaxation import RelaxedPlan

__all__ = ["PartRows"]


class PartRows:
    """``columns`` of the linear program; its rows bound the plans of any node.

    ``single`` : (E,) individual values if the function is submodular
    ``budget`` : of the first bounds, which raise ``OutOfBudget``
    """

    def __init__(  # noqa: PLR0917
        self,
        problem: Problem,
        parts: Decomposition,
        attacks: PlanAttacks,
        single: FloatArray | None,
        budget: Budget,
        params: MaxMinParams,
    ) -> None:
        self._problem, self._parts, self._attacks = problem, parts, attacks
        self._params, self._of_pool, self._spacing = params.part_rows, params.rows, problem.objective.spacing
        only_blinds = blinds_alone(problem)
        # Elements of equal utilities may be exchanged: what they are worth depends on nothing else.
        merges = only_blinds and not problem.threat.protected_robots and isinstance(problem.objective, BestElements)
        self.columns = columns = PlanColumns(problem, parts, merges=merges)
        self._touching = [parts.touching(j) for j in range(parts.n_parts)]
        self._pool = InequalityPool(problem.robot, parts.n_parts, self._first_bounds(budget), params.rows)
        self._levels = parts.n_parts if columns.merges else 0
        sizes = columns.sizes
        self._program = NodeProgram(len(columns.kinds), columns.of_kind, columns.limit, sizes, self._levels)
        self._rows: dict[int, PartRow] = {}
        self._made = 0
        self._outcomes = OutcomeRows(attacks, columns, None if only_blinds else Pooled(problem, single))
        self._mean = np.zeros(len(columns.kinds))

    @property
    def leaves_out(self) -> bool:
        """True if groups of some outcomes may be left out, as they are worth no more than the best plan."""
        return self._outcomes.leaves_out

    def begin(self, node: PlanNode, budget: Budget) -> None:
        """Leave out rows that do not hold at a node, and those that were of no use lately."""
        self._outcomes.take_over()
        self._program.drop_idle(self._params.patience)
        self._program.drop(lambda k: bool((node.upper[list(self._rows[k].wiped)] > 1).any()))
        self._rows = {k: self._rows[k] for k in self._program.in_use}
        free = np.zeros(self._levels)
        self._program.within(np.append(node.lower, free), np.append(node.upper, free + np.inf))
        if self._levels:
            self._bound_levels()
        elif not self._program.in_use:
            self.separate(node, self.columns.middle_of(node), np.inf, budget)

    def _bound_levels(self) -> None:
        """Give each part a row for its value under the mean outcome, and the values one that adds them up."""
        known = {row.part for row in self._rows.values()}
        inside = self._outcomes.left[0][self._problem.robot]
        for j, (constant, scores) in enumerate(self._pool.lasting()):
            if j not in known:
                self._use(PartRow(constant, scores * inside, part=j))
        if SUM not in known:
            self._use(PartRow(0.0, np.zeros(self._problem.objective.n), part=SUM))

    def _use(self, row: PartRow) -> None:
        """Add one row to the program."""
        levels, n = np.zeros(self._levels), len(self.columns.kinds)
        if row.part == SUM:
            levels[:] = 1.0
        scores = np.append(self.columns.mean(row.scores), levels)
        self._program.use(self._made, row.constant, scores, n + row.part if row.part >= 0 else None)
        self._rows[self._made] = row
        self._made += 1

    def solve(self, budget: Budget) -> RelaxedPlan | None:
        """The fractional plan (columns,) of the node, or ``None`` if HiGHS claims none."""
        return self._program.solve(budget.seconds_left)

    def largest(self, relaxed: RelaxedPlan, node: PlanNode) -> float:
        """The largest value of the rows combined by the multipliers, over the plans of a node."""
        active = np.flatnonzero(relaxed.duals > 0)
        combined = combine([self._rows[k] for k in relaxed.cuts[active].tolist()], relaxed.duals[active], self._levels)
        if combined is None:
            return np.inf
        gains = self.columns.largest(combined.scores, node)
        bound = combined.constant + gains + ROUNDING * (combined.size + abs(gains))
        return down_to_multiple(bound, self._spacing)

    def separate(self, node: PlanNode, point: FloatArray, level: float, budget: Budget) -> bool:
        """Add rows that cut a fractional plan (columns,) off, by bounds known or new ones; whether there are any.

        Rows are taken between the plan and a mean of earlier ones first, which needs fewer rounds.
        """
        params, fresh = self._of_pool, self._params.fresh
        point, values = point[: len(self.columns.kinds)], point[len(self.columns.kinds) :]
        self._mean = self.columns.within(self._mean, node, point)
        self._mean = (1 - params.newest) * self._mean + params.newest * point
        between = (1 - params.inward) * point + params.inward * self._mean
        goal = level - self._params.tolerance * abs(level) if level < np.inf else level
        deep = goal - self._params.deep * max(goal - self._attacks.lower, 0.0) if level < np.inf else level
        if self._levels:
            added = [self._bound_parts(at, point, values, budget) for at in (between, point)]
            if any(added):
                self._add_rows(node, (between, point), goal, 0, budget)
                return True
        if self._add_rows(node, (between, point), deep, 0, budget):
            return True
        if self._add_rows(node, (between, point), goal, fresh, budget):
            return True
        if self._add_rows(node, (point, point), goal, fresh, budget):
            return True
        return self._learn(point, goal, budget) and self._add_rows(node, (point, point), goal, fresh, budget)

    def _add_rows(
        self, node: PlanNode, plans: tuple[FloatArray, FloatArray], goal: float, fresh: int, budget: Budget
    ) -> bool:
        """Add the lowest rows at the first plan that are below a goal at the second one; whether there are any."""
        at, point = plans
        share = self.columns.share(at)
        left = self._wiped(share, node, goal) if self._levels else self._lowest(share)
        for inside, _ in left[:fresh]:
            self._add_bounds(inside, share, budget)
        whole, added = self.columns.share(point), False
        for inside, wiped in left:
            constant, scores = self._pool.combined(inside, share)
            if constant + float(scores @ whole) < goal:
                self._use(PartRow(constant, scores, wiped))
                added = True
        return added

    def _lowest(self, share: FloatArray) -> list[tuple[FloatArray, tuple[int, ...]]]:
        """(E,) what the outcomes leave whose rows are lowest at a fractional plan."""
        worth = self._pool.target_bounds(self._outcomes.left, self._pool.by_robot(share)).sum(axis=1)
        lowest = np.argsort(worth, kind="stable")[: self._params.rows].tolist()
        return [(np.asarray(self._outcomes.left[k][self._problem.robot]), ()) for k in lowest]

    def _bound_parts(self, at: FloatArray, point: FloatArray, values: FloatArray, budget: Budget) -> bool:
        """Add bounds of parts at one plan that are below the program's values at another; whether there are any.

        They bound the mean over all outcomes; if all robots are of one kind, exactly that, else at the mean outcome.
        """
        if len(self.columns.sizes) == 1:
            return self._bound_means(at, point, values, budget)
        inside = self._outcomes.left[0][self._problem.robot]
        share, whole, added = self.columns.share(at) * inside, self.columns.share(point) * inside, False
        for j, touching in enumerate(self._touching):
            budget.check()
            bound, weight = self._parts.overestimator(j, share[touching]), self._parts.weights[j]
            if weight * bound.at(whole[touching]) < values[j] - self._params.tolerance * abs(values[j]):
                one = self._inequalities([(j, bound)])
                self._use(PartRow(float(one.constants[0]), one.scores[:, 0] * inside, part=j))
                added = True
        return added

    def _bound_means(self, at: FloatArray, point: FloatArray, values: FloatArray, budget: Budget) -> bool:
        """Add bounds of what parts are worth in the mean over all sets of robots that an attack may blind."""
        f, robots, lost = self._problem.objective, self._problem.n_robots, self._problem.threat.n_blinded
        assert isinstance(f, BestElements)
        share, whole, added = self.columns.share(at), self.columns.share(point), False
        for j, touching in enumerate(self._touching):
            budget.check()
            bound, weight = f.mean_overestimator(j, share[touching], robots, lost), self._parts.weights[j]
            if weight * bound.at(whole[touching]) < values[j] - self._params.tolerance * abs(values[j]):
                one = self._inequalities([(j, bound)])
                self._use(PartRow(float(one.constants[0]), one.scores[:, 0], part=j))
                added = True
        return added

    def _wiped(self, share: FloatArray, node: PlanNode, goal: float) -> list[tuple[FloatArray, tuple[int, ...]]]:
        """(E,) what is left if the robots of some columns are blinded, the lowest first, and these columns.

        For columns that at most one robot chooses: no more than the budget then are to blind, one for each.
        """
        most = self._problem.threat.n_blinded
        single = np.flatnonzero((node.upper == 1) & (self.columns.mean(share) > 0))
        if not most or not len(single):
            return []
        owner = np.full(len(self.columns.kinds), len(single))
        owner[single] = np.arange(len(single))
        by_column = self._pool.by_robot(share, owner[self.columns.column])
        wiped: list[tuple[int, ...]] = [()]
        for _ in range(min(most, len(single))):
            trials = [(*one, k) for one in wiped for k in range(len(single)) if k not in one]
            members = np.ones((len(trials), by_column.shape[0]))
            for row, one in zip(members, trials, strict=True):
                row[list(one)] = 0.0
            worth = self._pool.target_bounds(members, by_column).sum(axis=1)
            lowest = np.argsort(worth, kind="stable")[: self._params.rows].tolist()
            wiped = [trials[k] for k in lowest if worth[k] < goal or len(trials[k]) < most]
        found = []
        for one in {tuple(sorted(single[list(one)].tolist())): None for one in wiped}:
            inside = np.where(np.isin(self.columns.column, one), 0.0, 1.0)
            found.append((inside, one))
        return found

    def _add_bounds(self, inside: FloatArray, share: FloatArray, budget: Budget) -> None:
        """Keep bounds of parts that are lower than those known at what an outcome leaves of a fractional plan."""
        left = share * inside
        known = self._pool.target_bounds(np.ones((1, self._problem.n_robots)), self._pool.by_robot(left))[0]
        new: list[tuple[int, Overestimator]] = []
        for j, touching in enumerate(self._touching):
            budget.check()
            bound = self._parts.overestimator(j, left[touching])
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
                bounds.append((j, self._parts.overestimator(j, np.full(len(touching), share))))
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
        if not self.columns.merges:
            by_robot = self._pool.by_robot(self.columns.share(point))
            worth = self._pool.target_bounds(self._outcomes.left, by_robot).sum(axis=1)
            starts = [
                self._outcomes.attacks[k] for k in np.argsort(worth, kind="stable")[: self._of_pool.starts].tolist()
            ]
            for attack in exchanged(self._problem, self._pool, by_robot, starts, (goal, budget)):
                self._attacks.known.setdefault(attack, self._problem.groups_left(attack))
            self._outcomes.take_over()
        if len(self._outcomes.left) == known:
            plan = self.columns.rounded(point)
            if self._plan_value(plan) > self._attacks.lower:
                self._attacks.attack(plan)
                self._outcomes.take_over()
        return len(self._outcomes.left) > known

    def _plan_value(self, plan: IntArray) -> float:
        values = self._attacks.problem.objective.values_of
        groups = list(self._attacks.known.values())
        flat = iter(values([plan[sorted(group)].tolist() for parts in groups for group in parts]).tolist())
        return float(min(max(next(flat) for _ in parts) for parts in groups))
