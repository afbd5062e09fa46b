"""The cuts of a search as arrays, and the bounds that follow from them."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.bounds.cuts import GroupCut, combined_bound, tangent_cut
from ratt_opt.solvers.maxmin.proof import TangentCut

if TYPE_CHECKING:
    from collections.abc import Sequence

    from ratt_opt._validation import BoolArray, FloatArray, IntArray
    from ratt_opt.solvers.maxmin.elements import Task
    from ratt_opt.solvers.maxmin.outcome_pool import OutcomePool
    from ratt_opt.solvers.maxmin.proof import Leaf
    from ratt_opt.solvers.maxmin.rows.pool import Row
    from ratt_opt.solvers.maxmin.rows.separation import RowSeparation

__all__ = ["CutStore"]


class CutStore:
    """Cut ``k`` bounds the team value under outcome ``outcomes[k]`` if its group ``groups[k]`` wins.

    Cuts are never removed: leaves refer to them. Scores are stored element by element, because a
    relaxed plan has few elements. ``rows`` : once cuts are rows of inequalities target by target
    """

    def __init__(self, task: Task, pool: OutcomePool) -> None:
        self.task, self.pool = task, pool
        self.rows: RowSeparation | None = None
        self._limit = task.problem.choice_limit
        self._cuts: list[GroupCut | Row] = []
        self._origin = np.zeros((64, 2), dtype=np.int64)
        self._constants = np.zeros(64)
        self._scores = np.zeros((task.objective.n, 64))

    def __len__(self) -> int:
        return len(self._cuts)

    @property
    def outcomes(self) -> IntArray:
        """(K,) outcome of each cut."""
        return self._origin[: len(self._cuts), 0]

    @property
    def groups(self) -> IntArray:
        """(K,) group of each cut, by its number in the pool."""
        return self._origin[: len(self._cuts), 1]

    @property
    def constants(self) -> FloatArray:
        """(K,) constants."""
        return self._constants[: len(self._cuts)]

    def scores(self, cut: int | IntArray) -> FloatArray:
        """(E,) scores of one cut, or (E, K) of some."""
        return self._scores[:, cut]

    def bounds(self, selection: FloatArray) -> FloatArray:
        """(K,) what each cut bounds its group's value by under a relaxed selection (E,)."""
        chosen = np.flatnonzero(selection)
        return np.asarray(self.constants + selection[chosen] @ self._scores[chosen, : len(self._cuts)])

    def tangent(self, outcome: int, group: int, point: FloatArray, target: int | None = None) -> int:
        """Add the tangent of a group's value at the posterior information ``point``; return its index."""
        return self.add(outcome, group, tangent_cut(self.task.problem, self.pool.groups[group], point, target))

    def touching(self, outcome: int, group: int, elements: IntArray, point: FloatArray | None = None) -> int:
        """Add the lowest cut on a group at elements of any number, whatever its sum; return its index.

        ``point`` : (M, d, d) the group's posterior information there, if it is known
        """
        if self.rows is not None:
            return self.add(outcome, group, self.rows.row_at(group, self.task.indicator(elements)))
        if point is None:
            own = np.isin(self.task.problem.robot[elements], self.pool.groups[group])
            point = self.task.objective.posterior_information(elements[own])
        return self.tangent(outcome, group, point)

    def add(self, outcome: int, group: int, cut: GroupCut | Row) -> int:
        """Add a cut; return its index."""
        k = len(self._cuts)
        if k == len(self._constants):
            self._origin = np.concatenate([self._origin, np.zeros_like(self._origin)])
            self._constants = np.concatenate([self._constants, np.zeros_like(self._constants)])
            self._scores = np.concatenate([self._scores, np.zeros_like(self._scores)], axis=1)
        self._origin[k] = outcome, group
        self._constants[k] = cut.constant
        self._scores[:, k] = cut.scores
        self._cuts.append(cut)
        return k

    def usable(self, winners: IntArray) -> BoolArray:
        """(K,) whether each cut's group is the one that wins its outcome, by ``winners`` (O,)."""
        return np.asarray(winners[self.outcomes] == self.groups)

    def leaf_bound(self, leaf: Leaf, choices: Sequence[IntArray]) -> tuple[float, FloatArray]:
        """The bound of a leaf's convex combination over plans within ``choices``, and its combined scores.

        A leaf without cuts bounds nothing, unless more robots would have to be busy than may be.
        """
        cuts = list(leaf.cuts)
        if not cuts:
            is_empty = self._limit is not None and not self._limit.has_plan(choices)
            return 0.0 if is_empty else np.inf, np.zeros(len(self._scores))
        return combined_bound(
            self._constants[cuts], self._scores[:, cuts].T, np.array(leaf.weights), choices, self._limit
        )

    def record(self, k: int) -> TangentCut:
        """One cut as part of a proof."""
        cut = self._cuts[k]
        if isinstance(cut, GroupCut):
            return TangentCut(attack=int(self.outcomes[k]), group=cut.group, point=cut.point, target=cut.target)
        return cut.record(int(self.outcomes[k]), self.task.objective.prior_information)
