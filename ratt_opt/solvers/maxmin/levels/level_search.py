"""A search that shows that no plan is worth more than a level, or finds one that is.

A plan that is left is attacked: it raises the level, or the attack shows why it is a dead end.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from enum import Enum, IntEnum
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Callable

    from ratt_opt._validation import IntArray
    from ratt_opt.solvers.maxmin.levels.elements import Elements
    from ratt_opt.solvers.maxmin.plans.incumbent import Incumbent
    from ratt_opt.solvers.maxmin.turns import Turns

__all__ = ["Ending", "LevelSearch", "Outcome"]


class Outcome(IntEnum):
    """How a run of the search in depth ends."""

    PROVED = 0
    """Nothing is left."""
    SPENT = 1
    """Its nodes are spent."""
    PLAN = 2
    """One plan is left."""
    FULL = 3
    """An array is full."""


class Ending(Enum):
    """Why a search ended."""

    PROVED = "no plan is worth more than the level"
    LIMIT = "its runs were spent, or its record is long"
    STOPPED = "it was time to stop"


class LevelSearch(ABC):
    """The search at one level, which rises with the best plan; it may be run on and on."""

    def __init__(self, elements: Elements, incumbent: Incumbent, level: Callable[[], float]) -> None:
        self._elements, self._incumbent = elements, incumbent
        self._level_now, self.level = level, level()
        self.runs = 0

    @property
    @abstractmethod
    def is_long(self) -> bool:
        """Whether its record is as long as memory should hold."""

    def run(self, turns: Turns, runs: int) -> Ending:
        """Search until nothing is open, the runs are spent, or it is time to stop."""
        until = self.runs + runs
        while self.runs < until:
            if turns.budget.stop() is not None or turns.stop() is not None:
                return Ending.STOPPED
            if self.is_long:
                return Ending.LIMIT
            if self.runs == 0:
                self._begin(turns)
            outcome = self._search_on()
            if outcome is Outcome.PROVED:
                return Ending.PROVED
            if outcome is Outcome.PLAN and not self._meet(self._plan()):
                return Ending.STOPPED
            if outcome is Outcome.SPENT:
                turns.budget.nodes += 1
                self.runs += 1
                self._learn(turns)
        return Ending.LIMIT

    @abstractmethod
    def _search_on(self) -> Outcome:
        """Search on for one run's nodes."""

    @abstractmethod
    def _plan(self) -> IntArray:
        """(N,) the plan that is left, of the undominated elements."""

    def _begin(self, turns: Turns) -> None:  # noqa: B027  (a search may have nothing to do then; so may those below)
        """What is to be done before the first run."""

    def _learn(self, turns: Turns) -> None:  # noqa: B027
        """What is to be done after a run whose nodes were spent."""

    def _heed(self, plan: IntArray, outcome: int) -> None:  # noqa: B027
        """Take note that a known outcome leaves a plan no more than the level."""

    def _meet(self, plan: IntArray) -> bool:
        """Attack a plan: it raises the level, or an attack leaves it no more; whether one of both."""
        whole, pool = self._elements.problem.kept[plan], self._incumbent.pool
        if pool.plan_value(whole) > self.level:
            self._incumbent.offer(whole)
        values = pool.outcome_values(pool.group_values(pool.objective.information[whole]))
        if len(values) and values.min() <= self.level:
            self._heed(plan, int(values.argmin()))
            return True
        raised = self._level_now()
        if raised <= self.level:
            return False  # it was time to stop before the plan was attacked
        self.level = raised  # what is a dead end stays one
        return True
