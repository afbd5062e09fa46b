"""The inequalities of all targets that are known, and the rows that they add up to."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.bounds.cuts import ROUNDING
from ratt_opt.solvers.maxmin.proof import TangentCut
from ratt_opt.solvers.maxmin.rows.base_sets import base_set_inequalities
from ratt_opt.solvers.maxmin.rows.inequalities import tangents

if TYPE_CHECKING:
    from collections.abc import Sequence

    from ratt_opt._validation import FloatArray, IntArray
    from ratt_opt.solvers.maxmin.elements import Task
    from ratt_opt.solvers.maxmin.params import RowParams
    from ratt_opt.solvers.maxmin.rows.inequalities import Inequalities, TargetInequality

__all__ = ["InequalityPool", "Row"]

GROUPS_AT_ONCE = 64
"""Groups whose values are in the processor's cache at once: 5,005 groups and 1,500 inequalities take 17 ms, not 116."""


class Row:
    """``phi(plan on the group) <= constant + sum of scores[e]`` for every plan: one inequality of each target."""

    __slots__ = ("constant", "group", "parts", "scores")

    def __init__(
        self, group: tuple[int, ...], constant: float, scores: FloatArray, parts: tuple[TargetInequality, ...]
    ) -> None:
        self.group, self.constant, self.scores, self.parts = group, constant, scores, parts

    def record(self, attack: int, elsewhere: FloatArray) -> TangentCut:
        """The row as part of a proof; where a target has a lemma the point is that of ``elsewhere`` (M, d, d)."""
        point = elsewhere.copy()
        for part in self.parts:
            if part.point is not None:
                point[part.target] = part.point[part.target]
        lemmas = tuple(part.lemma for part in self.parts if part.lemma is not None)
        return TangentCut(attack=attack, group=self.group, point=point, lemmas=lemmas, by_target=True)


