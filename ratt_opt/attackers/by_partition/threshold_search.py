"""Bisection over the values of all sets of robots: the exact attacker of small teams."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.graph.threshold import GroupSplit, ThresholdTest
from ratt_opt.problem import Attack
from ratt_opt.stopping import Stop

if TYPE_CHECKING:
    from ratt_opt._validation import FloatArray
    from ratt_opt.attackers.bracket import Bracket, Budget
    from ratt_opt.attackers.plan_values import PlanValues
    from ratt_opt.graph.compiled_threshold import CompiledThresholdTest
    from ratt_opt.problem import Problem

__all__ = ["LARGEST_THRESHOLD_SEARCH", "threshold_search"]

LARGEST_THRESHOLD_SEARCH = 20
"""Most robots whose 2**N sets are evaluated."""

LARGEST_PLAIN = 12
"""Most robots for which nothing is compiled."""


def threshold_search(problem: Problem, values: PlanValues, bracket: Bracket, budget: Budget) -> Stop:
    """Close ``bracket``: the worst-case value is one of the values of sets of robots, found by bisection.

    Every attack leaves some team value among ``values.table()``, so when no attack reaches a
    threshold the worst-case value is at least the next larger table entry.
    """
    budget.check_time()
    table = values.table()
    levels = np.unique(table)
    test = _test(problem, table)
    low, high = 0, int(np.searchsorted(levels, bracket.upper))  # the answer is in levels[low : high + 1]
    # The heuristic's value, computed alone, may round differently from the table's.
    high = min(high, len(levels) - 1)
    bracket.lower = float(levels[0])  # relies on nothing, unlike the value of no measurement
    while low < high:
        middle = (low + high) // 2
        budget.spend()
        split = test.split(float(levels[middle]))
        if split is None:
            low = middle + 1
            bracket.raise_lower(float(levels[low]))
            continue
        high = middle
        attack = _attack(problem, split)
        bracket.offer(attack, problem.team_value(values.plan, attack))
    bracket.lower = bracket.upper
    return Stop.EXHAUSTED


def _test(problem: Problem, table: FloatArray) -> ThresholdTest | CompiledThresholdTest:
    if problem.n_robots <= LARGEST_PLAIN:
        return ThresholdTest(problem.threat, table)
    from ratt_opt.graph.compiled_threshold import CompiledThresholdTest  # compiles

    return CompiledThresholdTest(problem.threat, table)


def _attack(problem: Problem, split: GroupSplit) -> Attack:
    home = {i: k for k, group in enumerate(split.groups) for i in range(problem.n_robots) if group >> i & 1}
    blinded = (i for i in home if not split.survivors[home[i]] >> i & 1)
    cut = frozenset((i, j) for i, j in problem.communication.links if home[i] != home[j])
    return Attack(frozenset(blinded), cut)
