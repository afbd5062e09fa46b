"""Attacks on a plan whose objective is any set function, known by its values alone.

Upper end: attacks that no single exchange improves. Lower end: some group keeps ``k`` seeing robots
(``forced_survivors``), so by monotonicity it is worth at least the k-th smallest individual value, and at least the
strongest robot that cannot be blinded. Where theory proves the function submodular, every robot adds at least what it
adds on top of all others of the plan; where the function states a bound ``c`` on its total curvature, at least
``1 - c`` of its individual value. The ``k`` least of these add up to a bound.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.attackers.first_bound import strongest_left
from ratt_opt.attackers.forced_group import forced_survivors
from ratt_opt.attackers.heuristics.greedy import greedy_attack
from ratt_opt.setfunctions.metered import metered, unmetered

if TYPE_CHECKING:
    from collections.abc import Iterable

    from ratt_opt.attackers.task import AttackTask, PlanValues
    from ratt_opt.budget import Budget
    from ratt_opt.problem import Attack, Problem

__all__ = ["any_bound", "exchange_attack", "metered_problem"]


def metered_problem(problem: Problem, budget: Budget) -> Problem:
    """The problem whose objective counts its values in a budget and keeps within it."""
    return replace(problem, objective=metered(problem.objective, budget))


def any_bound(task: AttackTask) -> None:
    """Raise the lower end by what singles and marginals prove; relies on a non-decreasing objective."""
    values, threat = task.values, task.problem.threat
    size, f = forced_survivors(threat), unmetered(task.problem.objective)
    nothing = values(())
    task.bracket.raise_lower(nothing)
    if size == 0:
        return
    single = values.singletons()
    task.bracket.raise_lower(max(strongest_left(single, threat), float(np.sort(single)[size - 1])))
    kept = 1.0 - f.most_total_curvature
    if kept > 0:
        task.bracket.raise_lower(nothing + kept * float(np.sort(single - nothing)[:size].sum()))
    if f.is_submodular:
        everyone = range(values.n)
        top = values(everyone) - values.evaluate(~np.eye(values.n, dtype=np.bool_))
        task.bracket.raise_lower(nothing + float(np.sort(np.maximum(top, 0.0))[:size].sum()))


def exchange_attack(task: AttackTask) -> None:
    """Lower the upper end: greedy steps, then single exchanges as long as one hurts the team more."""
    problem, plan = task.problem, task.values.plan
    found = greedy_attack(problem, plan, budget=task.budget)
    task.bracket.offer(found.attack, found.upper)
    search = _Exchanges(problem, task.values, task.bracket.attack)
    while not task.bracket.is_closed and search.improve(task.budget):
        task.bracket.offer(search.attack, search.value)


class _Exchanges:
    """One attack and its neighbours: a blinded robot exchanged for one that sees, or two robots of two groups."""

    def __init__(self, problem: Problem, values: PlanValues, attack: Attack) -> None:
        self._problem, self._values = problem, values
        self._known: dict[frozenset[int], float] = {}
        self.attack, self.value = attack, self._team_value(attack)

    def improve(self, budget: Budget) -> bool:
        """Take the first exchange that hurts the team more; whether there is one."""
        for attack in self._neighbours():
            if budget.is_over:
                return False
            value = self._team_value(attack)
            if value < self.value:
                self.attack, self.value = attack, value
                return True
        return False

    def _neighbours(self) -> Iterable[Attack]:
        """Exchanges with a robot of the best group: others leave it as it is."""
        problem, attack = self._problem, self.attack
        parts = problem.communication.groups(attack.links)
        best = max(parts, key=lambda part: self._worth(part - attack.sensing))
        seeing = sorted(best - attack.sensing)
        for i in seeing:
            for b in sorted(attack.sensing):
                if i not in problem.protected_robots:
                    yield replace(attack, sensing=attack.sensing - {b} | {i})
        for part in parts:
            for i in seeing if part is not best else ():
                for e in sorted(part):
                    groups = [best - {i} | {e} if p is best else p - {e} | {i} if p is part else p for p in parts]
                    cut = problem.communication.links_between(groups)
                    if len(cut) <= problem.alpha_c and not cut & problem.protected_links:
                        yield replace(attack, links=cut)

    def _team_value(self, attack: Attack) -> float:
        return max(self._worth(group) for group in self._problem.groups_left(attack))

    def _worth(self, robots: frozenset[int]) -> float:
        if robots not in self._known:
            self._known[robots] = self._values(robots)
        return self._known[robots]
