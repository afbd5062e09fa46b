"""The exact attacker of larger teams on sparse graphs: how is the team split, and who is blinded in each group?

``graph/separable_groups.py`` lists every group an attack may leave. For a threshold, a group needs so many blinded
robots that some subset of the others is worth less (``GroupSurvivors``); the threshold is reachable exactly when the
team can be partitioned into groups within the link budget whose needs add up to at most the robots that may be blinded.
Needs are bounded from below first and computed only for groups that a partition asks for; a group needs at least what
any group inside it needs. Thresholds are bisected, which narrows the bracket from both sides.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.attack.least_sets.search import least_value_bound
from ratt_opt.attackers.by_partition.group_floors import least_in_groups
from ratt_opt.attackers.by_partition.settled_partitions import GroupSurvivors, SettledPartitions
from ratt_opt.budget import Stop

if TYPE_CHECKING:
    from ratt_opt._validation import FloatArray, IntArray
    from ratt_opt.attack.least_sets.packed_team import PackedTeam
    from ratt_opt.attackers.task import AttackTask
    from ratt_opt.graph.separable_groups import SeparableGroups

__all__ = ["SplitSearch"]

BISECTED = 2e-3
"""Relative width below which the incumbent is tested instead of the middle: where it is optimal, one refutation
at its value closes the bracket for which bisection would take two dozen."""
CHUNK = 4096
"""Groups whose values are computed at once: their matrices stay in cache."""


class SplitSearch:
    """Closes the task's bracket; relies on a non-decreasing objective."""

    def __init__(self, task: AttackTask, team: PackedTeam, groups: SeparableGroups) -> None:
        self.task, self.team, self.groups = task, team, groups
        self.n_robots, self.n_blinded = task.problem.n_robots, task.problem.threat.n_blinded
        self.survivors = GroupSurvivors(team, task.problem.protected_robots)
        self._sizes = np.bitwise_count(groups.masks).astype(np.int64)
        self._floors = np.zeros((0, 0))
        """(G, n_blinded + 1) no subset of the group with so many robots blinded is worth less."""

    def run(self) -> Stop:
        """Bisect the threshold; the bracket is valid whenever this stops, and from there it can go on."""
        self.task.budget.spend()
        if not len(self._floors):
            self._floors = self._first_floors()
        bracket = self.task.bracket
        while not bracket.is_closed:
            width = bracket.upper - bracket.lower
            threshold = bracket.goal if width <= BISECTED * abs(bracket.upper) else bracket.lower + width / 2
            if not self._reach(threshold):
                bracket.raise_lower(threshold)
        return Stop.CLOSED

    def _first_floors(self) -> FloatArray:
        """Values of whole groups, and underestimators over the team for those with blinded robots."""
        floors = np.full((len(self._sizes), self.n_blinded + 1), -np.inf)
        floors[:, 0] = self._whole()
        for size in range(self.n_robots - 1, 0, -1):
            blinded = self._sizes - size
            rows = np.flatnonzero((blinded >= 1) & (blinded <= self.n_blinded))
            if len(rows):
                self.task.budget.check()
                floors[rows, blinded[rows]] = self._size_floor(rows, size)
        # Blinding fewer robots leaves no less.
        return np.asarray(np.maximum.accumulate(floors[:, ::-1], axis=1)[:, ::-1])

    def _whole(self) -> FloatArray:
        team, robots = self.team, self.groups.robots
        information = team.information[robots].reshape(len(robots), -1)
        values = np.empty(len(self._sizes))
        for first in range(0, len(values), CHUNK):
            member = self.groups.masks[first : first + CHUNK, None] >> np.arange(len(robots)) & 1
            sums = team.prior + (member @ information).reshape(-1, *team.prior.shape)
            values[first : first + CHUNK] = team.values(sums)
        return values

    def _size_floor(self, rows: IntArray, size: int) -> FloatArray:
        """No ``size`` robots of the groups ``rows`` are worth less."""
        if self.team.has_underestimators:
            return least_in_groups(self.survivors.underestimators.rough(size), self.groups, rows, size)
        return np.full(len(rows), least_value_bound(self.team, size))

    def _reach(self, threshold: float) -> bool:
        """Find an attack below the threshold, or prove that there is none."""
        need = (self._floors >= threshold).sum(axis=1)
        partitions = SettledPartitions(self.survivors, self.groups, need, threshold)
        try:
            return partitions.reach(self.task)
        finally:
            for blinded in range(self.n_blinded + 1):
                proved = need > blinded
                self._floors[proved, blinded] = np.maximum(self._floors[proved, blinded], threshold)
