"""Rows of sums of best elements whose robots may be exchanged: values in the mean of all losses, and blinded regions.

Any robot may be blinded, and robots have equal elements: so plans are numbers of robots that choose each column. Each
part has a level of its own in the linear program, bounded by its mean over all losses (``mean_losses.py``); further
rows bound the sum after an attack that blinds all robots in some regions (``regions.py``) and loses the rest of its
budget alike. Of the linear program only the multipliers are used: the combined row is made anew, and bounds the plans
of a node by its largest value. Rows that state how many robots choose in a region are relaxed by their multipliers.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from ratt_opt.solvers.by_values.columns import CountedRegion
from ratt_opt.solvers.by_values.kept_rows import KeptRows
from ratt_opt.solvers.by_values.mean_losses import MeanLosses
from ratt_opt.solvers.by_values.part_row import NUMBER, SUM, PartRow
from ratt_opt.solvers.by_values.regions import RegionChoice
from ratt_opt.solvers.maxmin.relaxation import NodeProgram

if TYPE_CHECKING:
    from ratt_opt._validation import BoolArray, FloatArray
    from ratt_opt.budget import Budget
    from ratt_opt.problem import Problem
    from ratt_opt.setfunctions.best_elements import BestElements
    from ratt_opt.solvers.by_values.columns import PlanColumns, PlanNode
    from ratt_opt.solvers.by_values.plan_attacks import PlanAttacks
    from ratt_opt.solvers.maxmin.params import MaxMinParams

__all__ = ["RegionRows"]


class _Wiped(NamedTuple):
    """Columns that are not ``kept`` (columns,) are blinded: those of some regions, of at most ``robots`` robots."""

    kept: BoolArray
    robots: int
    regions: tuple[CountedRegion, ...]


class RegionRows(KeptRows):
    """The rows known bound the plans of any node; ``columns`` : merged ones of the linear program."""

    leaves_out = False
    """No group of an outcome is left out."""

    def __init__(
        self, problem: Problem, f: BestElements, columns: PlanColumns, attacks: PlanAttacks, params: MaxMinParams
    ) -> None:
        self._attacks, self._of_regions = attacks, params.regions
        self._n, self._parts = len(columns.kinds), f.n_parts
        first = np.unique(columns.column, return_index=True)[1]
        utility = np.ascontiguousarray((f.utility[first] * f.weights).T)
        robots, lost = problem.n_robots, problem.threat.n_blinded
        self._means = MeanLosses(utility, robots, lost, params.regions.block)
        self._choice = RegionChoice(self._means, params.regions)
        self._single = [CountedRegion(one, 1) for one in np.eye(self._n, dtype=np.bool_)]
        # The last level is the number of robots by which regions are violated: a plan pays with all that there is.
        costs = np.append(np.zeros(self._parts), float(utility.max(axis=1, initial=0.0).sum()))
        program = NodeProgram(self._n, columns.of_kind, None, columns.sizes, costs)
        super().__init__(columns, program, f.spacing, params, self._parts)

    def begin(self, node: PlanNode, budget: Budget) -> None:
        """Leave out rows that do not hold at a node, and those that were of no use lately."""
        budget.check()
        self._program.drop_idle(self._params.patience)
        self._program.drop(lambda k: not self._holds(self._rows[k], node))
        self._keep_those_in_use()
        free = np.zeros(self._parts)
        lower, upper = np.concatenate([node.lower, free, [-np.inf]]), np.concatenate([node.upper, free + np.inf, [0.0]])
        self._program.within(lower, upper)
        known = {row.part for row in self._rows.values()}
        constants, gains = self._means.bounds(np.zeros(self._n))
        for j in range(self._parts):
            if j not in known:
                self._state(PartRow(float(constants[j]), gains[j], part=j))
        if SUM not in known:
            self._state(PartRow(0.0, np.zeros(self._n), part=SUM))
        stated = {row.regions[0] for row in self._rows.values() if row.part == NUMBER}
        for one, sign in [*((one, -1.0) for one in node.within), *((one, 1.0) for one in node.beyond)]:
            if one not in stated:
                self._state(
                    PartRow(-sign * (one.most + (sign > 0)), np.where(one.columns, sign, 0.0), (one,), part=NUMBER)
                )

    @staticmethod
    def _holds(row: PartRow, node: PlanNode) -> bool:
        """Tell whether the regions that a row needs are those of a node."""
        if row.part == NUMBER:
            return row.regions[0] in (node.within if row.constant > 0 else node.beyond)
        return all(one in node.within or _is_single(one, node) for one in row.regions)

    def _state(self, row: PartRow) -> None:
        """Add one row to the program, with its part of the levels."""
        levels = np.zeros(self._parts + 1)
        if row.part == SUM:
            levels[:-1] = 1.0
        level = {NUMBER: self._n + self._parts}.get(row.part, self._n + row.part if row.part >= 0 else None)
        self._use(row, np.append(row.scores, levels), level)

    def separate(self, node: PlanNode, point: FloatArray, level: float, budget: Budget) -> bool:
        """Add rows that cut a fractional plan (columns,) off; whether there are any.

        Rows are taken between the plan and a mean of earlier ones, too, which needs fewer rounds.
        """
        budget.check()
        tolerance = self._params.tolerance
        point, values = point[: self._n], point[self._n : self._n + self._parts]
        between, made = self._inward(node, point), self._made
        for at in (between, point):
            constants, gains = self._means.bounds(at)
            below = constants + gains @ point < values - tolerance * np.abs(values)
            for j in np.flatnonzero(below).tolist():
                self._state(PartRow(float(constants[j]), gains[j], part=j))
        goal = level - tolerance * abs(level)
        wiped = {one.kept.tobytes(): one for at in (between, point) for one in self._wiped(at, node, goal)}
        for one in wiped.values():
            self._add_wiped(one, (between, point), goal)
        if self._made == made:
            self._attacks.attack_if_better(self.columns.rounded(point))
        return self._made > made

    def _add_wiped(self, one: _Wiped, plans: tuple[FloatArray, FloatArray], goal: float) -> None:
        """Add the first row at one of the plans that is below a goal at the last one."""
        for at in plans:
            constants, gains = self._means.bounds(at, one.kept, one.robots)
            row = PartRow(float(constants.sum()), gains.sum(axis=0), one.regions)
            if row.constant + float(row.scores @ plans[-1]) < goal:
                self._state(row)
                return

    def _wiped(self, point: FloatArray, node: PlanNode, goal: float) -> list[_Wiped]:
        """Sets of regions whose loss leaves least of a fractional plan, less than a goal."""
        lost, most = self._means.lost, self._params.rows
        singles = np.flatnonzero((point > self._of_regions.single) & (node.upper <= 1)).tolist()
        options = [one for one in node.within if one.most <= lost] + [self._single[c] for c in singles]
        longest, found = [_Wiped(np.ones(self._n, dtype=np.bool_), 0, ())], list[tuple[float, _Wiped]]()
        while True:
            trials: dict[bytes, _Wiped] = {}
            for known in longest:
                for one in options:
                    if known.robots + one.most <= lost and (known.kept & one.columns).any():
                        kept = known.kept & ~one.columns
                        trials.setdefault(kept.tobytes(), _Wiped(kept, known.robots + one.most, (*known.regions, one)))
            if not trials:
                break
            tried = list(trials.values())
            values = self._means.values(
                point, np.array([one.kept for one in tried]), np.array([one.robots for one in tried])
            )
            lowest = np.argsort(values, kind="stable")[:most].tolist()
            longest = [tried[k] for k in lowest]
            found += [(float(values[k]), tried[k]) for k in lowest if values[k] < goal]
        return [one for _, one in sorted(found, key=lambda pair: pair[0])[:most]]

    def children(self, node: PlanNode, point: FloatArray, bound: float) -> list[PlanNode]:
        """Divide a node at a fractional plan: by a region, or by how many robots choose one column."""
        region = self._choice.at(node, point[: self._n], bound, self._attacks.lower)
        if region is None:
            return self.columns.children(node, point)
        return [
            replace(node, within=(*node.within, region), is_first=False),
            replace(node, beyond=(*node.beyond, region), is_first=False),
        ]


def _is_single(region: CountedRegion, node: PlanNode) -> bool:
    return int(region.columns.sum()) == 1 and bool(node.upper[region.columns] <= 1)
