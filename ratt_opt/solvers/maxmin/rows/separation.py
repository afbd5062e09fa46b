"""Rows that a relaxed plan violates: what groups are worth to it by the inequalities known, and by new tangents."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.solvers.maxmin.rows.base_sets import first_of_each_class, semidefinite
from ratt_opt.solvers.maxmin.rows.exchanges import exchanged
from ratt_opt.solvers.maxmin.rows.hulls import as_inequalities, hulls_of
from ratt_opt.solvers.maxmin.rows.inequalities import tangents
from ratt_opt.solvers.maxmin.rows.pool import InequalityPool

if TYPE_CHECKING:
    from ratt_opt._validation import FloatArray
    from ratt_opt.budget import Budget
    from ratt_opt.solvers.maxmin.elements import Choices, Task
    from ratt_opt.solvers.maxmin.outcome_pool import OutcomePool
    from ratt_opt.solvers.maxmin.rows.hulls import TargetHull
    from ratt_opt.solvers.maxmin.rows.pool import Row

__all__ = ["RelaxedGroups", "RowSeparation"]


class RelaxedGroups:
    """Upper bounds on the values of known groups for a relaxed plan, ``selection`` (E,).

    ``points`` : (G, M, d, d) posterior information; ``bounds`` : (G, M) of each target by the inequalities known
    ``exact`` : (G, M) each target's concave value; ``values`` : (G,) of the rows that are lowest with new tangents
    """

    __slots__ = ("bounds", "exact", "points", "selection", "values")

    def __init__(self, selection: FloatArray, points: FloatArray, bounds: FloatArray, exact: FloatArray) -> None:
        self.selection, self.points, self.bounds, self.exact = selection, points, bounds, exact
        self.values = np.asarray(np.minimum(bounds, exact).sum(axis=1))


class RowSeparation:
    """``inequalities`` : those of one problem, for all outcomes and nodes of its search."""

    def __init__(self, task: Task, outcomes: OutcomePool, budget: Budget) -> None:
        self.task, self.outcomes, self.budget, self.params = task, outcomes, budget, task.params.rows
        params = self.params
        self.inequalities = InequalityPool.of(task, params)
        self._first = first_of_each_class(task)
        everything = task.objective.posterior_mixture(np.ones(task.objective.n))
        self._most = task.objective.target_values(everything)
        """(M,) what all elements together are worth for each target."""
        self._mean = np.zeros(task.objective.n)
        self.hulls = hulls_of(task, params, semidefinite(task.objective.information), self._first)

    @staticmethod
    def fits(task: Task) -> bool:
        """Tell whether the criterion is a sum over targets of which robots see few.

        If they see all, tangents of whole groups are as low, and cost less.
        """
        params = task.params.rows
        unseen = 1 - task.objective.information.any(axis=(-2, -1)).mean()
        return task.objective.overrides("target_tangents") and bool(unseen >= params.unseen)

    @staticmethod
    def first_node(task: Task) -> float:
        """Nodes of all searches before rows begin: none if a search in depth seldom ends, infinite without rows."""
        params = task.params.rows
        if not RowSeparation.fits(task):
            return np.inf
        seen = task.objective.information.any(axis=(-2, -1)).sum(axis=1).mean()
        return 0 if seen > params.seen else params.nodes

    def at(self, selection: FloatArray, of_robot: FloatArray) -> RelaxedGroups:
        """Bound the values of groups for a relaxed plan, whose robots contribute ``of_robot`` (N, M, d, d)."""
        objective = self.task.objective
        points = self.outcomes.group_points(of_robot)
        exact = objective.target_values(points)
        bounds = self.inequalities.target_bounds(self.outcomes.membership(), self.inequalities.by_robot(selection))
        return RelaxedGroups(selection, points, bounds, exact)

    def between(self, selection: FloatArray, choices: Choices) -> FloatArray:
        """(E,) a choice between a relaxed plan and a mean of earlier ones, within a node's ``choices``.

        Rows there need fewer rounds than rows at the relaxed plans, which jump from vertex to vertex.

        Source: in-out separation (Ben-Ameur and Neto 2007).
        """
        params, mean = self.params, np.zeros_like(self._mean)
        for choice in choices:
            own = self._mean[choice]
            mean[choice] = own / own.sum() if own.sum() > 0 else selection[choice]
        self._mean = (1 - params.newest) * mean + params.newest * selection
        return np.asarray((1 - params.inward) * selection + params.inward * mean)

    def rows(self, relaxed: RelaxedGroups, groups: list[int], open_value: float) -> list[Row]:
        """The lowest row of each group, with the tangents that lower it by a share of ``open_value``, the node's."""
        self._touch(relaxed, groups, self.params.share * max(open_value, 0.0) / len(self._most))
        return [self.inequalities.row(self.outcomes.groups[g], relaxed.selection) for g in groups]

    def _touch(self, relaxed: RelaxedGroups, groups: list[int], least: float = 0.0) -> None:
        """Keep the tangents at some groups' points of targets whose value there is below what is known by ``least``."""
        lower = (relaxed.exact < relaxed.bounds - np.maximum(self.params.lower * self._most, least))[groups]
        fresh = [
            tangents(self.task.objective, relaxed.points[g], np.flatnonzero(own))
            for g, own in zip(groups, lower, strict=True)
            if own.any()
        ]
        if fresh:
            self.inequalities.add(fresh)

    def row_at(self, group: int, selection: FloatArray) -> Row:
        """The lowest row of one group at a relaxed choice (E,), with new tangents."""
        objective, inside = self.task.objective, np.isin(self.task.problem.robot, self.outcomes.groups[group])
        point = objective.posterior_mixture(selection * inside)
        members = self.outcomes.membership()[group][None]
        bounds = self.inequalities.target_bounds(members, self.inequalities.by_robot(selection))
        relaxed = RelaxedGroups(selection, point[None], bounds, objective.target_values(point)[None])
        self._touch(relaxed, [0])
        return self.inequalities.row(self.outcomes.groups[group], selection)

    def sharpen(self, relaxed: RelaxedGroups, groups: list[int], open_value: float) -> bool:
        """Keep hulls of targets at some groups' points that lower the rows there; whether there are any."""
        params, owner = self.params, self.task.problem.robot
        least = params.hull_gain * max(open_value, 0.0) / len(self._most)
        found: dict[tuple[int, bytes], tuple[int, float, FloatArray]] = {}
        tried = set()
        for g in groups:
            inside = np.isin(owner, self.outcomes.groups[g])
            for j, hull in enumerate(self.hulls):
                if hull is None or self.budget.is_over:
                    continue
                share = np.where(inside, relaxed.selection, 0.0)[hull.elements]
                key = j, share.tobytes()
                if key in tried:
                    continue
                tried.add(key)
                below = float(min(relaxed.bounds[g, j], relaxed.exact[g, j])) - max(least, params.lower * self._most[j])
                inequality = hull.inequality(share, below, params.hull_inexact * least)
                if inequality is not None and inequality[0] + inequality[1] @ share < below:
                    found[key] = j, inequality[0], self._spread(hull, inequality[1])
        if found:
            self.inequalities.add([as_inequalities(list(found.values()))])
        return bool(found)

    def _spread(self, hull: TargetHull, scores: FloatArray) -> FloatArray:
        """(E,) scores of a hull's elements (k,), and of those that are equal to them."""
        every = np.zeros(self.task.objective.n)
        every[hull.elements] = scores
        return np.asarray(every[self._first])

    def learn(self, relaxed: RelaxedGroups, level: float) -> bool:
        """Exchange blinded robots of known outcomes for some that leave rows less than ``level``; whether one does."""
        known = len(self.outcomes)
        if not self.outcomes.complete:
            by_robot = self.inequalities.by_robot(relaxed.selection)
            teams = self.outcomes.outcome_values(relaxed.values)
            lowest = np.argsort(teams, kind="stable")[: self.params.starts].tolist()
            starts = [self.outcomes.attack(o) for o in lowest]
            for attack in exchanged(self.outcomes.problem, self.inequalities, by_robot, starts, (level, self.budget)):
                self.outcomes.add(attack)
        return len(self.outcomes) > known
