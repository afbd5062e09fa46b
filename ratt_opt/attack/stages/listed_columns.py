"""Stages: all groups that an attack may leave, listed; thresholds of values, and of numbers of robots.

A team whose robots are all alike tells how many every attack leaves sensing in some group: a group of ``k`` of them is
worth ``log(1 + k)``, so that one limit for all robots says how many are to blind in each column.
"""

from __future__ import annotations

from functools import lru_cache
from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.attack.stages.attack_state import AttackState
from ratt_opt.attack.staging import Share, Stage
from ratt_opt.attack.team import Team
from ratt_opt.attack.thresholds.listed_columns import ListedColumns, ListedSearch
from ratt_opt.attack.thresholds.threshold_search import Threshold
from ratt_opt.graph.group_list import LARGEST_MASK, MOST_CUT, groups_of
from ratt_opt.setfunctions.criteria.logdet import LogDetObjective

if TYPE_CHECKING:
    from ratt_opt.attack.params import AttackParams
    from ratt_opt.budget import Budget
    from ratt_opt.graph.group_list import GroupList
    from ratt_opt.graph.threat import Threat


__all__ = ["ListedColumnsAgainStage", "ListedColumnsStage", "ListedSize", "ListedSizeStage", "listed_size_of"]


class ListedColumnsStage(Stage[AttackState]):
    """Stage that lists the groups before attacks are annealed for long."""

    name = "listed columns"

    def applies(self, attack: AttackState) -> bool:
        """Criterion compiled, at most 60 robots and 255 links to cut."""
        is_narrow = attack.n_robots <= LARGEST_MASK and attack.threat.alpha_c <= MOST_CUT
        return attack.search_by_prices is not None and is_narrow

    def share(self, params: AttackParams) -> Share:
        """Return a part that leaves time for annealing and prices."""
        return Share(part=params.stages.listed_soon, max_nodes=params.stages.listed_nodes)

    def run(self, attack: AttackState) -> None:
        """All groups that an attack may leave, if they are soon listed, and whether one leaves less than in hand."""
        task = attack.task
        assert attack.search_by_prices is not None
        assert attack.team is not None
        if attack.listed is None:
            listed = task.params.listed
            most, part = listed.brief if attack.is_brief else listed.most, task.budget.part(listed.share)
            groups = groups_of(attack.threat)
            if not groups.has_listed(most, part):
                return
            attack.listed = ListedSearch(task, attack.team, groups)
        if not attack.is_annealed:
            attack.search_by_prices.task = task
            attack.search_by_prices.anneal(task.params.listed.starts)
        attack.listed.task = task
        attack.listed.run()


class ListedColumnsAgainStage(ListedColumnsStage):
    """Stage that goes on with the listed columns once attacks are annealed."""

    def applies(self, attack: AttackState) -> bool:
        """Listed columns possible, limit of time, budget left."""
        return super().applies(attack) and attack.has_time_limit and attack.has_prices

    def share(self, params: AttackParams) -> Share:
        """Return a part that leaves time for prices."""
        return Share(part=params.stages.listed, max_nodes=params.stages.listed_nodes)


class ListedSizeStage(Stage[AttackState]):
    """Stage that raises the forced size by listed columns of robots that are all alike."""

    name = "listed size"

    def applies(self, attack: AttackState) -> bool:
        """Groups listed, budget left."""
        return attack.listed is not None and attack.has_prices

    def share(self, params: AttackParams) -> Share:
        """Return a part that leaves time for annealing and prices."""
        return Share(part=params.listed.share, max_nodes=params.stages.listed_nodes)

    def run(self, attack: AttackState) -> None:
        """Unblinded robots that every attack leaves in some group, by all groups that it may leave."""
        size = listed_size_of(attack.threat, attack.task.params)
        try:
            size.run(groups_of(attack.threat), attack.sure, attack.task.budget)
        finally:
            attack.sure = max(attack.sure, size.least)


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
