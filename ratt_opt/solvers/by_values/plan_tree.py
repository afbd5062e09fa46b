"""Plans of any non-decreasing function by branch and bound: robots not yet decided hold all their elements.

No completion of such a team is worth more than the team under any known attack. The node of the largest bound is
divided on one robot of the group that the team is left with; plans that known attacks rate above the best one are
attacked, which closes them or teaches an attack. A plan that is left as the node of the largest bound is attacked until
another one is. So it ends with the best plan, however long attacks take.
"""

from __future__ import annotations

from heapq import heappop, heappush
from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.budget import OutOfBudget, Stop
from ratt_opt.setfunctions.base import SetFunction, checked_values
from ratt_opt.setfunctions.metered import unmetered

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable

    from ratt_opt._validation import BoolArray, FloatArray, IntArray
    from ratt_opt.budget import Budget
    from ratt_opt.problem import Problem
    from ratt_opt.solvers.by_values.plan_attacks import PlanAttacks

__all__ = ["PlanTree", "Pooled"]

MOST_OPEN = 50_000
"""Nodes kept by their bounds; beyond, the last ones are divided first, which keeps few more."""

OPEN = -1


class Pooled(SetFunction):
    """Upper bound, for a set of robots, on the value of any plan's elements of them.

    It is the value of all their elements; of a submodular function also the sum of the largest individual values, if
    that is less. If few robots may be busy, it is the sum of that many.
    """

    __slots__ = ("_best", "_f", "_most", "_owners")

    def __init__(self, problem: Problem, single: FloatArray | None) -> None:
        self._f, self._owners = unmetered(problem.objective), problem.robot
        self._most = self.n if problem.at_most is None else problem.at_most
        self._best = None if single is None else np.array([single[choice].max() for choice in problem.choices])

    @property
    def n(self) -> int:
        """Number of robots."""
        return int(self._owners.max()) + 1

    def evaluate(self, membership: BoolArray) -> FloatArray:
        """(K,) values of the sets of robots in the rows of ``membership`` (K, N)."""
        values = checked_values(self._f, membership[:, self._owners])
        if self._best is None:
            return values
        rising = np.sort(membership * self._best, axis=1)
        return np.asarray(np.minimum(values, rising[:, self.n - self._most :].sum(axis=1)))


