"""Upper ends for sums of submodular parts: a linear program over fractional plans, whose multipliers are checked.

An outcome leaves the robots of one group; what a plan's set ``T`` of their elements is worth is at most
``sum_j w_j (alpha_j + beta_j(T))`` for any modular bounds of the parts. With multipliers that add up to one over
outcomes, and over the bounds of a part in proportion, the sum of such inequalities is a constant and a value for each
element: no plan is worth more than the constant and each robot's largest value. The linear program only suggests the
multipliers; the sum is made anew in outward-rounded numbers.

If robots have the same elements and any of them may be blinded, an attack is as good as its images under permutations
of these robots. The mean of all images leaves each robot to a share: one outcome stands for all, and one column for the
elements that are equal.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.highs import LinearProgram, Rows

if TYPE_CHECKING:
    from ratt_opt._validation import FloatArray, IntArray
    from ratt_opt.budget import Budget
    from ratt_opt.problem import Problem
    from ratt_opt.setfunctions.decomposition import Decomposition, Overestimator

__all__ = ["ElementClasses", "RowBound", "RowBoundParams"]


@dataclass(frozen=True, slots=True, kw_only=True)
class RowBoundParams:
    """Effort of the linear program; more of each gives lower upper ends for more time.

    ``most_values`` : values of parts under outcomes that have columns of their own
    ``enough`` : relative fall of the bound in a round below which the round counts as in vain; ``patience`` : rounds
    in vain after which it ends; ``tolerance`` : relative violation of a row that is added
    """

    most_values: int = 6000
    enough: float = 1e-5
    patience: int = 3
    tolerance: float = 1e-9


class ElementClasses:
    """Elements that the linear program need not tell apart: equal ones of robots with equal choices.

    ``column`` : (E,) of each element; ``robots`` : (columns,) robots of its class; ``kind`` : (N,) class of each robot
    """

    def __init__(self, problem: Problem, parts: Decomposition, *, merges: bool) -> None:
        owner, n = problem.robot, problem.objective.n
        looks: IntArray = np.arange(n)
        self.kind: IntArray = np.arange(problem.n_robots)
        if merges:
            bounds = np.zeros((n, parts.n_parts))
            for j in range(parts.n_parts):
                bounds[parts.touching(j), j] = parts.marginal_bounds(j)
            looks = np.unique(bounds, axis=0, return_inverse=True)[1].ravel()
            known: dict[bytes, int] = {}
            for i, choice in enumerate(problem.choices):
                self.kind[i] = known.setdefault(np.sort(looks[choice]).tobytes(), len(known))
        pairs = self.kind[owner] * (n + 1) + looks
        first, self.column = np.unique(pairs, return_index=True, return_inverse=True)[1:]
        self.column = self.column.ravel()
        self.kinds = self.kind[owner[first]]
        self.sizes = np.bincount(self.kind)
        self.count = np.bincount(self.column)
        """Elements of each column."""

    def share(self, point: FloatArray) -> FloatArray:
        """(E,) a fractional plan of the columns' (columns,), even among elements."""
        return np.asarray((point / self.count)[self.column])

    def mean(self, values: FloatArray) -> FloatArray:
        """(columns,) means over each column's elements of (E,) values."""
        return np.asarray(np.bincount(self.column, values, len(self.count)) / self.count)


@dataclass(frozen=True, slots=True, eq=False)
class _Row:
    """A modular bound of one part under one outcome."""

    outcome: int
    part: int
    bound: Overestimator