class InequalityPool:
    """Inequalities that serve every outcome: at least one of each target.

    Parameters
    ----------
    robot : (E,) the robot of each element
    lasting : inequalities that are never forgotten, at least one of each of the ``n_targets`` targets
    """

    def __init__(self, robot: IntArray, n_targets: int, lasting: Sequence[Inequalities], params: RowParams) -> None:
        self.params = params
        self._robot, self._n_targets = robot, n_targets
        self._targets, self._constants = np.zeros(0, dtype=np.int64), np.zeros(0)
        self._scores = np.zeros((1, len(robot)))
        self._origins: list[TargetInequality] = []
        self._used = np.zeros(0)
        self._round = 0.0
        self.add(lasting)
        self._lasting = len(self)

    @classmethod
    def of(cls, task: Task, params: RowParams) -> InequalityPool:
        """The pool of a criterion: base sets, and the tangents at all elements of all robots."""
        objective = task.objective
        everything = objective.posterior_mixture(np.ones(objective.n))
        lasting = [
            *base_set_inequalities(task, params),
            tangents(objective, everything, np.arange(objective.n_targets)),
        ]
        return cls(task.problem.robot, objective.n_targets, lasting, params)

    def __len__(self) -> int:
        return len(self._origins)

    def by_robot(self, selection: FloatArray, owner: IntArray | None = None) -> FloatArray:
        """(N, K) what each robot's relaxed choice (E,) adds to each inequality, sorted by target.

        ``owner`` : (E,) numbers from 0 that take the place of robots
        """
        owner = self._robot if owner is None else owner
        chosen = np.flatnonzero(selection)
        mixed = np.zeros((len(chosen), int(owner.max()) + 1))
        mixed[np.arange(len(chosen)), owner[chosen]] = selection[chosen]
        added = self._scores[: len(self), chosen] @ mixed
        return np.ascontiguousarray(added[self._order].T)

    def target_bounds(self, members: FloatArray, by_robot: FloatArray) -> FloatArray:
        """(G, M) the lowest bound of each target for groups ``members`` (G, N), block by block of the groups."""
        lowest = np.empty((len(members), len(self._starts)))
        spare = np.empty((min(len(members), GROUPS_AT_ONCE), len(self)))
        for k in range(0, len(members), GROUPS_AT_ONCE):
            block = members[k : k + GROUPS_AT_ONCE]
            values = np.matmul(block, by_robot, out=spare[: len(block)])
            values += self._sorted_constants
            np.minimum.reduceat(values, self._starts, axis=1, out=lowest[k : k + GROUPS_AT_ONCE])
        return lowest

    def add(self, parts: Sequence[Inequalities]) -> None:
        """Keep some inequalities; if there are too many, half of those that may go do, the least used lately."""
        count = sum(len(part.targets) for part in parts)
        if len(self) + count > self.params.most and self._origins:
            self._forget()
        self._make_room(count)
        known = len(self)
        self._targets = np.concatenate([self._targets, *(part.targets for part in parts)])
        self._constants = np.concatenate([self._constants, *(part.constants for part in parts)])
        self._scores[known : known + count] = np.concatenate([part.scores for part in parts], axis=1).T
        self._origins.extend(origin for part in parts for origin in part.origins)
        self._used = np.concatenate([self._used, np.full(count, self._round)])
        self._sort()

    def row(self, group: tuple[int, ...], selection: FloatArray) -> Row:
        """The lowest row of a group at a relaxed choice (E,)."""
        inside = np.isin(self._robot, group)
        lowest = self._lowest(selection * inside)
        scores, constants = self._scores[lowest].sum(axis=0) * inside, self._constants[lowest]
        constant = _rounded_up(constants, scores, len(group))
        return Row(group, constant, scores, tuple(self._origins[k] for k in lowest.tolist()))

    def lasting(self) -> list[tuple[float, FloatArray]]:
        """Constant and scores (E,) of one inequality of each target."""
        return [
            (float(self._constants[k]), self._scores[k])
            for k in (int(np.flatnonzero(self._targets == j)[0]) for j in range(self._n_targets))
        ]

    def combined(self, inside: FloatArray, selection: FloatArray) -> tuple[float, FloatArray]:
        """Constant and scores (E,) of the lowest row at a relaxed choice (E,), of elements left in part (E,)."""
        lowest = self._lowest(selection * inside)
        scores, constants = self._scores[lowest].sum(axis=0) * inside, self._constants[lowest]
        return _rounded_up(constants, scores, int(self._robot.max()) + 1), scores

    def _lowest(self, selection: FloatArray) -> IntArray:
        """(M,) the lowest inequality of each target at a relaxed choice (E,)."""
        chosen = np.flatnonzero(selection)
        values = (self._scores[: len(self), chosen] @ selection[chosen] + self._constants)[self._order]
        least = np.minimum.reduceat(values, self._starts)
        tight = np.flatnonzero(values == least[self._targets[self._order]])
        lowest = self._order[tight[np.searchsorted(tight, self._starts)]]
        self._round += 1
        self._used[lowest] = self._round
        return lowest

    def _forget(self) -> None:
        """Drop half of the inequalities that were learnt, those that were not lowest for longest."""
        learnt = np.arange(self._lasting, len(self))
        gone = learnt[np.argsort(self._used[learnt], kind="stable")[: len(learnt) // 2]]
        kept = np.setdiff1d(np.arange(len(self)), gone)
        self._scores[: len(kept)] = self._scores[kept]
        self._targets, self._constants, self._used = self._targets[kept], self._constants[kept], self._used[kept]
        self._origins = [self._origins[k] for k in kept.tolist()]

    def _make_room(self, more: int) -> None:
        needed = len(self) + more
        if needed > len(self._scores):
            grown = np.zeros((max(needed, 2 * len(self._scores)), self._scores.shape[1]))
            grown[: len(self)] = self._scores[: len(self)]
            self._scores = grown

    def _sort(self) -> None:
        self._order = np.argsort(self._targets, kind="stable")
        self._starts = np.searchsorted(self._targets[self._order], np.arange(self._n_targets))
        self._sorted_constants: IntArray | FloatArray = self._constants[self._order]


def _rounded_up(constants: FloatArray, scores: FloatArray, robots: int) -> float:
    """The sum of constants, with what rounding may take off a row for that many robots."""
    size = float(np.abs(constants).sum() + np.abs(scores).max(initial=0.0) * robots)
    return float(constants.sum()) + ROUNDING * size
