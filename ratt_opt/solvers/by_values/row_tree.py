"""Best plans of sums of parts by branch and bound: rows of modular bounds, part by part, over fractional plans.

An outcome leaves the robots of one group; what a plan's set ``T`` of their elements is worth is at most
``sum_j w_j (alpha_j + beta_j(T))`` for any modular bounds of the parts. A *row* takes for each part the bound that is
lowest at the fractional plan in hand. Bounds of parts are kept in one pool: they serve every outcome and every node. Of
the linear program only the multipliers are used: the combined row is made anew, and bounds the plans of a node by its
largest value. A node is divided into all elements of one robot.

If robots have the same elements and any of them may be blinded, an attack is as good as its images under permutations
of these robots. The mean of all images leaves each robot to a share: one outcome stands for all, and one column for the
elements that are equal. A node is then divided by how many robots choose elements of one column.
"""

from __future__ import annotations

from dataclasses import dataclass
from heapq import heappop, heappush
from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.bounds.cuts import ROUNDING
from ratt_opt.budget import OutOfBudget, Stop
from ratt_opt.solvers.by_values.columns import Columns
from ratt_opt.solvers.by_values.outcome_rows import OutcomeRows, blinds_alone
from ratt_opt.solvers.by_values.plan_tree import Pooled
from ratt_opt.solvers.by_values.whole_function import WholeFunction
from ratt_opt.solvers.maxmin.params import RowParams
from ratt_opt.solvers.maxmin.relaxation import NodeProgram
from ratt_opt.solvers.maxmin.rows.exchanges import exchanged
from ratt_opt.solvers.maxmin.rows.inequalities import Inequalities, TargetInequality
from ratt_opt.solvers.maxmin.rows.pool import InequalityPool

if TYPE_CHECKING:
    from ratt_opt._validation import FloatArray, IntArray
    from ratt_opt.budget import Budget
    from ratt_opt.problem import Problem
    from ratt_opt.setfunctions.base import SetFunction
    from ratt_opt.setfunctions.decomposition import Decomposition, Overestimator
    from ratt_opt.solvers.by_values.columns import Node
    from ratt_opt.solvers.by_values.plan_attacks import PlanAttacks
    from ratt_opt.solvers.maxmin.relaxation import RelaxedPlan

__all__ = ["RowTree", "RowTreeParams", "down_to_multiple", "parts_of"]


@dataclass(frozen=True, slots=True, kw_only=True)
class RowTreeParams:
    """Effort of one node; more of each gives fewer nodes for more time.

    ``rows`` : rows added in one round; ``fresh`` : outcomes whose parts get new bounds in one round
    ``tolerance`` : relative violation of a row that is added
    ``deep`` : share of what is open by which rows of bounds known have to cut, so that none are looked for
    ``stall`` : share of what is open at a node that a round has to close; ``at_root``, ``elsewhere`` : rounds that
        close less after which the node is divided
    ``patience`` : solves without a multiplier after which a row leaves the program
    """

    rows: int = 8
    fresh: int = 2
    tolerance: float = 1e-9
    deep: float = 0.1
    stall: float = 0.03
    at_root: int = 12
    elsewhere: int = 2
    patience: int = 8


def down_to_multiple(bound: float, spacing: float) -> float:
    """The largest value that is at most a bound, if all are multiples of a spacing that is not 0."""
    if spacing <= 0 or not np.isfinite(bound):
        return bound
    return spacing * float(np.floor(bound / spacing * (1 + ROUNDING)))


def parts_of(f: SetFunction, asked: SetFunction) -> Decomposition | None:
    """The parts of ``f``; all of it as one part if it is submodular, valued as ``asked``; ``None`` otherwise."""
    parts = f.decomposition()
    if parts is not None and parts.is_sum:
        return parts
    return WholeFunction(asked) if f.is_submodular else None


