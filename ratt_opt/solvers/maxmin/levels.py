"""Searches in depth that show that no plan is worth more than a level, or find one that is.

Levels are tried by one search after the other, each lower than the bound, from the best plan known upwards. A search at
the level of the best plan ends it all. If it takes too long, levels further up are tried, so that the bound falls step
by step. What ends a search are covers (``covers/``) or marginal gains (``marginal_search.py``).
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from enum import Enum, IntEnum
from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.attack.team import LARGEST_DIMENSION
from ratt_opt.budget import Stop
from ratt_opt.setfunctions.criteria.logdet import LogDetObjective
from ratt_opt.setfunctions.criteria.trace import TraceObjective
from ratt_opt.solvers.maxmin.bound_stage import BoundStage, TurnShare
from ratt_opt.solvers.maxmin.walk import Walk

if TYPE_CHECKING:
    from collections.abc import Callable

    from ratt_opt._validation import IntArray
    from ratt_opt.solvers.maxmin.elements import Elements
    from ratt_opt.solvers.maxmin.incumbent import Incumbent
    from ratt_opt.solvers.maxmin.known import Known
    from ratt_opt.solvers.maxmin.proof import UpperProof
    from ratt_opt.solvers.maxmin.time_slices import TimeSlices, Turn

__all__ = ["DepthStage", "LevelSearch", "Outcome", "SearchByLevels"]


class Outcome(IntEnum):
    """End of a run of the search in depth."""

    PROVED = 0
    """No node is left."""
    SPENT = 1
    """All nodes of the run are spent."""
    PLAN = 2
    """One plan is left."""
    FULL = 3
    """An array is full."""


class Ending(Enum):
    """Reason why a search ended."""

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
        """True if the record is as long as memory should hold."""

    def run(self, slices: TimeSlices, runs: float) -> Ending:
        """Search until nothing is open, the runs are spent, or it is time to stop."""
        until = self.runs + runs
        while self.runs < until:
            if slices.budget.stop() is not None or slices.stop() is not None:
                return Ending.STOPPED
            if self.is_long:
                return Ending.LIMIT
            if self.runs == 0:
                self._begin(slices)
            outcome = self._search_on()
            if outcome is Outcome.PROVED:
                return Ending.PROVED
            if outcome is Outcome.PLAN and not self._meet(self._plan()):
                return Ending.STOPPED
            if outcome is Outcome.SPENT:
                slices.budget.nodes += 1
                self.runs += 1
                self._learn(slices)
        return Ending.LIMIT

    @abstractmethod
    def _search_on(self) -> Outcome:
        """Search on for one run's nodes."""

    @abstractmethod
    def _plan(self) -> IntArray:
        """(N,) the plan that is left, of the undominated elements."""

    def _begin(self, slices: TimeSlices) -> None:  # noqa: B027  (a search may have nothing to do then; so may those below)
        """Prepare the first run."""

    def _learn(self, slices: TimeSlices) -> None:  # noqa: B027
        """Learn from a run whose nodes were spent."""

    def _use_attack(self, plan: IntArray, outcome: int) -> None:  # noqa: B027
        """Take note that a known outcome leaves a plan no more than the level."""

    def _meet(self, plan: IntArray) -> bool:
        """Attack a plan: it raises the level, or an attack leaves it no more; whether one of both."""
        whole, pool = self._elements.problem.kept[plan], self._incumbent.pool
        if pool.plan_value(whole) > self.level:
            self._incumbent.offer(whole)
        values = pool.outcome_values(pool.group_values(pool.objective.information[whole]))
        if len(values) and values.min() <= self.level:
            self._use_attack(plan, int(values.argmin()))
            return True
        raised = self._level_now()
        if raised <= self.level:
            return False  # it was time to stop before the plan was attacked
        self.level = raised  # what is a dead end stays one
        return True


