"""Exchanges: attacks on any set function that no single exchange improves."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from ratt_opt.attack.heuristics import greedy_attack

if TYPE_CHECKING:
    from collections.abc import Iterable

    from ratt_opt.attack.task import AttackTask, PlanValues
    from ratt_opt.budget import Budget
    from ratt_opt.problem import Attack, Problem

__all__ = ["exchange_attack"]


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
            if value < self.value - self._problem.objective.least_improvement(self.value):
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
