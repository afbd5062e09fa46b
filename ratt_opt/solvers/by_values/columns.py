"""Columns of a linear program over plans: elements that need not be told apart, and the plans of a node by columns."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from ratt_opt._validation import BoolArray, FloatArray, IntArray
    from ratt_opt.problem import Problem
    from ratt_opt.setfunctions.decomposition import Decomposition

__all__ = ["WHOLE", "CountedRegion", "PlanColumns", "PlanNode"]

WHOLE = 1e-6
"""Distance from a whole number up to which a number of robots counts as whole."""


@dataclass(frozen=True, slots=True, eq=False)
class CountedRegion:
    """Columns (columns,) of which at most ``most`` robots choose one, or of which more do."""

    columns: BoolArray
    most: int


@dataclass(frozen=True, slots=True, eq=False)
class PlanNode:
    """Plans of which at least ``lower`` and at most ``upper`` (columns,) robots choose elements of each column.

    ``within``, ``beyond`` : regions in which at most their number of robots choose, and in which more do
    ``is_first`` : nothing is decided; what follows inherits its rows
    """

    lower: FloatArray
    upper: FloatArray
    within: tuple[CountedRegion, ...] = ()
    beyond: tuple[CountedRegion, ...] = ()
    is_first: bool = False


class PlanColumns:
    """Elements that the linear program need not tell apart: equal ones of robots with equal choices.

    ``column`` : (E,) of each element; ``kind`` : (N,) class of each robot, and ``kinds`` : (columns,) theirs
    ``sizes`` : (kinds,) robots; ``of_kind`` : columns of each kind
    ``limit`` : on how many robots are busy; columns are the elements then

    Parameters
    ----------
    merges : whether robots may be exchanged, as any of them may be blinded alike; otherwise, and if no two have equal
        choices, the columns are the elements
    """

    def __init__(self, problem: Problem, parts: Decomposition, *, merges: bool) -> None:
        owner, n = problem.robot, problem.objective.n
        looks: IntArray = np.arange(n)
        self.kind: IntArray = np.arange(problem.n_robots)
        self.limit = problem.choice_limit
        if merges and self.limit is None:
            bounds = np.zeros((n, parts.n_parts))
            for j in range(parts.n_parts):
                bounds[parts.touching(j), j] = parts.marginal_bounds(j)
            looks = np.unique(bounds, axis=0, return_inverse=True)[1].ravel()
            known: dict[bytes, int] = {}
            for i, choice in enumerate(problem.choices):
                self.kind[i] = known.setdefault(np.sort(looks[choice]).tobytes(), len(known))
            if len(known) == problem.n_robots:
                looks = np.arange(n)
        pairs = np.stack([looks, self.kind[owner]])
        first, self.column = np.unique(pairs, axis=1, return_index=True, return_inverse=True)[1:]
        self.column = self.column.ravel()
        self.kinds = self.kind[owner[first]]
        self.sizes = np.bincount(self.kind).astype(np.float64)
        self.of_kind = tuple(np.flatnonzero(self.kinds == kind) for kind in range(len(self.sizes)))
        self.merges = bool((self.sizes > 1).any())
        self._choices = problem.choices

    def root(self) -> PlanNode:
        """All plans."""
        return PlanNode(np.zeros(len(self.kinds)), self.sizes[self.kinds], is_first=True)

    def middle_of(self, node: PlanNode) -> FloatArray:
        """(columns,) a fractional plan that has all elements of a node alike."""
        return self.within(np.zeros(len(self.kinds)), node, (node.upper > 0).astype(np.float64))

    def within(self, point: FloatArray, node: PlanNode, otherwise: FloatArray) -> FloatArray:
        """(columns,) a fractional plan moved to those that a node allows, kind by kind; ``otherwise`` if none is near.

        A column may stay beyond its upper end.
        """
        moved = np.where(node.upper > 0, np.maximum(point, node.lower), 0.0)
        total = np.bincount(self.kinds, moved, len(self.sizes))[self.kinds]
        other = np.bincount(self.kinds, otherwise, len(self.sizes))[self.kinds]
        sizes = self.sizes[self.kinds]
        scaled = np.divide(moved * sizes, total, out=np.zeros_like(moved), where=total > 0)
        return np.asarray(np.where(total > 0, scaled, otherwise * sizes / np.maximum(other, WHOLE)))

    def largest(self, gains: FloatArray, node: PlanNode) -> float:
        """The largest sum of gains (columns,) over the plans of a node; minus infinity if there is none."""
        if self.limit is not None:
            plan = self.limit.best_plan(gains, [own[node.upper[own] > 0] for own in self.of_kind])
            return -np.inf if plan is None else float(gains[plan].sum())
        total = float(gains @ node.lower)
        free = np.where(node.upper > node.lower, gains, -np.inf)
        for kind, own in enumerate(self.of_kind):
            rest = self.sizes[kind] - node.lower[own].sum()
            for column in own[np.argsort(-free[own], kind="stable")].tolist() if rest > 0 else ():
                taken = min(rest, node.upper[column] - node.lower[column])
                total, rest = total + taken * float(gains[column]), rest - taken
                if rest <= 0:
                    break
        return total

    def children(self, node: PlanNode, point: FloatArray) -> list[PlanNode]:
        """Divide a node at a fractional plan: into all elements of a robot, or by how many robots choose a column.

        None if it is one plan, up to exchanges of equal elements.
        """
        open_kinds = [k for k, own in enumerate(self.of_kind) if self._is_open(node, k, own)]
        if not open_kinds:
            return []
        kind = min(open_kinds, key=lambda k: float(point[self.of_kind[k]].max()) if self.sizes[k] == 1 else np.inf)
        if self.sizes[kind] == 1:
            own = self.of_kind[kind]
            return [self._only(node, own, column) for column in own[node.upper[own] > 0].tolist()]
        return self._by_number(node, point, np.concatenate([self.of_kind[k] for k in open_kinds]))

    def _is_open(self, node: PlanNode, kind: int, own: IntArray) -> bool:
        return bool(node.lower[own].sum() < self.sizes[kind] and (node.upper[own] > node.lower[own]).sum() > 1)

    @staticmethod
    def _only(node: PlanNode, own: IntArray, column: int) -> PlanNode:
        upper = node.upper.copy()
        upper[own] = 0.0
        upper[column] = node.upper[column]
        return replace(node, upper=upper, is_first=False)

    def _by_number(self, node: PlanNode, point: FloatArray, own: IntArray) -> list[PlanNode]:
        """Divide by how many robots choose the column whose number is least whole, else largest."""
        free = own[node.upper[own] > node.lower[own]]
        number = np.clip(point[free], node.lower[free], node.upper[free])
        apart = np.abs(number - np.rint(number))
        k = int(apart.argmax()) if apart.max() > WHOLE else int((number - node.lower[free]).argmax())
        column, most = (
            int(free[k]),
            float(np.clip(np.ceil(number[k] - WHOLE) - 1, node.lower[free[k]], node.upper[free[k]] - 1)),
        )
        fewer, more = node.upper.copy(), node.lower.copy()
        fewer[column], more[column] = most, most + 1
        children = [replace(node, upper=fewer, is_first=False), replace(node, lower=more, is_first=False)]
        return [child for child in children if self._has_plans(child)]

    def _has_plans(self, node: PlanNode) -> bool:
        least, most = (np.bincount(self.kinds, side, len(self.sizes)) for side in (node.lower, node.upper))
        return bool((least <= self.sizes).all() and (most >= self.sizes).all())

    def rounded(self, point: FloatArray) -> IntArray:
        """(N,) a plan near a fractional one: robots of a class take its largest columns, each robot its own."""
        used: dict[int, int] = {}
        plan: IntArray = np.zeros(len(self._choices), dtype=np.int64)
        for i, choice in enumerate(self._choices):
            columns = self.column[choice]
            taken = np.array([used.get(c, 0) for c in columns.tolist()])
            best = int(np.argmax(point[columns] - taken))
            plan[i] = choice[best]
            used[int(columns[best])] = int(taken[best]) + 1
        return plan if self.limit is None else self.limit.rest(plan, point[plan])
