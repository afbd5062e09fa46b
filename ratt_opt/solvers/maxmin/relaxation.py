"""The relaxed plans of a node and the cuts that bound them: solve a program, cut its relaxed plan off, solve again.

:class:`NodeProgram` is the linear program, of which only the multipliers are used; :class:`CutRounds` adds cuts that
its relaxed plan violates. ``cut_store.py`` keeps the cuts.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.highs import LinearProgram, Rows, rows_of
from ratt_opt.solvers.maxmin.rows.separation import RowSeparation

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from ratt_opt._validation import BoolArray, FloatArray, IntArray
    from ratt_opt.choice_limit import ChoiceLimit
    from ratt_opt.solvers.maxmin.adversary import Adversary
    from ratt_opt.solvers.maxmin.cut_store import CutStore
    from ratt_opt.solvers.maxmin.elements import Choices
    from ratt_opt.solvers.maxmin.proof import TreeNode
    from ratt_opt.solvers.maxmin.rows.separation import RelaxedGroups
    from ratt_opt.solvers.maxmin.winners import Winners

__all__ = ["CutRounds", "RelaxedPlan"]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class RelaxedPlan:
    """Solution claimed by the solver: ``selection`` (E,) weights of elements, ``duals`` >= 0 weights of ``cuts``."""

    selection: FloatArray
    cuts: IntArray
    duals: FloatArray
    level: float

    @property
    def is_active(self) -> BoolArray:
        """(K,) which cuts have multipliers beyond the simplex method's rounding: others are left out of a leaf."""
        return self.duals > 1e-12

    @property
    def violated(self) -> float:
        """Level below which a cut counts as violated: lower by more than rounding."""
        return self.level - 1e-10 * abs(self.level)

    def rounded(self, choices: Choices, limit: ChoiceLimit | None = None) -> IntArray:
        """(N,) the element of largest weight of each robot; beyond the limit, robots of small weights are idle."""
        plan = np.array([choice[self.selection[choice].argmax()] for choice in choices])
        return plan if limit is None else limit.rest(plan, self.selection[plan])


class NodeProgram:
    """``max t`` with ``t <= constant_k + scores_k . z`` for the cuts in use, ``sum_e z_e = 1`` for each robot.

    If few robots may be busy, their elements add up to no more.

    One program for the whole search: nodes differ in column bounds and in the cuts they use, so each
    solve starts from the last basis. Only the multipliers are used; every bound is derived from them anew.

    ``choices`` : columns of each robot, or of each class of robots, of ``sizes`` robots each
    ``levels`` : what further columns add to the maximum, which rows may bound in the place of ``t``
    """

    def __init__(
        self,
        n_elements: int,
        choices: Choices,
        limit: ChoiceLimit | None = None,
        sizes: FloatArray | None = None,
        levels: FloatArray | None = None,
    ) -> None:
        levels = np.zeros(0) if levels is None else levels
        self._n, self._first_cut = n_elements + len(levels), len(choices) + (limit is not None)
        sizes = np.ones(len(choices)) if sizes is None else sizes
        zeros = np.zeros(self._n)
        most = np.append(np.full(n_elements, float(sizes.max())), np.full(len(levels), np.inf))
        owners = rows_of([(choice.tolist(), [1.0] * len(choice)) for choice in choices], sizes, sizes)
        cost = np.concatenate([np.zeros(n_elements), levels, [1.0]])
        lower, upper = np.append(zeros, -np.inf), np.append(most, np.inf)
        self._most = most
        self._program = LinearProgram(cost, lower, upper, rows=owners, maximise=True, solver="simplex")
        if limit is not None:
            busy = np.setdiff1d(np.concatenate(choices), limit.idle).tolist()
            self._program.add_rows(rows_of([(busy, [1.0] * len(busy))], -np.inf, float(limit.most)))
        self._allowed = np.ones(self._n, dtype=np.bool_)
        self.in_use: list[int] = []
        """Cuts that are rows now, in row order."""
        self._idle: dict[int, int] = {}
        self._fresh: list[tuple[float, FloatArray, int]] = []
        """Constants, scores and bounded columns of the last cuts in use, whose rows are added before the next solve."""

    def use(self, cut: int, constant: float, scores: FloatArray, level: int | None = None) -> None:
        """Add one cut as a row; ``level`` : the column that it bounds in the place of ``t``."""
        self._fresh.append((constant, scores, self._n if level is None else level))
        self.in_use.append(cut)
        self._idle[cut] = 0

    def _add_fresh(self) -> None:
        if not self._fresh:
            return
        columns = [np.append(np.flatnonzero(scores), level) for _, scores, level in self._fresh]
        values = [np.append(-scores[own[:-1]], 1.0) for own, (_, scores, _) in zip(columns, self._fresh, strict=True)]
        rows = Rows(
            lower=np.full(len(columns), -np.inf),
            upper=np.array([constant for constant, _, _ in self._fresh]),
            starts=np.cumsum([0, *map(len, columns)]),
            columns=np.concatenate(columns),
            values=np.concatenate(values),
        )
        self._program.add_rows(rows)
        self._fresh.clear()

    def drop(self, gone: Callable[[int], bool]) -> None:
        """Remove the rows of cuts for which ``gone`` is true."""
        self._add_fresh()
        positions = [position for position, cut in enumerate(self.in_use) if gone(cut)]
        if positions:
            self._program.delete_rows(np.array(positions) + self._first_cut)
            for position in positions:
                del self._idle[self.in_use[position]]
            kept = set(positions)
            self.in_use = [cut for position, cut in enumerate(self.in_use) if position not in kept]

    def drop_idle(self, patience: int) -> None:
        """Remove cuts whose multiplier was zero in the last ``patience`` solves."""
        self.drop(lambda cut: self._idle[cut] > patience)

    def allow(self, choices: Choices) -> None:
        """Set which elements may be chosen."""
        allowed: BoolArray = np.zeros(self._n, dtype=np.bool_)
        allowed[np.concatenate(choices)] = True
        for e in np.flatnonzero(allowed != self._allowed).tolist():
            self._program.bound_column(e, 0.0, 1.0 if allowed[e] else 0.0)
        self._allowed = allowed

    def within(self, lower: FloatArray, upper: FloatArray) -> None:
        """Set at least and at most how many robots choose each column."""
        self._program.bound_columns(lower, upper)

    def solve(self, seconds: float = np.inf) -> RelaxedPlan | None:
        """Solve within that many seconds and return what HiGHS claims, or ``None`` when it claims no optimum."""
        self._add_fresh()
        claim = self._program.solve(seconds)
        if not claim.is_optimal:
            return None
        duals = np.abs(claim.duals[self._first_cut :])
        for cut, dual in zip(self.in_use, duals, strict=True):
            self._idle[cut] = 0 if dual > 0 else self._idle[cut] + 1
        columns = claim.x[: self._n]
        selection = np.where(columns > 1e-12, np.minimum(columns, self._most), 0.0)  # others are its rounding
        cuts, level = np.array(self.in_use, dtype=np.int64), float(claim.x[self._n])
        return RelaxedPlan(selection=selection, cuts=cuts, duals=duals, level=level)


