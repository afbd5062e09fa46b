"""Bisection over the values of all sets of robots: the exact attacker of small teams."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.budget import OutOfBudget, Stop
from ratt_opt.graph.threshold import ThresholdTest
from ratt_opt.setfunctions.metered import Metered, unmetered

if TYPE_CHECKING:
    from ratt_opt._validation import FloatArray
    from ratt_opt.attackers.task import AttackTask
    from ratt_opt.graph.compiled_threshold import CompiledThresholdTest

__all__ = ["LARGEST_PLAIN", "ThresholdSearch", "threshold_search"]

LARGEST_PLAIN = 12
"""Most robots for which nothing is compiled."""
BLOCK = 2**10
"""Sets valued at once: what is lost where the budget ends. A block of a fast function takes some milliseconds."""
FALL, SLACK = 1e-12, 1e-9
"""Relative to the largest value: up to which a smaller one of a larger set is rounding; and what is taken off a bound
found before, which is more than all falls on the way from set to set add up to."""


def threshold_search(task: AttackTask) -> Stop:
    """Close the bracket, from where the memory of an earlier attack on the plan is."""
    begun = task.memory.search
    search = begun if isinstance(begun, ThresholdSearch) else ThresholdSearch(task)
    search.task, task.memory.search = task, search
    return search.run()


class ThresholdSearch:
    """The worst-case value is one of the values of sets of robots, found by bisection; goes on where it ended.

    Every attack leaves some team value among those of all sets, so when no attack reaches a
    threshold the worst-case value is at least the next larger one.
    """

    def __init__(self, task: AttackTask) -> None:
        self.task = task
        self._table, self._valued = np.empty(2**task.values.n), 0
        self._levels: FloatArray | None = None
        self._test: ThresholdTest | CompiledThresholdTest | None = None
        self._low, self._high = 0, 0  # the answer is in levels[low : high + 1]

    def run(self) -> Stop:
        """Narrow the task's bracket; raises ``OutOfBudget``."""
        self.task.budget.check()
        self._tabulate()
        levels = self._begin() if self._levels is None else self._levels
        bracket, test = self.task.bracket, self._threshold_test()
        # The value of an attack, computed alone, may round differently from the table's.
        self._high = min(self._high, int(np.searchsorted(levels, bracket.upper)))
        while self._low < self._high:
            middle = (self._low + self._high) // 2
            self.task.budget.spend()
            split = test.split(float(levels[middle]), self.task.budget)
            if split is None:
                self._low = middle + 1
                bracket.raise_lower(float(levels[self._low]))
                continue
            self._high = middle
            self.task.offer_split(split.members(), split.blinded)
        bracket.lower = bracket.upper
        return Stop.EXHAUSTED

    def _tabulate(self) -> None:
        """Value the sets that are not valued yet, by bit mask."""
        values, budget, table = self.task.values, self.task.budget, self._table
        if len(table) - self._valued > budget.evaluations_left:
            raise OutOfBudget(Stop.EVALUATIONS)
        asked = values if isinstance(values.objective, Metered) else Metered(values, budget)
        bits = np.arange(values.n)
        while self._valued < len(table):
            masks = np.arange(self._valued, min(self._valued + BLOCK, len(table)))
            table[masks] = asked.evaluate((masks[:, None] >> bits & 1).astype(np.bool_))
            self._valued += len(masks)

    def _begin(self) -> FloatArray:
        """The levels; what was proved before counts where sets are worth no less than those inside them.

        Elsewhere it relied on what is not so, and what the table says relies on nothing.
        """
        bracket, levels = self.task.bracket, np.unique(self._table)
        largest = float(max(abs(levels[0]), abs(levels[-1])))
        relied_on = unmetered(self.task.problem.objective).is_non_decreasing or not _falls(self._table, FALL * largest)
        proved = bracket.lower - SLACK * largest - bracket.rounding if relied_on else -np.inf
        self._high = len(levels) - 1
        self._low = min(int(np.searchsorted(levels, proved)), self._high)
        bracket.lower = max(proved, float(levels[self._low]))
        self._levels = levels
        return levels

    def _threshold_test(self) -> ThresholdTest | CompiledThresholdTest:
        if self._test is None:
            threat = self.task.problem.threat
            if threat.graph.n_robots <= LARGEST_PLAIN:
                self._test = ThresholdTest(threat, self._table)
            else:
                from ratt_opt.graph.compiled_threshold import CompiledThresholdTest  # compiles

                self._test = CompiledThresholdTest(threat, self._table)
        return self._test


def _falls(table: FloatArray, rounding: float) -> bool:
    """Whether a set is worth less than one inside it, by more than rounding."""
    halves = (table.reshape(-1, 2, 1 << i) for i in range(len(table).bit_length() - 1))
    return any(bool((pairs[:, 1] < pairs[:, 0] - rounding).any()) for pairs in halves)
