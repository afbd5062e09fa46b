"""Attacks that leave a relaxed plan little by its rows: exchanges of blinded robots, from known outcomes.

The links that an attack cuts stay; a blinded robot more is taken, then one is given back, each the best. A group is
worth its row; the team is worth its best group.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.problem import Attack

if TYPE_CHECKING:
    from collections.abc import Iterator

    from ratt_opt._validation import BoolArray, FloatArray
    from ratt_opt.budget import Budget
    from ratt_opt.problem import Problem
    from ratt_opt.solvers.maxmin.rows.pool import InequalityPool

__all__ = ["exchanged"]

NO_LESS = 1e-9
"""Relative difference of values that counts as none."""


class _Rest:
    """Values of the components that one attack on links leaves, once robots are blinded."""

    def __init__(self, parts: list[frozenset[int]], inequalities: InequalityPool, by_robot: FloatArray) -> None:
        self._parts = np.zeros((len(parts), len(by_robot)))
        for row, part in zip(self._parts, parts, strict=True):
            row[list(part)] = 1.0
        self._inequalities, self._by_robot = inequalities, by_robot

    def worth(self, sensing: BoolArray) -> FloatArray:
        """(K,) the best component, for sensing robots (K, N)."""
        values = [
            self._inequalities.target_bounds(sensing * part, self._by_robot).sum(axis=1)
            for part in self._parts
            if sensing[:, part > 0].any()
        ]
        return np.asarray(np.max(values, axis=0)) if values else np.zeros(len(sensing))


def exchanged(
    problem: Problem,
    inequalities: InequalityPool,
    by_robot: FloatArray,
    starts: list[Attack],
    until: tuple[float, Budget],
) -> Iterator[Attack]:
    """Attacks under which rows leave less than a level, one from each of some known ones and a greedy one.

    ``by_robot`` : (N, K) what each robot adds to each inequality; ``until`` : the level, and the budget
    """
    level, budget = until
    free = np.isin(np.arange(problem.n_robots), list(problem.protected_robots), invert=True)
    seen = set()
    for start in [*starts, Attack()]:
        parts = [part for part in problem.groups_left(Attack(frozenset(), start.links)) if part]
        rest, key = _Rest(parts, inequalities, by_robot), start.links
        sensing = np.isin(np.arange(problem.n_robots), list(start.sensing), invert=True)
        while not budget.is_over and (~sensing).sum() < min(problem.alpha_s, free.sum()):
            sensing = _best(rest, sensing, free & sensing)[0]
        worth = float(rest.worth(sensing[None])[0])
        for _ in range(inequalities.params.steps if not sensing.all() else 0):
            if budget.is_over:
                return
            more, _ = _best(rest, sensing, free & sensing)
            fewer, lower = _best(rest, more, ~more)
            if lower >= worth - NO_LESS * abs(worth):
                break
            sensing, worth = fewer, lower
        found = frozenset(np.flatnonzero(~sensing).tolist())
        if worth < level and (found, key) not in seen:
            seen.add((found, key))
            yield Attack(found, start.links)


def _best(rest: _Rest, sensing: BoolArray, changed: BoolArray) -> tuple[BoolArray, float]:
    """The sensing robots once the best of some changes, and what is left then; as they are if none may."""
    candidates = np.flatnonzero(changed)
    if not len(candidates):
        return sensing, float(rest.worth(sensing[None])[0])
    trials = np.repeat(sensing[None], len(candidates), axis=0)
    trials[np.arange(len(candidates)), candidates] ^= True
    worth = rest.worth(trials)
    k = int(worth.argmin())
    return trials[k], float(worth[k])