class CutRounds:
    """The cuts in use at a node: usable ones that were stored, and tangents if its relaxed plan violates none.

    ``rows_from`` : nodes of all searches after which rows may take the place of tangents
    """

    def __init__(self, cuts: CutStore, winners: Winners, adversary: Adversary, *, rows_from: float) -> None:
        self.task, self.pool = cuts.task, cuts.pool
        self.cuts, self.winners, self.adversary, self._rows_from = cuts, winners, adversary, rows_from
        self._solves, self._params = 0, self.task.params.rows
        self._program = NodeProgram(self.task.objective.n, self.task.choices, self.task.problem.choice_limit)

    @property
    def begins_with_rows(self) -> bool:
        """True if rows are used from the first nodes on."""
        return self._rows_from == 0

    def use(self, k: int) -> None:
        """Bring cut ``k`` into the program."""
        self._program.use(k, float(self.cuts.constants[k]), self.cuts.scores(k))

    def begin(self, node: TreeNode) -> None:
        """Leave out what is not usable at a node; give it a cut on every decided outcome if it has none."""
        winners = self.winners.at(node)
        usable = self.cuts.usable(winners)
        self._program.drop(lambda k: not usable[k])
        self._program.drop_idle(self.task.params.rounds.patience)
        if self._program.in_use:
            return
        best = np.array([choice[self.task.singles[choice].argmax()] for choice in node.choices])
        points = self.pool.group_points(self.task.objective.information[best])
        for outcome, winner in enumerate(winners.tolist()):
            if winner >= 0 and len(self._program.in_use) < self.task.params.rounds.cuts:
                self.use(self.cuts.touching(outcome, winner, best, points[winner]))

    def solve(self, node: TreeNode) -> RelaxedPlan | None:
        """The relaxed plan of a node under the cuts in use, or ``None`` if HiGHS claims none."""
        self._program.allow(node.choices)
        self._solves += 1
        relaxed = self._program.solve(self.adversary.budget.seconds_left)
        budget = self.adversary.budget
        may_begin = self.cuts.rows is None and budget.nodes >= self._rows_from and not budget.is_over
        if may_begin and (relaxed is None or self._solves > self._params.rounds):
            self._begin_rows(node)
            relaxed = self._program.solve(self.adversary.budget.seconds_left)
        return relaxed

    def _begin_rows(self, node: TreeNode) -> None:
        """Let cuts be rows from now on, and leave tangents of whole groups out of the program."""
        self.cuts.rows = RowSeparation(self.task, self.pool, self.adversary.budget)
        self._program.drop(lambda _: True)
        self.begin(node)

    def separate(self, node: TreeNode, relaxed: RelaxedPlan) -> bool:
        """Use cuts that the relaxed plan violates; False when no stored, known or new outcome has one."""
        level = relaxed.violated
        of_robot = self.task.mixed(relaxed.selection)
        if self.cuts.rows is not None:
            return self._separate_by_rows(self.cuts.rows, node, relaxed.selection, (of_robot, level))
        values = self.pool.group_values(of_robot)
        if self._use_stored(node, relaxed.selection, values, level):
            return True
        if self._cut_known(node, of_robot, values, level):
            return True
        return self.adversary.learn_relaxed(of_robot) and self._cut_known(
            node, of_robot, self.pool.group_values(of_robot), level
        )

    def _separate_by_rows(
        self, rows: RowSeparation, node: TreeNode, selection: FloatArray, at: tuple[FloatArray, float]
    ) -> bool:
        """Separate by rows; ``at`` : information of each robot (N, M, d, d), and the level.

        Rows are taken between the relaxed plan and a mean of those before, if that cuts it off.
        """
        of_robot, level = at
        between = rows.between(selection, node.choices)
        if self._use_rows(rows, node, rows.at(between, self.task.mixed(between)), (selection, level)):
            return True
        groups = rows.at(selection, of_robot)
        if self._use_stored(node, selection, groups.values, level):
            return True
        if self._use_rows(rows, node, groups, (selection, level)):
            return True
        if rows.learn(groups, level) and self._use_rows(rows, node, rows.at(selection, of_robot), (selection, level)):
            return True
        return self.adversary.learn_relaxed(of_robot) and self._use_rows(
            rows, node, rows.at(selection, of_robot), (selection, level)
        )

    def sharpen(self, node: TreeNode, relaxed: RelaxedPlan) -> bool:
        """Use rows of hulls at the relaxed plan, if there are rows; whether they cut it off."""
        if (rows := self.cuts.rows) is None:
            return False
        level, selection = relaxed.violated, relaxed.selection
        of_robot = self.task.mixed(selection)
        groups = rows.at(selection, of_robot)
        binding = self.cuts.groups[relaxed.cuts[np.argsort(-relaxed.duals, kind="stable")]]
        lowest = list(dict.fromkeys(binding.tolist()))[: self._params.hull_groups]
        if not rows.sharpen(groups, lowest, level - self.winners.plans.level):
            return False
        return self._use_rows(rows, node, rows.at(selection, of_robot), (selection, level))

    def _use_rows(
        self, rows: RowSeparation, node: TreeNode, groups: RelaxedGroups, off: tuple[FloatArray, float]
    ) -> bool:
        """Add the lowest rows of known outcomes that are below the level ``off`` at a relaxed plan; whether any are."""
        selection, level = off
        outcome_of: dict[int, int] = {}
        for outcome, winner in self._violated(node, groups.values, level):
            outcome_of.setdefault(winner, outcome)
            if len(outcome_of) >= self.task.params.rounds.cuts:
                break
        winners, added = list(outcome_of), False
        for winner, row in zip(winners, rows.rows(groups, winners, level - self.winners.plans.level), strict=True):
            if row.constant + float(row.scores @ selection) < level:
                self.use(self.cuts.add(outcome_of[winner], winner, row))
                added = True
        return added

    def _use_stored(self, node: TreeNode, selection: FloatArray, values: FloatArray, level: float) -> bool:
        """Bring back stored cuts that the relaxed plan violates by much of what a new cut could."""
        winners = self.winners.at(node)
        lowest = float(values[winners[winners >= 0]].min(initial=np.inf))
        deepest = level - self.task.params.rounds.deep * max(level - lowest, 0.0)
        bounds = self.cuts.bounds(selection)
        usable = self.cuts.usable(winners) & (bounds < deepest)
        usable[self._program.in_use] = False
        candidates = np.flatnonzero(usable)
        for k in candidates[np.argsort(bounds[candidates], kind="stable")][: self.task.params.rounds.cuts].tolist():
            self.use(k)
        return len(candidates) > 0

    def _cut_known(self, node: TreeNode, of_robot: FloatArray, values: FloatArray, level: float) -> bool:
        """Add tangents at the relaxed plan for the known outcomes of smallest value below ``level``."""
        objective = self.task.objective
        cut_groups: set[int] = set()
        for outcome, winner in self._violated(node, values, level):
            if len(cut_groups) >= self.task.params.rounds.cuts:
                break
            if winner in cut_groups:
                continue
            members = list(self.pool.groups[winner])
            point = np.asarray(objective.prior_information + of_robot[members].sum(axis=0))
            for target in objective.tangent_targets(point, level, self.task.params.rounds.targets):
                self.use(self.cuts.tangent(outcome, winner, point, target))
            cut_groups.add(winner)
        return bool(cut_groups)

    def _violated(self, node: TreeNode, values: FloatArray, level: float) -> Iterator[tuple[int, int]]:
        """Known outcomes below ``level`` whose winner is decided, the smallest first, with the winner."""
        teams = self.pool.outcome_values(values)
        for outcome in np.argsort(teams, kind="stable").tolist():
            if teams[outcome] >= level:
                return
            winner = self.winners.of(node, outcome)
            if winner is not None and values[winner] < level:
                yield outcome, winner
