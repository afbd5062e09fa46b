"""Levels tried by one search after the other, each lower than the bound, from the best plan known upwards.

A search at the level of the best plan ends it all. If it takes too long, levels further up are tried, so that the bound
falls step by step.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.budget import Stop
from ratt_opt.solvers.maxmin.frontier import ClosingRule
from ratt_opt.solvers.maxmin.levels.level_search import Ending
from ratt_opt.solvers.maxmin.plans.walk import Walk

if TYPE_CHECKING:
    from ratt_opt.solvers.maxmin.levels.elements import Elements
    from ratt_opt.solvers.maxmin.levels.level_search import LevelSearch
    from ratt_opt.solvers.maxmin.proof import UpperProof
    from ratt_opt.solvers.maxmin.search import Known, Progress
    from ratt_opt.solvers.maxmin.turns import Turns

__all__ = ["SearchByLevels"]

SHARES = (0.0, 0.25, 0.5, 0.75)
"""Of what is open, how far above the best plan the levels are that are tried in turn."""
WALK_KICKS, WALK_SHARE = 50, 0.05
"""Kicks, and share of the time left, in which a better plan is looked for once the best plan's level took too long."""
FIRST_RUNS, GROWTH = 20, 2
"""Runs of the first search at each level, and how many times as many the next ones have."""


class SearchByLevels(ABC):
    """``upper`` : proved upper bound on the optimum, infinite before the first search is complete."""

    def __init__(self, known: Known, elements: Elements) -> None:
        self._known, self._elements, self.upper = known, elements, np.inf
        self._rule = ClosingRule(known.incumbent.candidates, known.rule.gap)  # without the other search's floor
        self._searches: dict[int, LevelSearch] = {}
        self._runs, self._share, self._left = FIRST_RUNS, 0, FIRST_RUNS
        self._in_vain = np.inf
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

    def run(self, turns: Turns, progress: Progress, upper: float, most_nodes: int) -> Stop:
        """Search on until nothing is left, these nodes are spent or it is time to stop.

        ``upper`` : what is proved otherwise
        """
        budget = turns.budget
        until = budget.nodes + most_nodes
        self.upper, told = min(self.upper, upper), budget.nodes
        while True:
            if self.upper <= self._rule.better or self._rule.closes(self.upper):
                return Stop.GAP
            if (stop := budget.stop() or turns.stop()) is not None:
                return stop
            if budget.nodes >= until or self._level() >= self._in_vain:
                return Stop.NODES
            self._make_room()
            search = self._search()
            before = search.runs
            ending = search.run(turns, self._left)
            self._left -= search.runs - before
            if ending is Ending.LIMIT and self._share == 0:
                self._walk.run(budget.part(WALK_SHARE), WALK_KICKS)
            if ending is Ending.PROVED:
                self._keep(search)
                del self._searches[self._share]
                if self._share == 0:  # closed, or nothing is left but what its margins for rounding leave
                    self._in_vain = search.level
            self._next_share(ending)
            if progress is not None and budget.nodes > told:
                told = budget.nodes
                progress(budget.nodes, self._known.incumbent.proved.lower, self.upper)

    def _make_room(self) -> None:
        """Give up searches of long records."""
        self._searches = {share: search for share, search in self._searches.items() if not search.is_long}

    def _next_share(self, ending: Ending) -> None:
        """After the best plan's level come the higher ones, each lower than the last, as long as they are proved."""
        if ending is Ending.STOPPED:  # it goes on with the runs that are left
            return
        if self._share == 0 or ending is Ending.PROVED:
            self._share = (self._share - 1) % len(SHARES)
        else:
            self._share = 0
        if self._share == 0:
            self._runs *= GROWTH
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
        return max(floor + SHARES[self._share] * (self.upper - floor), self._rule.better)
