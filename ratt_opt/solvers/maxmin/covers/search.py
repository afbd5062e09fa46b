"""A search that shows that no plan is worth more than a level, or finds one that is.

It goes in depth (``dive.py``). From time to time it asks the linear program of the covers known (``program.py``)
which of its frames are dead ends: sums of covers that the program finds serve from then on. A plan that meets all
covers is attacked: it raises the level, or the attack shows a cover that it fails.
"""

from __future__ import annotations

from enum import Enum
from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.solvers.maxmin.covers.dive import Dive
from ratt_opt.solvers.maxmin.covers.loops.tables import Outcome
from ratt_opt.solvers.maxmin.covers.program import CoverProgram
from ratt_opt.solvers.maxmin.covers.sums import CoverSums

if TYPE_CHECKING:
    from collections.abc import Callable

    from ratt_opt._validation import FloatArray, IntArray
    from ratt_opt.solvers.maxmin.covers.elements import Elements
    from ratt_opt.solvers.maxmin.covers.separation import Separation
    from ratt_opt.solvers.maxmin.plans.incumbent import Incumbent
    from ratt_opt.solvers.maxmin.turns import Turns

__all__ = ["Ending", "LevelSearch"]

RUN = 100
"""Nodes between two looks at the clock and at the linear program: ten milliseconds with ten robots."""
ROUNDS_AT_ROOT, ROUNDS = 60, 4
"""Rounds of covers on one relaxed plan."""
CLOSED = 2e-6
"""What plans have to lack of a sum that is worth keeping."""


NEGLIGIBLE = 1e-6
"""Shares that count as none."""


class Ending(Enum):
    """Why a search ended."""

    PROVED = "no plan is worth more than the level"
    LIMIT = "its runs were spent, or its record is long"
    STOPPED = "it was time to stop"


class LevelSearch:
    """The search at one level, which rises with the best plan; it may be run on and on."""

    def __init__(
        self, elements: Elements, separation: Separation, incumbent: Incumbent, level: Callable[[], float]
    ) -> None:
        self._elements, self._separation, self._incumbent = elements, separation, incumbent
        self._level_now, self.level = level, level()
        self._program = CoverProgram(elements.problem, separation.pool, separation.count, separation.enough)
        self.sums = CoverSums(elements.problem.objective.n)
        self.dive = Dive(separation, self.sums)
        self.runs = 0

    def run(self, turns: Turns, runs: int) -> Ending:
        """Search until nothing is open, the runs are spent, or it is time to stop."""
        until = self.runs + runs
        while self.runs < until:
            if turns.budget.stop() is not None or turns.stop() is not None:
                return Ending.STOPPED
            if self.dive.is_long:
                return Ending.LIMIT
            if self.runs == 0:
                self._ask(0, turns, ROUNDS_AT_ROOT)
            outcome = self.dive.run(self.level, RUN)
            if outcome is Outcome.PROVED:
                return Ending.PROVED
            if outcome is Outcome.PLAN and not self._meet(self.dive.plan()):
                return Ending.STOPPED
            if outcome is Outcome.SPENT:
                turns.budget.nodes += 1
                self.runs += 1
                self._learn(turns)
        return Ending.LIMIT

    def _learn(self, turns: Turns) -> None:
        """Look for the first frame of the stack that is a dead end by a sum of covers."""
        first, last = 0, self.dive.frame
        while first < last:
            middle = (first + last) // 2
            if self._ask(middle, turns, ROUNDS):
                last = middle
            else:
                first = middle + 1

    def _ask(self, frame: int, turns: Turns, rounds: int) -> bool:
        """Whether a frame is a dead end by a sum of covers, which is kept."""
        allowed, pool = self.dive.allowed(frame), self._separation.pool
        for _ in range(rounds):
            if turns.stop() is not None:
                return False
            relaxed = self._program.solve(allowed, turns.seconds_left)
            if relaxed is None:
                return False
            lacking, terms = self._program.lacking(relaxed, allowed)
            if lacking > CLOSED:
                self.sums.add(relaxed.covers, relaxed.weights, terms)
                return True
            if not self._program.add(
                pool.violated(relaxed.x * self._separation.count, self._program.enough, self.level)
            ):
                found = self._separation.violated(relaxed.x, self.level, self._program.enough)
                if not self._program.add(found) and not self._cut_otherwise(relaxed.x):
                    return False
        return False

    def _cut_otherwise(self, x: FloatArray) -> bool:
        """Look for another way to cut links, by an attack on a relaxed plan as if it were one; whether there is."""
        problem = self._elements.problem
        objective = problem.information_objective
        mixed = np.zeros((problem.n_robots, *objective.prior.shape))
        used = np.flatnonzero(x > NEGLIGIBLE)
        np.add.at(mixed, problem.robot[used], x[used, None, None, None] * objective.information[used])
        self._incumbent.adversary.learn_relaxed(mixed)
        return self._separation.partitions.add_cuts_of(self._incumbent.pool)

    def _meet(self, plan: IntArray) -> bool:
        """Attack a plan: it raises the level, or shows a cover that it fails; whether one of both."""
        whole, pool = self._elements.problem.kept[plan], self._incumbent.pool
        if pool.plan_value(whole) > self.level:
            self._incumbent.offer(whole)
        values = pool.outcome_values(pool.group_values(pool.objective.information[whole]))
        if len(values) and values.min() <= self.level:
            self._separation.from_attack(plan, pool.attack(int(values.argmin())), self.level)
            return True
        raised = self._level_now()
        if raised <= self.level:
            return False  # it was time to stop before the plan was attacked
        self.level = raised  # what is a dead end stays one
        return True
