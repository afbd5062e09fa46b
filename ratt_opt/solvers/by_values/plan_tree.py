"""Plans of any non-decreasing function by branch and bound: robots not yet decided hold all their elements.

No completion of such a team is worth more than the team under any known attack. The node of the largest bound is
divided on one robot of the group that the team is left with; plans that known attacks rate above the best one are
attacked, which closes them or teaches an attack. A plan that is left as the node of the largest bound is attacked until
another one is. So it ends with the best plan, however long attacks take.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.budget import OutOfBudget, Stop
from ratt_opt.setfunctions.base import SetFunction, checked_values
from ratt_opt.setfunctions.metered import unmetered
from ratt_opt.solvers.by_values.divided_plans import DividedPlans

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable

    from ratt_opt._validation import BoolArray, FloatArray, IntArray
    from ratt_opt.budget import Budget
    from ratt_opt.problem import Problem
    from ratt_opt.solvers.by_values.plan_attacks import PlanAttacks

__all__ = ["PlanTree", "Pooled"]

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


class PlanTree(DividedPlans["IntArray"]):
    """The nodes that are left, bounded by monotonicity: (N,) elements, or ``OPEN``.

    ``worth`` : of a set of elements, its value
    ``known`` : what bounds all plans, and the nodes kept by their bounds
    """

    def __init__(
        self,
        problem: Problem,
        attacks: PlanAttacks,
        worth: Callable[[frozenset[int]], float],
        known: tuple[float, int],
    ) -> None:
        upper, most = known
        self._problem, self._worth = problem, worth
        super().__init__(np.full(problem.n_robots, OPEN, dtype=np.int64), upper, attacks, most)
        self._attacked: dict[bytes, float] = {}
        """Values of the attacked plans under attack."""

    def _divided(self, plans: IntArray, bound: float, budget: Budget) -> list[tuple[float, IntArray]]:
        """Drop a node, attack a plan of it, or divide it."""
        attacks, before = self._attacks, bound
        bound = min(bound, *(self._team_value(plans, groups) for groups in attacks.known.values()))
        if bound <= attacks.lower:
            return []
        is_plan = bool((plans != OPEN).all())
        plan = np.where(plans == OPEN, attacks.elements, plans)
        if (limit := self._problem.choice_limit) is not None:
            plan = limit.rest(plan, (plans != OPEN).astype(np.float64))
        key = plan.tobytes()
        if is_plan and key in self._attacked and bound == before:
            return self._settled_plan(plan, bound, budget)
        if key not in self._attacked and self._plan_value(plan) > attacks.lower:
            found = attacks.attack(plan)
            self._attacked[key] = found.upper
            bound = min(bound, self._team_value(plans, attacks.known[found.attack]))
        if bound <= attacks.lower:
            return []
        if is_plan:  # it is looked at again once no node has a larger bound
            return [(min(bound, self._attacked.get(key, bound)), plan)]
        return self._children(plans, bound)

    def _settled_plan(self, plan: IntArray, bound: float, budget: Budget) -> list[tuple[float, IntArray]]:
        """Attack the plan of the largest bound until less is proved of it, or no more can be.

        Raises
        ------
        OutOfBudget : its next step needs more values than are left; that step would be tried for ever.
        """
        before, spent = bound, budget.evaluations
        found = self._attacks.settle(plan, float(np.nextafter(bound, -np.inf)))
        bound = min(bound, found.upper)
        if bound <= self._attacks.lower:
            return []
        if found.stop not in {Stop.TIME, Stop.EVALUATIONS, Stop.GAP}:
            self._settle(bound)
            return []
        if found.stop is Stop.EVALUATIONS and bound == before and budget.evaluations == spent:
            raise OutOfBudget(found.stop)
        return [(bound, plan)]

    def _children(self, partial: IntArray, bound: float) -> list[tuple[float, IntArray]]:
        """The parts of a node, one for each element of a robot of the group that the known attacks leave."""
        children = []
        for e in self._elements_of(self._robot(partial), partial):
            child = partial.copy()
            child[self._problem.robot[e]] = e
            children.append((bound, child))
        return children

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