class PlanTree:
    """The nodes that are left; valid whenever it stops.

    ``worth`` : of a set of elements, its value
    """

    def __init__(
        self, problem: Problem, attacks: PlanAttacks, worth: Callable[[frozenset[int]], float], upper: float
    ) -> None:
        self._problem, self._attacks, self._worth = problem, attacks, worth
        nothing = np.full(problem.n_robots, OPEN, dtype=np.int64)
        self._heap: list[tuple[float, int, IntArray]] = [(-upper, 0, nothing)]
        self._last: list[tuple[float, int, IntArray]] = []
        self._count, self._settled = 0, -np.inf
        self._attacked: dict[bytes, float] = {}
        """Values of the attacked plans under attack."""

    @property
    def upper(self) -> float:
        """No plan of which less is known than of the best one is worth more."""
        return max(self._settled, self._largest_left())

    @property
    def is_finished(self) -> bool:
        """True if dividing can prove no more: the plans left are those of which attacks prove no more."""
        return self._settled >= self._largest_left()

    def _largest_left(self) -> float:
        return max((-node[0] for node in [*self._heap[:1], *self._last]), default=-np.inf)

    def divide(self, budget: Budget) -> None:
        """Take the next node: drop it, attack a plan of it, or divide it."""
        is_largest = not self._last
        node = heappop(self._heap) if is_largest else self._last.pop()
        attacks, partial = self._attacks, node[2]
        bound = min(-node[0], *(self._team_value(partial, groups) for groups in attacks.known.values()))
        budget.nodes += 1
        if bound <= attacks.lower:
            return
        is_plan = bool((partial != OPEN).all())
        plan = np.where(partial == OPEN, attacks.elements, partial)
        if (limit := self._problem.choice_limit) is not None:
            plan = limit.rest(plan, (partial != OPEN).astype(np.float64))
        if is_plan and plan.tobytes() in self._attacked and is_largest and bound == -node[0]:
            self._settle(plan, bound, budget)
            return
        if plan.tobytes() not in self._attacked and self._plan_value(plan) > attacks.lower:
            found = attacks.attack(plan)
            self._attacked[plan.tobytes()] = found.upper
            bound = min(bound, self._team_value(partial, attacks.known[found.attack]))
        if bound <= attacks.lower:
            return
        if is_plan:
            self._keep_plan(plan, min(bound, self._attacked.get(plan.tobytes(), bound)))
        else:
            self._push(partial, bound)

    def _settle(self, plan: IntArray, bound: float, budget: Budget) -> None:
        """Attack the plan of the largest bound until another bound is larger, or no more can be proved of it.

        Raises
        ------
        OutOfBudget : its next step needs more values than are left; that step would be tried for ever.
        """
        before, spent = bound, budget.evaluations
        found = self._attacks.settle(plan, min(self._largest_left(), float(np.nextafter(bound, -np.inf))))
        bound = min(bound, found.upper)
        if bound <= self._attacks.lower:
            return
        if found.stop in {Stop.TIME, Stop.EVALUATIONS, Stop.GAP}:
            self._keep_plan(plan, bound)
            if found.stop is Stop.EVALUATIONS and bound == before and budget.evaluations == spent:
                raise OutOfBudget(found.stop)
        else:
            self._settled = max(self._settled, bound)

    def _push(self, partial: IntArray, bound: float) -> None:
        """The parts of a node, one for each element of a robot of the group that the known attacks leave."""
        for e in self._elements_of(self._robot(partial), partial):
            child = partial.copy()
            child[self._problem.robot[e]] = e
            self._keep(child, bound)

    def _keep_plan(self, plan: IntArray, bound: float) -> None:
        """Look at a plan again once no node has a larger bound."""
        self._count += 1
        heappush(self._heap, (-bound, self._count, plan))

    def _keep(self, partial: IntArray, bound: float) -> None:
        self._count += 1
        one = (-bound, self._count, partial)
        if len(self._heap) < MOST_OPEN:
            heappush(self._heap, one)
        else:
            self._last.append(one)

    def _elements_of(self, robot: int, partial: IntArray) -> IntArray:
        """Elements that an open robot may take beside those that are decided: its idle one if enough are busy."""
        limit = self._problem.choice_limit
        if limit is None or int((limit.busy(partial) & (partial != OPEN)).sum()) < limit.most:
            return self._problem.choices[robot]
        return limit.idle[robot : robot + 1]

    def _robot(self, partial: IntArray) -> int:
        """The open robot whose decision lowers most what the worst known attack leaves of its best group."""
        attacks = self._attacks.known.values()
        groups = min(attacks, key=lambda groups: self._team_value(partial, groups))
        best = max(groups, key=lambda group: self._group_value(partial, group))
        inside = [i for i in sorted(best) if partial[i] == OPEN] or np.flatnonzero(partial == OPEN).tolist()
        return min(inside, key=lambda i: self._decided(partial, best, i))

    def _decided(self, partial: IntArray, group: Iterable[int], robot: int) -> float:
        """The most that a group is worth once one robot is decided."""
        values = []
        for e in self._elements_of(robot, partial):
            child = partial.copy()
            child[robot] = e
            values.append(self._group_value(child, group))
        return max(values)

    def _plan_value(self, plan: IntArray) -> float:
        return min(self._team_value(plan, groups) for groups in self._attacks.known.values())

    def _team_value(self, partial: IntArray, groups: Iterable[frozenset[int]]) -> float:
        return max(self._group_value(partial, group) for group in groups)

    def _group_value(self, partial: IntArray, group: Iterable[int]) -> float:
        """Bound the value of a group: its open robots hold all their elements."""
        held: set[int] = set()
        for i in group:
            held.update(self._elements_of(i, partial).tolist() if partial[i] == OPEN else (int(partial[i]),))
        return self._worth(frozenset(held))
