"""Bisection over the values of all sets of robots: the exact attacker of small teams."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.graph.threshold import ThresholdTest
from ratt_opt.setfunctions.metered import Metered, table_within
from ratt_opt.stopping import Stop

if TYPE_CHECKING:
    from ratt_opt.attackers.task import AttackTask
    from ratt_opt.graph.compiled_threshold import CompiledThresholdTest

__all__ = ["LARGEST_PLAIN", "threshold_search"]

LARGEST_PLAIN = 12
"""Most robots for which nothing is compiled."""


def threshold_search(task: AttackTask) -> Stop:
    """Close the bracket: the worst-case value is one of the values of sets of robots, found by bisection.

    Every attack leaves some team value among ``values.table()``, so when no attack reaches a
    threshold the worst-case value is at least the next larger table entry.
    """
    bracket = task.bracket
    task.budget.check()
    is_metered = isinstance(task.problem.objective, Metered)
    table = task.values.table() if is_metered else table_within(task.values, task.budget)
    levels = np.unique(table)
    test: ThresholdTest | CompiledThresholdTest
    if task.problem.n_robots <= LARGEST_PLAIN:
        test = ThresholdTest(task.problem.threat, table)
    else:
        from ratt_opt.graph.compiled_threshold import CompiledThresholdTest  # compiles

        test = CompiledThresholdTest(task.problem.threat, table)
    low, high = 0, int(np.searchsorted(levels, bracket.upper))  # the answer is in levels[low : high + 1]
    # The heuristic's value, computed alone, may round differently from the table's.
    high = min(high, len(levels) - 1)
    bracket.lower = float(levels[0])  # relies on nothing, unlike the value of no measurement
    while low < high:
        middle = (low + high) // 2
        task.budget.spend()
        split = test.split(float(levels[middle]))
        if split is None:
            low = middle + 1
            bracket.raise_lower(float(levels[low]))
            continue
        high = middle
        task.offer_split(split.members(), split.blinded)
    bracket.lower = bracket.upper
    return Stop.EXHAUSTED
