"""Plans improved by exchanges of one robot's element, judged by the attacks known so far; kicks beyond them."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.attack.task import metered_problem
from ratt_opt.budget import OutOfBudget

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

    from ratt_opt._validation import FloatArray, IntArray
    from ratt_opt.budget import Budget
    from ratt_opt.problem import Problem
    from ratt_opt.solvers.by_values.plan_attacks import PlanAttacks

__all__ = ["Climbing"]


class Climbing:
    """Values of sets of elements, kept from plan to plan; what the known attacks leave of a plan; climbs.

    ``most_kept`` : values; beyond, they are computed again
    """

    def __init__(self, problem: Problem, attacks: PlanAttacks, most_kept: int) -> None:
        self._problem, self._attacks, self._most_kept = problem, attacks, most_kept
        self._known: dict[frozenset[int], float] = {}
        self._asked = attacks.problem.objective

    def climbed(self, elements: IntArray, part: Budget, *, attacks: bool = False) -> IntArray:
        """Exchange one robot's element at a time while the known attacks leave more, within a part of the budget.

        All elements of a robot are valued in one batch, and the best of them is taken. ``attacks`` : whether each
        exchange is attacked before it counts, so that exact worst cases rise and no attack is missed
        """
        self._asked = metered_problem(self._attacks.problem, part).objective
        current = elements.copy()
        try:
            if attacks:
                self._attacks.attack(elements, part.part(), -np.inf)
            value, unchanged, i = self.value(elements), 0, 0
            while unchanged < len(current):
                unchanged += 1
                for base in self._bases(current, i):
                    part.check()
                    found = self._best_exchange(base, i, value)
                    while attacks and found is not None and self._is_refuted(base, (i, found[0]), value, part):
                        found = self._best_exchange(base, i, value)
                    if found is not None:
                        current, value, unchanged = base, found[1], 0
                        current[i] = found[0]
                        break
                i = (i + 1) % len(current)
        except OutOfBudget:
            self._attacks.budget.check()
        finally:
            self._asked = self._attacks.problem.objective
        return current

    def _is_refuted(self, base: IntArray, exchange: tuple[int, int], value: float, part: Budget) -> bool:
        """Attack a plan with one exchange until that leaves no more than a value; whether the attack was not known."""
        part.check()
        known, plan = len(self._attacks.known), base.copy()
        plan[exchange[0]] = exchange[1]
        self._attacks.attack(plan, part.part(), value)
        return len(self._attacks.known) > known

    def _bases(self, plan: IntArray, robot: int) -> Iterator[IntArray]:
        """Plans in which a robot may take another element: one busy robot rests if no more may be busy."""
        limit = self._problem.choice_limit
        if limit is None or limit.busy(plan)[robot] or limit.busy(plan).sum() < limit.most:
            yield plan.copy()
            return
        for j in np.flatnonzero(limit.busy(plan)).tolist():
            base = plan.copy()
            base[j] = limit.idle[j]
            yield base

    def kicked(self, elements: IntArray, rng: np.random.Generator, robots: int) -> IntArray:
        """Give some robots other elements at random."""
        other = elements.copy()
        for i in rng.permutation(len(elements))[:robots]:
            other[i] = rng.choice(self._problem.choices[i])
        limit = self._problem.choice_limit
        return other if limit is None else limit.rest(other, rng.random(len(other)))

    def worth(self, elements: frozenset[int]) -> float:
        """Value of a set of elements, within the part of the budget that is being spent."""
        return self._worth_of([elements])[0]

    def value(self, elements: IntArray) -> float:
        """Return the value of a plan under the worst of the known attacks."""
        return min(self._team_values(elements))

    def _best_exchange(self, current: IntArray, robot: int, value: float) -> tuple[int, float] | None:
        """The element of one robot with which the known attacks leave most, and what they leave; ``None`` if no more.

        Attacks that leave least now come first: few elements are left for the others.
        """
        goal = value + self._problem.objective.least_improvement(value)
        choice = self._problem.choices[robot]
        left = choice[choice != current[robot]]
        low: FloatArray = np.full(len(left), np.inf)
        known = list(self._attacks.known.values())
        for position in np.argsort(self._team_values(current), kind="stable"):
            low = np.minimum(low, self._exchanged(current, robot, known[position], left))
            left, low = left[low > goal], low[low > goal]
            if not len(left):
                return None
        best = int(low.argmax())
        return int(left[best]), float(low[best])

    def _exchanged(self, current: IntArray, robot: int, groups: list[frozenset[int]], left: IntArray) -> FloatArray:
        """(K,) what one attack leaves if the robot takes each of the elements ``left``."""
        others = self._worth_of([_elements(current, group) for group in groups if robot not in group])
        values: FloatArray = np.full(len(left), max(others, default=-np.inf))
        for group in groups:
            if robot in group:
                base = current[sorted(group - {robot})]
                values = np.maximum(values, self._asked.extensions(base, left))
        return values

    def _team_values(self, elements: IntArray) -> list[float]:
        """Return the value of a plan under each of the known attacks."""
        groups = [[_elements(elements, group) for group in parts] for parts in self._attacks.known.values()]
        flat = iter(self._worth_of([group for parts in groups for group in parts]))
        return [max(next(flat) for _ in parts) for parts in groups]

    def _worth_of(self, sets: list[frozenset[int]]) -> list[float]:
        """Values of sets; those that are not known are computed in one batch."""
        if len(self._known) > self._most_kept:
            self._known.clear()
        new = list({one: None for one in sets if one not in self._known})
        if new:
            self._known.update(zip(new, self._asked.values_of(new).tolist(), strict=True))
        return [self._known[one] for one in sets]


def _elements(plan: IntArray, group: Iterable[int]) -> frozenset[int]:
    return frozenset(plan[sorted(group)].tolist())
