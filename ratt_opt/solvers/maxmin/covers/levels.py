"""Levels tried by one search after the other, each lower than the bound, from the best plan known upwards.

A search at the level of the best plan ends it all. If it takes too long, levels further up are tried, so that the bound
falls step by step. Covers are true for all levels above the one that they were found for, and serve there, too.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.setfunctions.criteria.logdet import LogDetObjective
from ratt_opt.setfunctions.criteria.trace import TraceObjective
from ratt_opt.solvers.maxmin.covers.cover import cover_bound
from ratt_opt.solvers.maxmin.covers.elements import Elements
from ratt_opt.solvers.maxmin.covers.loops.tables import BY_COVER, BY_SUM
from ratt_opt.solvers.maxmin.covers.pool import MOST_CHOICES
from ratt_opt.solvers.maxmin.covers.records import DiveProof
from ratt_opt.solvers.maxmin.covers.search import Ending, LevelSearch
from ratt_opt.solvers.maxmin.covers.separation import Separation
from ratt_opt.solvers.maxmin.frontier import ClosingRule
from ratt_opt.solvers.maxmin.plans.walk import Walk
from ratt_opt.stopping import Stop

if TYPE_CHECKING:
    from ratt_opt.solvers.maxmin.proof import UpperProof
    from ratt_opt.solvers.maxmin.search import Known, Progress
    from ratt_opt.solvers.maxmin.turns import Turns

__all__ = ["CoverSearch"]

SUMS = frozenset((TraceObjective.compiled_code, LogDetObjective.compiled_code))
"""Criteria that are sums over targets."""
UNSEEN = 0.25
"""Least share of pairs of an element and a target without information for covers to be looked for."""
SHARES = (0.0, 0.25, 0.5, 0.75)
"""Of what is open, how far above the best plan the levels are that are tried in turn."""
WALK_KICKS, WALK_SHARE = 50, 0.05
"""Kicks, and share of the time left, in which a better plan is looked for once the best plan's level took too long."""
MOST_COVERS = 20_000
"""Covers that are known at once: a node looks at all of them."""
FIRST_RUNS, GROWTH = 20, 2
"""Runs of the first search at each level, and how many times as many the next ones have."""


class CoverSearch:
    """``upper`` : proved upper bound on the optimum, infinite before the first search is complete."""

    def __init__(self, known: Known, elements: Elements) -> None:
        self._known, self._elements, self.upper = known, elements, np.inf
        self._rule = ClosingRule(known.incumbent.candidates, known.rule.gap)  # without the other search's floor
        self._separation = Separation(self._elements.problem)
        self._proof: DiveProof | None = None
        self._searches: dict[int, LevelSearch] = {}
        self._runs, self._share, self._left = FIRST_RUNS, 0, FIRST_RUNS
        self._walk = Walk(known.incumbent, np.random.default_rng(0))

    @classmethod
    def of(cls, known: Known) -> CoverSearch | None:
        """The search if robots see few targets, and the criterion is a sum over targets: trace or log-det."""
        objective = known.task.objective
        if objective.compiled_code not in SUMS:
            return None
        seen = np.trace(objective.information, axis1=-2, axis2=-1) > 0
        if seen.mean() > 1 - UNSEEN:
            return None
        elements = Elements(known.task.problem)
        fits = max(map(len, elements.problem.choices)) <= MOST_CHOICES
        return cls(known, elements) if fits else None

    def proof(self) -> UpperProof:
        """The proof of ``upper``."""
        assert self._proof is not None
        return self._proof.written()

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
            if budget.nodes >= until:
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
            self._next_share(ending)
            if progress is not None and budget.nodes > told:
                told = budget.nodes
                progress(budget.nodes, self._known.incumbent.proved.lower, self.upper)

    def _make_room(self) -> None:
        """Give up searches of long records; of too many covers forget the old ones, and the searches that know them."""
        if len(self._separation.pool) > MOST_COVERS:
            self._separation.pool.keep_latest(MOST_COVERS // 4)
            self._searches.clear()
        self._searches = {share: search for share, search in self._searches.items() if not search.dive.is_long}

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
            search = LevelSearch(self._elements, self._separation, self._known.incumbent, self._level)
            self._searches[self._share] = search
        search.level = self._level()
        return search

    def _level(self) -> float:
        floor = self._known.incumbent.candidates.level
        return max(floor + SHARES[self._share] * (self.upper - floor), self._rule.better)

    def _keep(self, search: LevelSearch) -> None:
        """Take what a search proved; its covers are stated now, since what numbers them changes."""
        record, pool = search.dive.record, self._separation.pool
        nodes = record.nodes[: int(record.size[0])]
        by_cover = nodes[nodes[:, 0] == BY_COVER, 1]
        in_sums = [search.sums.leaves[r].covers for r in np.unique(nodes[nodes[:, 0] == BY_SUM, 1]).tolist()]
        used = np.unique(np.concatenate([by_cover, *(np.array(own, dtype=np.int64) for own in in_sums)])).tolist()
        covers = {k: self._separation.stated(k, self._elements) for k in used}
        bound = max((cover_bound(self._elements.whole, cover) for cover in covers.values()), default=0.0)
        if bound < self.upper:
            self.upper = bound
            left_out = {k: pool.covers.left_out[k].tolist() for k in used}
            leaves, terms = search.sums.leaves, search.sums.rows().terms
            self._proof = DiveProof(self._elements, nodes, covers=covers, left_out=left_out, sums=leaves, terms=terms)
