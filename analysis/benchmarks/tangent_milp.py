"""HiGHS's program with attacks added as they are found, for criteria that are sums over targets.

As ``scenario_program`` of ``ratt_opt.planners``, but a target's value is bounded by tangents: first at the even
mixture of all elements, then at each plan that HiGHS returns. If an attack leaves several groups, a binary variable
says which of them wins. The library attacks the plans exactly. HiGHS's bound is its claim: nothing checks it.
"""

import time
from collections.abc import Iterable
from typing import Any

import highspy
import numpy as np

import ratt_opt as ro
from analysis.benchmarks.exchanges import RivalBracket
from ratt_opt import Problem
from ratt_opt._validation import FloatArray, IntArray
from ratt_opt.highs import silent_solver

__all__ = ["attacked_exchanges", "tangent_milp"]

ATTACK_SHARE = 0.2
"""Share of the seconds left for one exact attack."""


def _worst(problem: Problem, plan: IntArray, until: float) -> ro.AttackResult:
    left = max(until - time.process_time(), 0.1)
    return ro.worst_case_attack(problem, plan, time_limit=ATTACK_SHARE * left)


def attacked_exchanges(problem: Problem, plan: Iterable[int], seconds: float) -> RivalBracket:
    """Exchange one robot's element at a time as long as the proved worst case improves; no bound."""
    began, current = time.process_time(), np.array(list(plan))
    until = began + seconds
    value, unchanged, i = _worst(problem, current, until).lower, 0, 0
    while unchanged < len(current) and time.process_time() < until:
        unchanged += 1
        for e in problem.choices[i].tolist():
            other = current.copy()
            other[i] = e
            if time.process_time() < until and (better := _worst(problem, other, until).lower) > value * (1 + 1e-9):
                current, value, unchanged = other, better, 0
        i = (i + 1) % len(current)
    return RivalBracket(lower=value, upper=np.inf, seconds=time.process_time() - began)


def tangent_milp(problem: Problem, seconds: float) -> RivalBracket:
    """Solve the program again and again, an attack and tangents more each time, within some processor seconds."""
    began, model = time.process_time(), _Model(problem)
    until, lower, upper = began + seconds, 0.0, np.inf
    plan: IntArray | None = ro.greedy(problem).elements
    while plan is not None and time.process_time() < until and upper - lower > 1e-4 * lower:
        found = _worst(problem, plan, until)
        lower = max(lower, found.lower)
        model.add(found.attack, plan)
        plan, bound = model.solve(until)
        upper = min(upper, bound)
    return RivalBracket(lower=lower, upper=upper, seconds=time.process_time() - began)


class _Model:
    """The program so far: elements, the least value, and a variable for each target of each group left."""

    def __init__(self, problem: Problem) -> None:
        self.problem, self.highs = problem, silent_solver()()
        self.highs.setOptionValue("threads", 1)
        self.f: Any = problem.information_objective
        self.parts: Any = self.f.decomposition()
        self.most = float(self.f(range(self.f.n)))
        self.least = self.highs.addVariable(0, self.most)
        self.chosen = [self.highs.addVariable(0, 1, type=highspy.HighsVarType.kInteger) for _ in range(self.f.n)]
        for choice in problem.choices:
            self.highs.addConstr(sum(self.chosen[e] for e in choice) == 1)
        self.groups: dict[frozenset[int], list[Any]] = {}
        self.known: set[ro.Attack] = set()
        even = np.concatenate([np.full(len(choice), 1 / len(choice)) for choice in problem.choices])
        self.mixed: FloatArray = even[np.argsort(np.concatenate(problem.choices))]

    def add(self, attack: ro.Attack, plan: IntArray) -> None:
        """Bound the least value under an attack, and every group known by tangents at a plan."""
        if attack not in self.known:
            self.known.add(attack)
            left = [group for group in self.problem.groups_left(attack) if group]
            wins = [self.highs.addVariable(0, 1, type=highspy.HighsVarType.kInteger) for _ in left]
            self.highs.addConstr(sum(wins) == 1)
            for group, win in zip(left, wins, strict=True):
                if group not in self.groups:
                    self.groups[group] = [self.highs.addVariable(0, self.most) for _ in range(self.parts.n_parts)]
                    self._touch(group, self.mixed)
                self.highs.addConstr(self.least - sum(self.groups[group]) + self.most * win <= self.most)
        share = np.zeros(self.f.n)
        share[plan] = 1.0
        for group in self.groups:
            self._touch(group, share)

    def _touch(self, group: frozenset[int], share: FloatArray) -> None:
        inside = np.isin(self.problem.robot, list(group))
        for j, value in enumerate(self.groups[group]):
            own = self.parts.touching(j)
            bound = self.parts.overestimator(j, share[own] * inside[own])
            terms = [float(g) * self.chosen[e] for g, e in zip(bound.gains, own, strict=True) if inside[e] and g > 0]
            self.highs.addConstr(value - sum(terms) <= bound.constant)

    def solve(self, until: float) -> tuple[IntArray | None, float]:
        """The plan found and the bound claimed by the time that the processor clock shows ``until``."""

        def answer(event: Any) -> None:
            event.interrupt(time.process_time() > until)

        asked = (self.highs.cbMipInterrupt, self.highs.cbSimplexInterrupt)
        for question in asked:
            question.subscribe(answer)
        try:
            self.highs.maximize(self.least)
        finally:
            for question in asked:
                question.unsubscribe(answer)
        values = np.array(self.highs.getSolution().col_value)
        chosen: FloatArray = values[1 : len(self.chosen) + 1]
        bound = float(self.highs.getInfo().mip_dual_bound) or np.inf  # 0 if it was ended before it had one
        if len(chosen) < len(self.chosen) or not chosen.any():
            return None, bound
        return np.array([choice[int(chosen[choice].argmax())] for choice in self.problem.choices]), bound