class SearchByLevels(ABC):
    """``upper`` : upper bound on the optimum that this search proved, infinite before the first level is done."""

    def __init__(self, known: Known, elements: Elements) -> None:
        self._known, self._elements, self.upper = known, elements, np.inf
        self._searches: dict[int, LevelSearch] = {}
        self._params = known.task.params.levels
        self._runs, self._share, self._left = self._params.runs, 0, self._params.runs
        self._in_vain = self._others = np.inf
        self._walk = Walk(known.incumbent, np.random.default_rng(0))

    @abstractmethod
    def proof(self) -> UpperProof:
        """The proof of ``upper``."""

    @abstractmethod
    def _begun(self) -> LevelSearch:
        """A new search at the present level."""

    @abstractmethod
    def _keep(self, search: LevelSearch) -> None:
        """Take what a search proved."""

    def run(self, turn: Turn) -> Stop:
        """Search on until nothing is left, the turn's nodes are spent or it is time to stop."""
        slices, progress, budget = turn.slices, turn.progress, turn.slices.budget
        until, told = budget.nodes + turn.nodes, budget.nodes
        self._others = turn.upper
        while True:
            if (upper := self._lowest()) <= self._known.rule.better or self._known.rule.closes(upper):
                return Stop.GAP
            if (stop := budget.stop() or slices.stop()) is not None:
                return stop
            if budget.nodes >= until or self._level() >= self._in_vain:
                return Stop.NODES
            self._make_room()
            search = self._search()
            before = search.runs
            ending = search.run(slices, min(self._left, until - budget.nodes))
            self._left -= search.runs - before
            if ending is Ending.LIMIT and self._left > 0 and not search.is_long:
                continue  # these nodes are spent, its runs are not
            if ending is Ending.LIMIT and self._share == 0:
                self._walk.run(budget.part(self._params.walk_share), self._params.walk_kicks)
            if ending is Ending.PROVED:
                self._keep(search)
                del self._searches[self._share]
                if self._share == 0:  # closed, or nothing is left but what its margins for rounding leave
                    self._in_vain = search.level
            self._next_share(ending)
            if progress is not None and budget.nodes > told:
                told = budget.nodes
                progress(budget.nodes, self._known.incumbent.proved.lower, self._lowest())

    def _make_room(self) -> None:
        """Give up searches of long records."""
        self._searches = {share: search for share, search in self._searches.items() if not search.is_long}

    def _next_share(self, ending: Ending) -> None:
        """Choose the next level: the best plan's, then higher ones, each lower than the last, while proved."""
        if ending is Ending.STOPPED:  # it goes on with the runs that are left
            return
        if self._share == 0 or ending is Ending.PROVED:
            self._share = (self._share - 1) % len(self._params.shares)
        else:
            self._share = 0
        if self._share == 0:
            self._runs *= self._params.growth
        self._left = self._runs

    def _search(self) -> LevelSearch:
        """The search of the present share, a new one if the level is lower than that of the last."""
        search = self._searches.get(self._share)
        if search is None or search.level > self._level():
            search = self._searches[self._share] = self._begun()
        search.level = self._level()
        return search

    def _level(self) -> float:
        floor = self._known.incumbent.candidates.level
        share, upper = self._params.shares[self._share], self._lowest()
        return max(floor + share * (upper - floor) if share > 0 else floor, self._known.rule.better)

    def _lowest(self) -> float:
        """The upper end by this search or by others."""
        return min(self.upper, self._others)


class DepthStage(BoundStage):
    """Stage that searches in depth, level by level."""

    kind = "in depth"

    def applies(self, known: Known) -> bool:
        """Robots see few targets, all may choose, and the criterion is trace or log-det, of up to 64 dimensions."""
        objective = known.task.objective
        is_sum = objective.compiled_code in {TraceObjective.native_kernel, LogDetObjective.native_kernel}
        if known.task.problem.at_most is not None or not is_sum or objective.dimension > LARGEST_DIMENSION:
            return False
        seen = np.trace(objective.information, axis1=-2, axis2=-1) > 0
        return bool(seen.mean() <= 1 - known.task.params.depth.unseen) and self.fits(known)

    @abstractmethod
    def fits(self, known: Known) -> bool:
        """Tell whether the search can hold the team's elements."""

    def share(self, known: Known) -> TurnShare:
        """Return many nodes for each of the trees', fewer beside rows after turns in vain."""
        params = known.task.params.depth
        if known.rows_from == 0:
            return TurnShare(first=params.first, most=params.most, in_vain=params.in_vain)
        return TurnShare(first=params.most, most=params.most)
