"""Outcomes that rows are about: those of known attacks, then those that leave least of the fractional plan."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import combinations
from math import comb
from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.solvers.by_values.plan_tree import Pooled
from ratt_opt.solvers.by_values.rows import ElementClasses, RowBound
from ratt_opt.solvers.by_values.whole_function import WholeFunction

if TYPE_CHECKING:
    from ratt_opt._validation import FloatArray, IntArray
    from ratt_opt.budget import Budget
    from ratt_opt.problem import Problem
    from ratt_opt.setfunctions.base import SetFunction
    from ratt_opt.setfunctions.decomposition import Decomposition
    from ratt_opt.solvers.by_values.plan_attacks import PlanAttacks

__all__ = ["OutcomeParams", "RowSearch", "parts_of"]


@dataclass(frozen=True, slots=True, kw_only=True)
class OutcomeParams:
    """Effort for outcomes.

    ``most_blinded`` : sets of blinded robots that are looked through for the weakest at each fractional plan
    """

    most_blinded: int = 500


def parts_of(f: SetFunction, asked: SetFunction) -> Decomposition | None:
    """The parts of ``f``; all of it as one part if it is submodular, valued as ``asked``; ``None`` otherwise."""
    parts = f.decomposition()
    if parts is not None and parts.is_sum:
        return parts
    return WholeFunction(asked) if f.is_submodular else None


class RowSearch:
    """An upper end by rows; valid at any moment.

    ``single`` : (E,) individual values if the function is submodular
    """

    def __init__(self, problem: Problem, parts: Decomposition, attacks: PlanAttacks, single: FloatArray | None) -> None:
        self._problem, self._attacks, self._params = problem, attacks, OutcomeParams()
        threat = problem.threat
        self._only_blinds = threat.n_cut == 0 and len(problem.communication.groups()) == 1
        merges = self._only_blinds and not threat.protected_robots and not isinstance(parts, WholeFunction)
        self._columns = ElementClasses(problem, parts, merges=merges)
        self._bound = RowBound(problem, parts, self._columns)
        self._pooled, self._caps = Pooled(problem, single), dict[frozenset[int], float]()

    @property
    def upper(self) -> float:
        """No plan is worth more, unless it is worth no more than the best plan known."""
        return max(self._bound.upper, self._attacks.lower)

    @property
    def bound(self) -> float:
        """The bound of the rows themselves: less than the best plan's worst case only if a property is not kept."""
        return self._bound.upper

    @property
    def relies_on_caps(self) -> bool:
        """True if groups of some outcomes were left out, as they are worth no more than the best plan."""
        return not self._only_blinds

    def run(self, part: Budget) -> None:
        """Add outcomes and rows as long as they lower the end; raises ``OutOfBudget``."""
        for groups in list(self._attacks.known.values()):
            self._add(groups)
        more = True
        while more and self._bound.has_room and self.upper > self._attacks.lower:
            part.check()
            self._bound.run(part, self._attacks.lower)
            more = self._add_weakest()

    def rounded(self) -> IntArray:
        """(N,) a plan near the fractional one: robots of a class take its largest columns, each robot its own."""
        point, columns, plan = self._bound.point, self._columns, self._attacks.elements.copy()
        used: dict[int, int] = {}
        for i, choice in enumerate(self._problem.choices):
            weight = np.array([point[e] * columns.count[columns.column[e]] for e in choice])
            taken = np.array([used.get(int(columns.column[e]), 0) for e in choice])
            best = int(np.argmax(weight - taken))
            plan[i] = choice[best]
            used[int(columns.column[choice[best]])] = int(taken[best]) + 1
        limit = self._problem.choice_limit
        return plan if limit is None else limit.rest(plan, point[plan])

    def _add(self, groups: list[frozenset[int]]) -> bool:
        """Add what an attack leaves: the robots of all groups that may be worth more than the best plan known."""
        open_groups = groups if self._only_blinds else [g for g in groups if self._cap(g) > self._attacks.lower]
        left = np.zeros(self._problem.n_robots)
        left[[i for group in open_groups for i in group]] = 1.0
        return self._bound.has_room and self._bound.add_outcome(self._mean(left))

    def _mean(self, left: FloatArray) -> FloatArray:
        """(N,) the mean over all permutations of robots that the columns do not tell apart."""
        kind = self._columns.kind
        return np.asarray((np.bincount(kind, left) / self._columns.sizes)[kind])

    def _cap(self, group: frozenset[int]) -> float:
        if group not in self._caps:
            self._caps[group] = self._pooled(group)
        return self._caps[group]

    def _add_weakest(self) -> bool:
        """Add the outcome that leaves least of the fractional plan, if the robots blinded can be looked through."""
        problem = self._problem
        free = sorted(set(range(problem.n_robots)) - problem.protected_robots)
        n_blinded = problem.threat.n_blinded
        if not self._only_blinds or comb(len(free), n_blinded) > self._params.most_blinded:
            return False
        means = {}
        for blinded in combinations(free, n_blinded):
            left = np.ones(problem.n_robots)
            left[list(blinded)] = 0.0
            mean = self._mean(left)
            means[mean.tobytes()] = mean
        weakest = self._bound.weakest(list(means.values()))
        return weakest is not None and self._bound.has_room and self._bound.add_outcome(weakest)
