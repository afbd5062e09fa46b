"""The mixed-integer program that an operations researcher writes, by HiGHS: attacks are added as they are found.

For each attack and target a variable says what the robots left are worth to the target. A robot chooses one element;
the least sum over attacks is maximised. The plan that HiGHS returns is attacked exactly, and that attack is added.
HiGHS's bound is its claim: nothing checks it.
"""

from __future__ import annotations

import time
from dataclasses import dataclass, field
from itertools import combinations
from typing import TYPE_CHECKING, Any

import highspy
import numpy as np

from ratt_opt.highs import silent_solver

if TYPE_CHECKING:
    from collections.abc import Iterable

    from ratt_opt import Problem
    from ratt_opt._validation import BoolArray, FloatArray, IntArray
    from ratt_opt.setfunctions.best_elements import BestElements

__all__ = ["RivalBracket", "exchanges", "scenario_milp"]


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


def scenario_milp(problem: Problem, seconds: float) -> RivalBracket:
    """Solve the program again and again, an attack more each time, within a number of processor seconds."""
    began, worst, model = time.process_time(), Worst(problem), _Model(problem)
    lower, upper, left = 0.0, np.inf, np.arange(problem.alpha_s, problem.n_robots)
    while time.process_time() - began < seconds and lower < upper - 1e-6 * abs(lower):
        model.add_attack(left)
        plan, bound = model.solve(began + seconds)
        upper = min(upper, bound)
        if plan is None:
            break
        value, left = worst.of(plan)
        lower = max(lower, value)
    return RivalBracket(lower=lower, upper=upper, seconds=time.process_time() - began)


@dataclass(slots=True)
class _Model:
    """The program so far; ``shares`` of an element for a target are variables, as in textbooks on p-median."""

    problem: Problem
    highs: Any = field(init=False)
    _least: Any = field(init=False)
    _chosen: list[Any] = field(init=False)

    def __post_init__(self) -> None:
        highs = self.highs = silent_solver()()
        highs.setOptionValue("threads", 1)
        f: BestElements = self.problem.objective  # type: ignore[assignment]
        self._least = highs.addVariable(0, float(f(range(f.n))))
        self._chosen = [highs.addVariable(0, 1, type=highspy.HighsVarType.kInteger) for _ in range(f.n)]
        for choice in self.problem.choices:
            highs.addConstr(sum(self._chosen[e] for e in choice) == 1)

    def add_attack(self, left: IntArray) -> None:
        """Bound the least sum by what the robots left are worth to each target."""
        f: BestElements = self.problem.objective  # type: ignore[assignment]
        sees, worth = np.isin(self.problem.robot, left), []
        for part in range(f.n_parts):
            elements = [int(e) for e in f.touching(part) if sees[e]]
            levels, kind = np.unique(f.utility[elements, part], return_inverse=True)
            shares = []
            for level, utility in enumerate(levels):
                share = self.highs.addVariable(0, 1)
                same = [self._chosen[e] for e, k in zip(elements, kind, strict=True) if k == level]
                self.highs.addConstr(share - sum(same) <= 0)
                shares.append(share)
                worth.append(float(f.weights[part] * utility) * share)
            if shares:
                self.highs.addConstr(sum(shares) <= 1)
        self.highs.addConstr(self._least - sum(worth) <= 0)

    def solve(self, until: float) -> tuple[IntArray | None, float]:
        """The plan found and the bound claimed by the time that the processor clock shows ``until``."""

        def answer(event: Any) -> None:
            event.interrupt(time.process_time() > until)

        asked = (self.highs.cbMipInterrupt, self.highs.cbSimplexInterrupt)
        for question in asked:
            question.subscribe(answer)
        try:
            self.highs.maximize(self._least)
        finally:
            for question in asked:
                question.unsubscribe(answer)
        values = np.array(self.highs.getSolution().col_value)
        chosen: FloatArray = values[1 : len(self._chosen) + 1]
        bound = float(self.highs.getInfo().mip_dual_bound)
        if len(chosen) < len(self._chosen) or not chosen.any():
            return None, bound
        return np.array([choice[int(chosen[choice].argmax())] for choice in self.problem.choices]), bound
