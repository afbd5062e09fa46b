"""Robots that every attack leaves sensing in some group, by all groups that it may leave.

A team whose robots are all alike tells how many: a group of ``k`` of them is worth ``log(1 + k)``, so that one limit
for all robots says how many are to blind in each column (``listed_columns.py``).
"""

from __future__ import annotations

from functools import lru_cache
from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.attack.team import Team
from ratt_opt.attack.thresholds.listed_columns import ListedColumns
from ratt_opt.attack.thresholds.threshold_search import Threshold
from ratt_opt.setfunctions.criteria.logdet import LogDetObjective

if TYPE_CHECKING:
    from ratt_opt.attack.params import AttackParams
    from ratt_opt.budget import Budget
    from ratt_opt.graph.group_list import GroupList
    from ratt_opt.graph.threat import Threat

__all__ = ["ListedSize", "listed_size_of"]


@lru_cache(maxsize=8)
def listed_size_of(threat: Threat, params: AttackParams) -> ListedSize:
    """The search of one threat; what was found out about the last few is kept, and gone on with."""
    return ListedSize(threat, params)


class ListedSize:
    """Search for the most unblinded robots that every attack leaves in some group; ``least`` : that are proved."""

    def __init__(self, threat: Threat, params: AttackParams) -> None:
        robots = threat.graph.n_robots
        alike = LogDetObjective(np.ones((1, 1, 1)), np.ones((robots, 1, 1, 1)))
        self._threat, self._team, self._is_done = threat, Team.of(alike, np.arange(robots), params), False
        self.least = 0

    def run(self, groups: GroupList, least: int, budget: Budget) -> None:
        """Go on from ``least``, which is sure, until one robot more is not; ``groups`` : all that an attack may leave.

        Raises
        ------
        OutOfBudget : the budget is spent; :attr:`least` is valid.
        """
        self.least = max(self.least, least)
        while not self._is_done and self._team is not None:
            between = float(np.log(self.least + 1.5))
            answer = ListedColumns(self._threat, self._team, groups, between).decide(budget)
            self._is_done = answer.verdict is not Threshold.REFUTED
            self.least += not self._is_done