class RowTree:
    """The nodes that are left; valid at any moment.

    ``single`` : (E,) individual values if the function is submodular
    ``known`` : what bounds all plans, and the budget of the first bounds, which raise ``OutOfBudget``
    """

    def __init__(
        self,
        problem: Problem,
        parts: Decomposition,
        attacks: PlanAttacks,
        single: FloatArray | None,
        known: tuple[float, Budget],
    ) -> None:
        upper, budget = known
        self._problem, self._parts, self._attacks = problem, parts, attacks
        self._params, self._spacing = RowTreeParams(), problem.objective.spacing
        only_blinds = blinds_alone(problem)
        merges = only_blinds and not problem.threat.protected_robots and not isinstance(parts, WholeFunction)
        self._columns = Columns(problem, parts, merges=merges)
        self._touching = [parts.touching(j) for j in range(parts.n_parts)]
        self._pool = InequalityPool(problem.robot, parts.n_parts, self._first_bounds(budget), RowParams())
        self._program = NodeProgram(
            len(self._columns.kinds), self._columns.of_kind, self._columns.limit, self._columns.sizes
        )
        self._rows: dict[int, tuple[float, FloatArray]] = {}
        self._made = 0
        self._outcomes = OutcomeRows(attacks, self._columns, None if only_blinds else Pooled(problem, single))
        self._mean = np.zeros(len(self._columns.kinds))
        self._open: list[tuple[float, int, Node]] = [(-upper, 0, self._columns.root())]
        self._count, self._settled = 0, -np.inf
        self._point = self._columns.middle()

    @property
    def upper(self) -> float:
        """No plan is worth more, unless it is worth no more than the best plan known."""
        return max(self.bound, self._attacks.lower)

    @property
    def bound(self) -> float:
        """The bound of the rows themselves: less than the best plan's worst case only if a property is not kept."""
        return max(self._settled, -self._open[0][0] if self._open else -np.inf)

    @property
    def relies_on_caps(self) -> bool:
        """True if groups of some outcomes were left out, as they are worth no more than the best plan."""
        return self._outcomes.leaves_out

    @property
    def is_finished(self) -> bool:
        """True if dividing can prove no more."""
        return not self._open or self._settled >= -self._open[0][0]

    @property
    def is_at_root(self) -> bool:
        """True if nothing is divided yet."""
        return self._count == 0 and bool(self._open)

    def rounded(self) -> IntArray:
        """(N,) a plan near the last fractional one."""
        return self._columns.rounded(self._point)

    def divide(self, budget: Budget) -> None:
        """Bound the node of the largest bound, then close or divide it; raises ``OutOfBudget``."""
        bound, _, node = self._open[0]
        best = -bound
        if best > self._attacks.lower:
            budget.nodes += 1
            best = self._bounded(node, best, budget)
        children = [] if best <= self._attacks.lower else self._divided(node, best, budget)
        heappop(self._open)
        for child in children:
            self._count += 1
            heappush(self._open, (-best, self._count, child))

    # -- one node --------------------------------------------------------------------------------------------------

    def _bounded(self, node: Node, best: float, budget: Budget) -> float:
        """Bound a node by rounds of rows; its bound in the heap falls with them."""
        params, stalls = self._params, 0
        allowed = params.at_root if self._count == 0 else params.elsewhere
        self._outcomes.take_over()
        self._program.drop_idle(params.patience)
        self._rows = {k: self._rows[k] for k in self._program.in_use}
        self._program.within(node.lower, node.upper)
        if not self._program.in_use:
            self._separate(node, self._columns.middle_of(node), np.inf, budget)
        while stalls <= allowed:
            budget.check()
            relaxed = self._program.solve(budget.seconds_left)
            if relaxed is None:
                break
            self._point, before = relaxed.selection, best
            best = min(best, self._largest(relaxed, node))
            self._open[0] = (-best, *self._open[0][1:])
            if best <= self._attacks.lower:
                break
            if not self._separate(node, relaxed.selection, relaxed.level, budget):
                break
            is_stall = before - best < params.stall * (best - self._attacks.lower)
            stalls = stalls + 1 if is_stall else 0
        return best

    def _divided(self, node: Node, best: float, budget: Budget) -> list[Node]:
        """The parts of a node; none if it is one plan, which is attacked."""
        children = self._columns.children(node, self._point)
        if children:
            return children
        if not self._columns.merges:
            found = self._attacks.settle(self._columns.rounded(self._columns.middle_of(node)), -np.inf)
            best = min(best, found.upper)
            if best > self._attacks.lower and found.stop in {Stop.TIME, Stop.EVALUATIONS}:
                budget.check()
                raise OutOfBudget(found.stop)
        if best > self._attacks.lower:
            self._settled = max(self._settled, best)
        return []

    def _largest(self, relaxed: RelaxedPlan, node: Node) -> float:
        """The largest value of the rows combined by the multipliers, over the plans of a node."""
        active = np.flatnonzero(relaxed.duals > 0)
        if not len(active):
            return np.inf
        rows = relaxed.cuts[active].tolist()
        weights = relaxed.duals[active] / relaxed.duals[active].sum()
        constants = np.array([self._rows[k][0] for k in rows])
        combined = weights @ np.array([self._rows[k][1] for k in rows])
        constant, gains = float(weights @ constants), self._columns.largest(combined, node)
        bound = constant + gains + ROUNDING * (float(np.abs(weights * constants).sum()) + abs(gains))
        return down_to_multiple(bound, self._spacing)

    # -- rows ------------------------------------------------------------------------------------------------------

    def _separate(self, node: Node, point: FloatArray, level: float, budget: Budget) -> bool:
        """Add rows that cut a fractional plan (columns,) off, by bounds known or new ones; whether there are any.

        Rows are taken between the plan and a mean of earlier ones first, which needs fewer rounds.
        """
        params = RowParams()
        self._mean = self._columns.within(self._mean, node, point)
        self._mean = (1 - params.newest) * self._mean + params.newest * point
        between = (1 - params.inward) * point + params.inward * self._mean
        goal = level - self._params.tolerance * abs(level) if level < np.inf else level
        deep = goal - self._params.deep * max(goal - self._attacks.lower, 0.0) if level < np.inf else level
        if self._add_rows(between, point, deep, 0, budget):
            return True
        if self._add_rows(between, point, goal, self._params.fresh, budget):
            return True
        if self._add_rows(point, point, goal, self._params.fresh, budget):
            return True
        return self._learn(point, goal, budget) and self._add_rows(point, point, goal, self._params.fresh, budget)

    def _add_rows(self, at: FloatArray, point: FloatArray, goal: float, fresh: int, budget: Budget) -> bool:
        """Add the lowest rows at one plan that are below a goal at another one; whether there are any."""
        share = self._columns.share(at)
        worth = self._pool.target_bounds(self._outcomes.left, self._pool.by_robot(share)).sum(axis=1)
        order, added = np.argsort(worth, kind="stable")[: self._params.rows].tolist(), False
        for outcome in order[:fresh]:
            self._add_bounds(outcome, share, budget)
        whole = self._columns.share(point)
        for outcome in order:
            constant, scores = self._pool.combined(self._outcomes.left[outcome], share)
            if constant + float(scores @ whole) < goal:
                self._program.use(self._made, constant, self._columns.mean(scores))
                self._rows[self._made] = constant, scores
                self._made += 1
                added = True
        return added

    def _add_bounds(self, outcome: int, share: FloatArray, budget: Budget) -> None:
        """Keep bounds of parts that are lower than those known at what an outcome leaves of a fractional plan."""
        left = share * self._outcomes.left[outcome][self._problem.robot]
        known = self._pool.target_bounds(self._outcomes.left[outcome][None], self._pool.by_robot(share))[0]
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

    # -- outcomes --------------------------------------------------------------------------------------------------

    def _learn(self, point: FloatArray, goal: float, budget: Budget) -> bool:
        """Look for outcomes that leave less of a fractional plan, then attack a plan near it; whether one is new."""
        known = len(self._outcomes.left)
        if not self._columns.merges:
            by_robot = self._pool.by_robot(self._columns.share(point))
            worth = self._pool.target_bounds(self._outcomes.left, by_robot).sum(axis=1)
            starts = [
                self._outcomes.attacks[k] for k in np.argsort(worth, kind="stable")[: RowParams().starts].tolist()
            ]
            for attack in exchanged(self._problem, self._pool, by_robot, starts, (goal, budget)):
                self._attacks.known.setdefault(attack, self._problem.groups_left(attack))
            self._outcomes.take_over()
        if len(self._outcomes.left) == known:
            plan = self._columns.rounded(point)
            if self._plan_value(plan) > self._attacks.lower:
                self._attacks.attack(plan)
                self._outcomes.take_over()
        return len(self._outcomes.left) > known

    def _plan_value(self, plan: IntArray) -> float:
        values = self._attacks.problem.objective.values_of
        groups = list(self._attacks.known.values())
        flat = iter(values([plan[sorted(group)].tolist() for parts in groups for group in parts]).tolist())
        return float(min(max(next(flat) for _ in parts) for parts in groups))
