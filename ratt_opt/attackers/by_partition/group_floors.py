"""What sets of one size in each group are worth at least: underestimators over the whole team, sharper if that pays.

An underestimator of all sets of a size holds in every group. At a threshold a sharp one, a tenth of a second, decides
hundreds of groups whose sets would be searched one group after the other; so it is made once the search of sets of that
size has taken as long.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.attack.least_sets.underestimator import Underestimator, affine_underestimator

if TYPE_CHECKING:
    from ratt_opt._validation import FloatArray, IntArray
    from ratt_opt.attack.least_sets.packed_team import PackedTeam, SetFamily
    from ratt_opt.budget import Budget
    from ratt_opt.graph.separable_groups import SeparableGroups

__all__ = ["UnderestimatorsOfSizes", "least_in_groups"]

ROUGH, SHARP = 2, 4
"""Heavy robots of the first underestimators, of all sizes, and of those for one threshold."""
SHARPER_AFTER = 20_000
"""Nodes of the search of sets of one size, under one threshold, before its underestimator is sharpened to it."""
UNDERESTIMATOR_NODES = 10_000
"""Nodes that take as long as a sharper underestimator."""


class UnderestimatorsOfSizes:
    """Underestimators of the sets of one size of all robots, one for each size.

    A criterion of levels (max-eigenvalue) has none: its bounds are by the weakest axis, which is quick for each group.
    Nor have targets that are not in the plane.
    """

    def __init__(self, team: PackedTeam) -> None:
        self._team = team
        self._best: dict[int, Underestimator] = {}

    def of(self, size: int) -> Underestimator | None:
        """The best one known."""
        return self._best.get(size)

    def rough(self, size: int) -> Underestimator:
        """One that is made in a moment, from that of the next size."""
        underestimator = affine_underestimator(self._family(size), ROUGH, -np.inf, self._best.get(size + 1))
        self._best[size] = underestimator
        return underestimator

    def sharper(self, size: int, threshold: float, budget: Budget) -> Underestimator | None:
        """One for a threshold; ``None`` where there is none to be had.

        Raises
        ------
        OutOfBudget : the time is up, or no node is left.
        """
        if not (self._team.has_underestimators and 0 < size < len(self._team.single)):
            return None
        budget.spend(budget.nodes_left(UNDERESTIMATOR_NODES))
        known = self._best.get(size)
        found = affine_underestimator(self._family(size), SHARP, threshold, known, budget)
        if known is None or found.bound(size) > known.bound(size):
            self._best[size] = found
        return found

    def _family(self, size: int) -> SetFamily:
        return self._team.family(np.arange(len(self._team.single)), size)


def least_in_groups(underestimator: Underestimator, groups: SeparableGroups, rows: IntArray, size: int) -> FloatArray:
    """(len(rows),) no ``size`` robots of a group are worth less; ``underestimator`` : of all sets of that size."""
    scores = underestimator.scores[groups.robots]
    total, taken = np.full(len(rows), underestimator.constant), np.zeros(len(rows), dtype=np.int64)
    for place in np.argsort(scores, kind="stable").tolist():
        takes = (groups.masks[rows] >> place & 1).astype(np.bool_) & (taken < size)
        total[takes] += scores[place]
        taken += takes
    return total