class RowBound:
    """No plan is worth more than ``upper``, unless it is worth no more than the outcomes' other groups.

    Parameters
    ----------
    problem : its objective is the sum of ``parts``
    outcomes : (N,) each the share of every robot's sensor that is left: a mean of groups that attacks leave
    columns : merged only if every outcome has the same share for all robots of a class
    """

    def __init__(
        self, problem: Problem, parts: Decomposition, columns: ElementClasses, params: RowBoundParams | None = None
    ) -> None:
        self._problem, self._parts, self._columns = problem, parts, columns
        self._params = params or RowBoundParams()
        self._outcomes: list[FloatArray] = []
        self._rows: list[_Row] = []
        self._touching = [parts.touching(j) for j in range(parts.n_parts)]
        self.point = columns.share(columns.mean(1.0 / np.bincount(problem.robot)[problem.robot]) * columns.count)
        self.upper = np.inf

    @property
    def has_room(self) -> bool:
        """True if one more outcome may have columns."""
        return (len(self._outcomes) + 1) * self._parts.n_parts <= self._params.most_values

    def add_outcome(self, left: FloatArray) -> bool:
        """Bound plans under one more outcome; whether it is a new one. Relies on non-decreasing parts."""
        if any(np.array_equal(left, known) for known in self._outcomes):
            return False
        self._outcomes.append(left)
        for j, touching in enumerate(self._touching):
            shares = self._shares(len(self._outcomes) - 1, j)
            self._rows.append(_Row(len(self._outcomes) - 1, j, self._parts.overestimator(j, np.ones(len(touching)))))
            self._rows.append(_Row(len(self._outcomes) - 1, j, self._parts.overestimator(j, shares)))
        return True

    def run(self, budget: Budget, aim: float) -> None:
        """Add rows until that lowers the bound no more, or it is at most ``aim``; raises ``OutOfBudget``."""
        program, in_vain, added = self._program(), 0, len(self._rows)
        while self.upper > aim and in_vain < self._params.patience:
            budget.check()
            before = self.upper
            found = program.solve(budget.seconds_left)
            if not found.is_optimal:
                return
            self._check(found.duals)
            values = found.x[: self._n_values].reshape(len(self._outcomes), -1)
            self.point = self._columns.share(found.x[self._n_values + 1 :])
            if not self._separate(values, budget):
                return
            program.add_rows(self._of(self._rows[added:]))
            added = len(self._rows)
            in_vain = in_vain + 1 if self.upper > before - self._params.enough * abs(before) else 0

    def weakest(self, outcomes: list[FloatArray]) -> FloatArray | None:
        """The outcome, of those given, that leaves least of the fractional plan by the rows known."""
        worth = [self._worth(left) for left in outcomes]
        return outcomes[int(np.argmin(worth))] if worth else None

    def _worth(self, left: FloatArray) -> float:
        share, best = self.point * left[self._problem.robot], np.full(self._parts.n_parts, np.inf)
        for row in self._rows:
            best[row.part] = min(best[row.part], row.bound.at(share[self._touching[row.part]]))
        return float(self._parts.weights @ best)

    def _shares(self, outcome: int, part: int) -> FloatArray:
        touching = self._touching[part]
        return np.asarray(self.point[touching] * self._outcomes[outcome][self._problem.robot[touching]])

    def _separate(self, values: FloatArray, budget: Budget) -> bool:
        """Add the modular bounds that are lower at the point than the program's values; whether there is one."""
        before, tolerance = len(self._rows), self._params.tolerance
        for outcome in range(len(self._outcomes)):
            for part in range(self._parts.n_parts):
                budget.check()
                shares = self._shares(outcome, part)
                bound = self._parts.overestimator(part, shares)
                value = values[outcome, part]
                if bound.at(shares) < value - tolerance * max(abs(value), 1e-300):
                    self._rows.append(_Row(outcome, part, bound))
        return len(self._rows) > before

    # -- the linear program ----------------------------------------------------------------------------------------

    @property
    def _n_values(self) -> int:
        return len(self._outcomes) * self._parts.n_parts

    def _program(self) -> LinearProgram:
        """Columns: a value for each part under each outcome, the least sum, the fractional plan."""
        values, columns, kinds = self._n_values, len(self._columns.count), len(self._columns.sizes)
        parts, weights = self._parts.n_parts, self._parts.weights
        entries: list[tuple[IntArray, FloatArray]] = []
        for outcome in range(len(self._outcomes)):
            own = np.arange(outcome * parts, (outcome + 1) * parts)
            entries.append((np.append(own, values), np.append(-weights, 1.0)))
        for kind in range(kinds):
            own = np.flatnonzero(self._columns.kinds == kind)
            entries.append((own + values + 1, np.ones(len(own))))
        robots = self._columns.sizes.astype(np.float64)
        sides = np.append(np.zeros(len(self._outcomes)), robots)
        lower = np.append(np.full(len(self._outcomes), -np.inf), robots)
        if (limit := self._problem.choice_limit) is not None:
            own = np.setdiff1d(np.arange(columns), self._columns.column[limit.idle])
            entries.append((own + values + 1, np.ones(len(own))))
            sides, lower = np.append(sides, float(limit.most)), np.append(lower, -np.inf)
        cost, least = np.zeros(values + 1 + columns), np.zeros(values + 1 + columns)
        cost[values], least[: values + 1] = 1.0, -np.inf
        program = LinearProgram(cost, least, rows=_rows(entries, lower, sides), maximise=True)
        program.add_rows(self._of(self._rows))
        return program

    def _of(self, rows: list[_Row]) -> Rows:
        entries = []
        for row in rows:
            gains = np.zeros(self._problem.objective.n)
            gains[self._touching[row.part]] = row.bound.gains
            mean = self._columns.mean(gains * self._outcomes[row.outcome][self._problem.robot])
            own = np.flatnonzero(mean)
            value = row.outcome * self._parts.n_parts + row.part
            entries.append((np.append(value, own + self._n_values + 1), np.append(1.0, -mean[own])))
        sides = np.array([row.bound.constant for row in rows])
        return _rows(entries, np.full(len(rows), -np.inf), sides)

    def _check(self, duals: FloatArray) -> None:
        """Lower the bound by the inequality that the multipliers suggest, summed anew."""
        outcomes, parts = len(self._outcomes), self._parts.n_parts
        of_outcome = np.abs(duals[:outcomes])
        limits = int(self._problem.at_most is not None)
        of_row = np.abs(duals[outcomes + len(self._columns.sizes) + limits :])
        place = np.array([row.outcome * parts + row.part for row in self._rows])
        total = np.bincount(place, of_row, outcomes * parts)
        due = np.repeat(of_outcome, parts) * np.tile(self._parts.weights, outcomes)
        scale = np.divide(due, total, out=np.zeros_like(due), where=total > 0)
        multiplier = of_row * scale[place]
        first = {int(at): k for k, at in reversed(list(enumerate(place.tolist())))}
        for at in np.flatnonzero((total <= 0) & (due > 0)):
            multiplier[first[int(at)]] = due[at]
        constant, gains, size, terms = 0.0, np.zeros(self._problem.objective.n), 0.0, 0
        for k in np.flatnonzero(multiplier):
            row = self._rows[k]
            touching = self._touching[row.part]
            left = self._outcomes[row.outcome][self._problem.robot[touching]]
            constant += float(multiplier[k]) * row.bound.constant
            size += float(multiplier[k]) * abs(row.bound.constant)
            gains[touching] += multiplier[k] * (row.bound.gains * left)
            terms += 1
        best = self._best(gains)
        whole = float(of_outcome.sum())
        if whole <= 0:
            return
        # Each term is a product of three numbers; it and each sum round once. Multipliers of a part are in proportion
        # up to four roundings.
        slack = (terms + self._problem.n_robots + outcomes + 10) * np.finfo(np.float64).eps * (size + best)
        self.upper = min(self.upper, float((constant + best + slack) / whole) * (1 + 4 * np.finfo(np.float64).eps))

    def _best(self, gains: FloatArray) -> float:
        """The largest sum of gains (E,) of a plan."""
        choices, limit = self._problem.choices, self._problem.choice_limit
        plan = None if limit is None else limit.best_plan(gains, choices)
        return sum(float(gains[choice].max()) for choice in choices) if plan is None else float(gains[plan].sum())


def _rows(entries: list[tuple[IntArray, FloatArray]], lower: FloatArray, upper: FloatArray) -> Rows:
    columns, values = ([one[k] for one in entries] for k in range(2))
    starts = np.cumsum([0, *map(len, columns)])
    nothing = [np.array([], dtype=np.int64)]
    flat = np.concatenate(values or nothing).astype(np.float64)
    return Rows(lower, upper, starts, np.concatenate(columns or nothing), flat)
