"""The exact attacker where all groups that an attack may leave can be listed: prices, then the partitions they leave.

For a threshold, prices of robots, groups and blinded ones that no group pays claim more links than the budget, or the
groups of an attack cost together no more than the links that they lack: the partitions into such groups are searched.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.attack.pricing import Plan
from ratt_opt.attackers.by_covers.cover_prices import CoverProgram
from ratt_opt.attackers.by_covers.listed_groups import ListedGroups
from ratt_opt.attackers.by_covers.weak_sets import WeakSets
from ratt_opt.attackers.by_partition.settled_partitions import GroupSurvivors, SettledPartitions
from ratt_opt.budget import Stop
from ratt_opt.graph.separable_groups import SeparableGroups

if TYPE_CHECKING:
    from collections.abc import Callable

    from ratt_opt._validation import BoolArray
    from ratt_opt.attack.least_sets.packed_team import PackedTeam
    from ratt_opt.attackers.task import AttackTask

__all__ = ["CoverSearch"]

STEPS = (0.1, 0.02, 0.005)
"""Relative distances below the attack in hand of the thresholds before its own, for a bracket while open. The last
one leaves 0.5 instead of 2 % after 120 s on a small world of 50 robots; 24 robots take some tenths of a second more."""

FEW = 3_000
"""Groups whose partitions are searched before triples of robots are tried, which make fractions of groups dearer."""


class CoverSearch:
    """Closes the task's bracket; relies on a non-decreasing objective.

    A node is a program solved, a group tried in a partition, or a partial set.
    """

    def __init__(self, task: AttackTask, team: PackedTeam, groups: SeparableGroups) -> None:
        plan = Plan.of(task.problem.objective, task.values.plan, task.problem.threat)
        assert plan is not None, "a packed team's criterion has compiled loops"
        self.task, self._plan, self._groups = task, plan, groups
        self._survivors = GroupSurvivors(team, task.problem.protected_robots)
        self._begun: _Threshold | None = None

    def run(self) -> Stop:
        """Decide thresholds; the bracket is valid whenever this stops, and from there it can go on."""
        bracket, budget = self.task.bracket, self.task.budget
        while not bracket.is_closed:
            threshold = self._threshold()
            if self._begun is None or self._begun.threshold != threshold:
                budget.spend()
                self._begun = _Threshold(self._plan, self._groups, threshold, self._check)
            if not self._begun.reach(self.task, self._survivors):
                bracket.raise_lower(threshold)
            self._begun = None
        return Stop.CLOSED

    def _check(self) -> None:
        self.task.budget.check()

    def _threshold(self) -> float:
        bracket = self.task.bracket
        lower = (bracket.upper - share * abs(bracket.upper) for share in STEPS)
        return next((threshold for threshold in lower if threshold > bracket.lower), bracket.goal)


class _Threshold:
    """What is known of one threshold, from where it can be gone on with."""

    def __init__(self, plan: Plan, groups: SeparableGroups, threshold: float, check: Callable[[], None]) -> None:
        self.threshold, self._groups = threshold, groups
        self._weak = WeakSets(plan, threshold, check)
        self._program = CoverProgram(groups.threat, self._weak)
        self._listed = ListedGroups(groups, self._weak, self._program)
        self._partitions: SettledPartitions | None = None

    def reach(self, task: AttackTask, survivors: GroupSurvivors) -> bool:
        """Find an attack below the threshold, or prove that there is none."""
        while self._partitions is None:
            prices = self._listed.priced(lambda: task.budget.seconds_left, task.budget.spend)
            costs = self._listed.costs(prices)
            # No group pays more than the program's tolerance, and an attack leaves no more groups than robots.
            lacking = prices.slack - len(prices.robot) * min(int(costs.min(initial=0)), 0)
            if lacking < 0:
                return False
            cheap = costs <= lacking
            if not self._listed.raised() and not (cheap.sum() > FEW and self._program.add_triples()):
                self._partitions = self._cheap_partitions(cheap, survivors)
        return self._partitions.reach(task)

    def _cheap_partitions(self, cheap: BoolArray, survivors: GroupSurvivors) -> SettledPartitions:
        """Those into cheap groups (G,)."""
        every, own = self._groups, self._listed.rows[cheap]
        masks = every.masks[own]
        lowest = np.bitwise_count((masks & -masks) - 1)
        start = np.searchsorted(lowest, np.arange(len(every.robots) + 1))
        some = SeparableGroups(every.threat, masks, every.links[own], start, every.robots, every.neighbours)
        return SettledPartitions(survivors, some, self._listed.need[cheap], self.threshold)
