"""Plans improved by exchanges of one robot's element against exact worst cases: a rival without bounds."""

import time
from collections.abc import Iterable
from dataclasses import dataclass
from itertools import combinations
from typing import Any

import numpy as np

from ratt_opt import Problem
from ratt_opt._validation import BoolArray, IntArray

__all__ = ["RivalBracket", "exchanges"]


@dataclass(frozen=True, slots=True, kw_only=True)
class RivalBracket:
    """Bracket of a rival after its processor seconds: the worst case of its plan, and the bound that it claims."""

    lower: float
    upper: float
    seconds: float


class Worst:
    """Exact worst cases of plans of a team that can lose any ``alpha_s`` robots and no links."""

    def __init__(self, problem: Problem) -> None:
        self._f: Any = problem.objective
        robots, lost = problem.n_robots, problem.alpha_s
        self.left: BoolArray = np.ones((0, robots), dtype=np.bool_)
        sets = list(combinations(range(robots), lost))
        self.left = np.ones((len(sets), robots), dtype=np.bool_)
        for row, one in zip(self.left, sets, strict=True):
            row[list(one)] = False

    def of(self, plan: IntArray) -> tuple[float, IntArray]:
        """The worst case of a plan, and the robots left."""
        sets = np.zeros((len(self.left), self._f.n), dtype=np.bool_)
        sets[:, plan] = self.left
        values = self._f.evaluate(sets)
        return float(values.min()), np.flatnonzero(self.left[int(values.argmin())])


def exchanges(problem: Problem, plan: Iterable[int], seconds: float) -> RivalBracket:
    """Exchange one robot's element at a time as long as the exact worst case improves; no bound."""
    began, worst, current = time.process_time(), Worst(problem), np.array(list(plan))
    value, unchanged, i = worst.of(current)[0], 0, 0
    while unchanged < len(current) and time.process_time() - began < seconds:
        unchanged += 1
        for e in problem.choices[i]:
            other = current.copy()
            other[i] = e
            if time.process_time() - began < seconds and (better := worst.of(other)[0]) > value + 1e-9 * abs(value):
                current, value, unchanged = other, better, 0
        i = (i + 1) % len(current)
    return RivalBracket(lower=value, upper=np.inf, seconds=time.process_time() - began)
