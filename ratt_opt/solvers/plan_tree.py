"""Plans of any non-decreasing function by branch and bound: robots not yet decided hold all their elements.

No completion of such a team is worth more than the team under any known attack. The node of the largest bound is
divided on one robot of the group that the team is left with; plans that known attacks rate above the best one are
attacked, which closes them or teaches an attack. So it ends with the best plan where attacks on plans are exact.
"""

from __future__ import annotations

from heapq import heappop, heappush
from typing import TYPE_CHECKING, Protocol

import numpy as np

from ratt_opt.setfunctions.base import SetFunction, checked_values
from ratt_opt.setfunctions.metered import unmetered

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping

    from ratt_opt._validation import BoolArray, FloatArray, IntArray
    from ratt_opt.attackers.task import AttackResult
    from ratt_opt.budget import Budget
    from ratt_opt.problem import Attack, Problem

__all__ = ["PlanTree", "Pooled"]

MOST_OPEN = 50_000
"""Nodes kept by their bounds; beyond, the last ones are divided first, which keeps few more."""

OPEN = -1


class Pooled(SetFunction):
    """Of robots: no plan's elements of them are worth more. The value of all their elements; of a submodular function
    also the sum of the largest individual values, where that is less."""

    __slots__ = ("_best", "_f", "_owners")

    def __init__(self, problem: Problem, single: FloatArray | None) -> None:
        self._f, self._owners = unmetered(problem.objective), problem.robot
        self._best = None if single is None else np.array([single[choice].max() for choice in problem.choices])

    @property
    def n(self) -> int:
        """Number of robots."""
        return int(self._owners.max()) + 1

    def evaluate(self, membership: BoolArray) -> FloatArray:
        """(K,) values of the sets of robots in the rows of ``membership`` (K, N)."""
        values = checked_values(self._f, membership[:, self._owners])
        return values if self._best is None else np.minimum(values, membership @ self._best)


class Search(Protocol):
    """What the tree asks of the search it is part of."""

    elements: IntArray
    lower: float

    @property
    def attacks(self) -> Mapping[Attack, list[frozenset[int]]]:
        """Attacks known so far, and the seeing robots of the groups that each leaves."""

    def worth(self, elements: frozenset[int]) -> float:
        """Value of a set of elements."""

    def attack(self, elements: IntArray) -> AttackResult:
        """Attack a plan; keep it where more is proved of it than of the best one."""


class PlanTree:
    """The nodes that are left; valid whenever it stops."""

    def __init__(self, problem: Problem, search: Search, upper: float) -> None:
        self._problem, self._search = problem, search
        nothing = np.full(problem.n_robots, OPEN, dtype=np.int64)
        self._heap: list[tuple[float, int, IntArray]] = [(-upper, 0, nothing)]
        self._last: list[tuple[float, int, IntArray]] = []
        self._count, self._unproved = 0, -np.inf
        self._attacked: dict[bytes, float] = {}
        """What attacks leave of the plans that were attacked here."""

    @property
    def upper(self) -> float:
        """No plan of which less is known than of the best one is worth more."""
        left = [-bound for bound, _, _ in [*self._heap[:1], *self._last]]
        return max([self._unproved, *left])

    @property
    def is_finished(self) -> bool:
        """Whether dividing can prove no more: what is left are plans whose attacks did not close."""
        return -self._unproved <= min((node[0] for node in [*self._heap[:1], *self._last]), default=np.inf)

    def divide(self, budget: Budget) -> None:
        """Take the next node: drop it, attack a plan of it, or divide it."""
        node = self._last.pop() if self._last else heappop(self._heap)
        search, partial = self._search, node[2]
        bound = min(-node[0], *(self._team_value(partial, groups) for groups in search.attacks.values()))
        budget.nodes += 1
        if bound <= search.lower:
            return
        plan = np.where(partial == OPEN, search.elements, partial)
        if plan.tobytes() not in self._attacked and self._plan_value(plan) > search.lower:
            found = search.attack(plan)
            self._attacked[plan.tobytes()] = found.upper
            bound = min(bound, self._team_value(partial, search.attacks[found.attack]))
        if bound <= search.lower:
            return
        if (partial != OPEN).all():
            self._unproved = max(self._unproved, min(bound, self._attacked[plan.tobytes()]))
        else:
            self._push(partial, bound)

    def _push(self, partial: IntArray, bound: float) -> None:
        """The parts of a node, one for each element of a robot of the group that the known attacks leave."""
        for e in self._elements_of(self._robot(partial)):
            child = partial.copy()
            child[self._problem.robot[e]] = e
            self._count += 1
            one = (-bound, self._count, child)
            if len(self._heap) < MOST_OPEN:
                heappush(self._heap, one)
            else:
                self._last.append(one)

    def _elements_of(self, robot: int) -> IntArray:
        return self._problem.choices[robot]

    def _robot(self, partial: IntArray) -> int:
        """The open robot whose decision lowers most what the worst known attack leaves of its best group."""
        attacks = self._search.attacks.values()
        groups = min(attacks, key=lambda groups: self._team_value(partial, groups))
        best = max(groups, key=lambda group: self._group_value(partial, group))
        inside = [i for i in sorted(best) if partial[i] == OPEN] or np.flatnonzero(partial == OPEN).tolist()
        return min(inside, key=lambda i: self._decided(partial, best, i))

    def _decided(self, partial: IntArray, group: Iterable[int], robot: int) -> float:
        """The most that a group is worth once one robot is decided."""
        values = []
        for e in self._elements_of(robot):
            child = partial.copy()
            child[robot] = e
            values.append(self._group_value(child, group))
        return max(values)

    def _plan_value(self, plan: IntArray) -> float:
        return min(self._team_value(plan, groups) for groups in self._search.attacks.values())

    def _team_value(self, partial: IntArray, groups: Iterable[frozenset[int]]) -> float:
        return max(self._group_value(partial, group) for group in groups)

    def _group_value(self, partial: IntArray, group: Iterable[int]) -> float:
        """Of a group whose open robots hold all their elements."""
        held: set[int] = set()
        for i in group:
            held.update(self._elements_of(i).tolist() if partial[i] == OPEN else (int(partial[i]),))
        return self._search.worth(frozenset(held))
