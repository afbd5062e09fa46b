"""The search by covers: at one level after the other, each in depth, with covers as its dead ends (``dive.py``).

From time to time it asks the linear program of the covers known (``program.py``) which of its frames are dead ends:
sums of covers that the program finds serve from then on. An attack on a plan that meets all covers shows a new one.
Covers are true for all levels above the one that they were found for, and serve there, too.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.solvers.maxmin.covers.choices import MOST_CHOICES
from ratt_opt.solvers.maxmin.covers.dive import BY_COVER, BY_SUM, Dive, DiveProof
from ratt_opt.solvers.maxmin.covers.pool import cover_bound
from ratt_opt.solvers.maxmin.covers.program import CoverProgram, CoverSums
from ratt_opt.solvers.maxmin.covers.separation import Separation
from ratt_opt.solvers.maxmin.levels import LevelSearch, SearchByLevels

if TYPE_CHECKING:
    from collections.abc import Callable

    from ratt_opt._validation import FloatArray, IntArray
    from ratt_opt.solvers.maxmin.elements import Elements
    from ratt_opt.solvers.maxmin.incumbent import Incumbent
    from ratt_opt.solvers.maxmin.levels import Outcome
    from ratt_opt.solvers.maxmin.proof import UpperProof
    from ratt_opt.solvers.maxmin.search import Known
    from ratt_opt.solvers.maxmin.upper_ends import Turns

__all__ = ["CoverSearch"]

RUN = 100
"""Nodes between two looks at the clock and at the linear program: ten milliseconds with ten robots."""
ROUNDS_AT_ROOT, ROUNDS = 60, 4
"""Rounds of covers on one relaxed plan."""
CLOSED = 2e-6
"""What plans have to lack of a sum that is worth keeping."""
NEGLIGIBLE = 1e-6
"""Shares that count as none."""
MOST_COVERS = 20_000
"""Covers that are known at once: a node looks at all of them."""


class CoverLevelSearch(LevelSearch):
    """``dive`` : with its record; ``sums`` : of covers."""

    def __init__(
        self, elements: Elements, separation: Separation, incumbent: Incumbent, level: Callable[[], float]
    ) -> None:
        super().__init__(elements, incumbent, level)
        self._separation = separation
        self._program = CoverProgram(separation)
        self.sums = CoverSums(elements.problem.objective.n)
        self.dive = Dive(separation, self.sums)

    @property
    def is_long(self) -> bool:
        """Whether its record is as long as memory should hold."""
        return self.dive.is_long

    def _begin(self, turns: Turns) -> None:
        self._ask(0, turns, ROUNDS_AT_ROOT)

    def _search_on(self) -> Outcome:
        return self.dive.run(self.level, RUN)

    def _plan(self) -> IntArray:
        return self.dive.plan()

    def _heed(self, plan: IntArray, outcome: int) -> None:
        """Keep the cover that the attack shows."""
        self._separation.from_attack(plan, self._incumbent.pool.attack(outcome), self.level)

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


class CoverSearch(SearchByLevels):
    """Bounds the optimum by searches whose dead ends are covers."""

    def __init__(self, known: Known, elements: Elements) -> None:
        super().__init__(known, elements)
        self._separation = Separation(elements.problem)
        self._proof: DiveProof | None = None

    @classmethod
    def of(cls, known: Known, elements: Elements) -> CoverSearch | None:
        """The search, unless a robot has more elements than its masks hold."""
        fits = max(map(len, elements.problem.choices)) <= MOST_CHOICES
        return cls(known, elements) if fits else None

    def proof(self) -> UpperProof:
        """The proof of ``upper``."""
        assert self._proof is not None
        return self._proof.written()

    def _begun(self) -> LevelSearch:
        return CoverLevelSearch(self._elements, self._separation, self._known.incumbent, self._level)

    def _make_room(self) -> None:
        """Of too many covers forget the old ones, too, and the searches that know them."""
        if len(self._separation.pool) > MOST_COVERS:
            self._separation.pool.keep_latest(MOST_COVERS // 4)
            self._searches.clear()
        super()._make_room()

    def _keep(self, search: LevelSearch) -> None:
        """Take what a search proved; its covers are stated now, since what numbers them changes."""
        assert isinstance(search, CoverLevelSearch)
        nodes, pool = search.dive.record.nodes, self._separation.pool
        by_cover = nodes[nodes[:, 0] == BY_COVER, 1]
        in_sums = [search.sums.leaves[r].covers for r in np.unique(nodes[nodes[:, 0] == BY_SUM, 1]).tolist()]
        used = np.unique(np.concatenate([by_cover, *(np.array(own, dtype=np.int64) for own in in_sums)])).tolist()
        covers = {k: self._separation.stated(k, self._elements) for k in used}
        bound = max((cover_bound(self._elements.whole, cover) for cover in covers.values()), default=0.0)
        if bound < self.upper:
            self.upper = bound
            left_out = {k: pool.masks[k].tolist() for k in used}
            leaves, terms = search.sums.leaves, search.sums.rows().terms
            self._proof = DiveProof(self._elements, nodes, covers=covers, left_out=left_out, sums=leaves, terms=terms)
