"""The search by covers: at one level after the other, each in depth, with covers as its dead ends (``dive.py``).

From time to time it asks a linear program which of its frames are dead ends: is there a relaxed plan that meets all
covers known? Of the program only the multipliers are used: normalised, they combine covers into one condition, of which
a plan counts at most the sum of its robots' largest terms. Such sums forbid more than each cover does, and serve from
then on. An attack on a plan that meets all covers shows a new one. Covers are true for all levels above the one that
they were found for, and serve there, too.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.highs import LinearProgram, rows_of
from ratt_opt.solvers.maxmin.covers.choices import MOST_CHOICES
from ratt_opt.solvers.maxmin.covers.dive import CoverSums, Dive, DiveProof, Reason
from ratt_opt.solvers.maxmin.covers.pool import cover_bound
from ratt_opt.solvers.maxmin.covers.separation import Separation
from ratt_opt.solvers.maxmin.levels import DepthStage, LevelSearch, SearchByLevels

if TYPE_CHECKING:
    from collections.abc import Callable

    from ratt_opt._validation import BoolArray, FloatArray, IntArray
    from ratt_opt.solvers.maxmin.elements import Elements
    from ratt_opt.solvers.maxmin.incumbent import Incumbent
    from ratt_opt.solvers.maxmin.known import Known
    from ratt_opt.solvers.maxmin.levels import Outcome
    from ratt_opt.solvers.maxmin.proof import UpperProof
    from ratt_opt.solvers.maxmin.time_slices import TimeSlices

__all__ = ["CoverSearch", "CoversStage"]


class Relaxed:
    """A relaxed plan ``x`` (E,), its ``v``, and the covers with multipliers: numbers, and weights that sum to 1."""

    __slots__ = ("covers", "v", "weights", "x")

    def __init__(self, x: FloatArray, v: float, covers: IntArray, weights: FloatArray) -> None:
        self.x, self.v, self.covers, self.weights = x, v, covers, weights


class CoverProgram:
    """Minimise ``v`` so that every cover counts at least ``enough - v`` and each robot's shares of elements sum to 1.

    If ``v > 0``, no plan of the node is worth more than the level.
    """

    def __init__(self, separation: Separation) -> None:
        self._params = separation.params.covers
        self.enough, self._count, self._pool = separation.enough, separation.count, separation.pool
        self._n, problem = len(self._count), separation.problem
        cost = np.zeros(self._n + 1)
        cost[-1] = 1.0
        lower = np.zeros(self._n + 1)
        lower[-1] = -self._params.lowest
        upper = np.ones(self._n + 1)
        upper[-1] = np.inf
        one_each = rows_of([(choice.tolist(), [1.0] * len(choice)) for choice in problem.choices], 1.0, 1.0)
        self._program = LinearProgram(cost, lower, upper, rows=one_each, presolve="off", simplex_strategy=1)
        self._first, self._robot = problem.n_robots, problem.robot
        self._rows: list[int] = []
        self._used: dict[int, int] = {}
        self._solves = 0

    def add(self, covers: list[int]) -> int:
        """Add covers that are not in the program yet; how many."""
        known = set(self._rows)
        fresh = [k for k in dict.fromkeys(covers) if k not in known]
        entries = []
        for k in fresh:
            self._used[k] = self._solves
            counted = self._counted(k)
            columns = np.flatnonzero(counted)
            entries.append(([*columns.tolist(), self._n], [*counted[columns].tolist(), 1.0]))
        if fresh:
            self._program.add_rows(rows_of(entries, self.enough))
            self._rows.extend(fresh)
        return len(fresh)

    def solve(self, allowed: BoolArray, seconds: float) -> Relaxed | None:
        """The program over the elements allowed (E,); ``None`` if HiGHS claims no optimum in time."""
        self._forget()
        self._program.bound_columns(np.zeros(self._n), allowed.astype(np.float64))
        answer = self._program.solve(seconds)
        self._solves += 1
        if not answer.is_optimal:
            return None
        duals = answer.duals[self._first :]
        active = np.flatnonzero(duals > self._params.no_multiplier)
        covers = np.array(self._rows, dtype=np.int64)[active]
        for k in covers.tolist():
            self._used[k] = self._solves
        weights = duals[active] / duals[active].sum() if len(active) else duals[active]
        return Relaxed(answer.x[: self._n], float(answer.x[self._n]), covers, weights)

    def lacking(self, relaxed: Relaxed, allowed: BoolArray) -> tuple[float, FloatArray]:
        """Return the combined condition's shortfall over all plans of allowed elements, and elements' terms (E,)."""
        if not len(relaxed.covers):
            return -np.inf, np.zeros(self._n)
        terms = relaxed.weights @ np.array([self._counted(k) for k in relaxed.covers.tolist()])
        largest = np.zeros(self._first)
        np.maximum.at(largest, self._robot[allowed], terms[allowed])
        return self.enough - float(largest.sum()), terms

    def _counted(self, cover: int) -> FloatArray:
        """(E,) what each element counts in a cover."""
        return np.asarray(self._pool.left_out(cover) * self._count)

    def _forget(self) -> None:
        if len(self._rows) <= self._params.rows:
            return
        order = sorted(range(len(self._rows)), key=lambda r: self._used[self._rows[r]])
        gone = np.array(sorted(order[: len(order) // 2]))
        self._program.delete_rows(gone + self._first)
        self._rows = [k for r, k in enumerate(self._rows) if r not in set(gone.tolist())]


class CoverLevelSearch(LevelSearch):
    """``dive`` : with its record; ``sums`` : of covers."""

    def __init__(
        self, elements: Elements, separation: Separation, incumbent: Incumbent, level: Callable[[], float]
    ) -> None:
        super().__init__(elements, incumbent, level)
        self._separation, self._params = separation, separation.params.covers
        self._program = CoverProgram(separation)
        self.sums = CoverSums(elements.problem.objective.n, self._params)
        self.dive = Dive(separation, self.sums)

    @property
    def is_long(self) -> bool:
        """True if the record is as long as memory should hold."""
        return self.dive.is_long

    def _begin(self, slices: TimeSlices) -> None:
        self._ask(0, slices, self._params.rounds_at_root)

    def _search_on(self) -> Outcome:
        return self.dive.run(self.level, self._params.run)

    def _plan(self) -> IntArray:
        return self.dive.plan()

    def _use_attack(self, plan: IntArray, outcome: int) -> None:
        """Keep the cover that the attack shows."""
        self._separation.from_attack(plan, self._incumbent.pool.attack(outcome), self.level)

    def _learn(self, slices: TimeSlices) -> None:
        """Look for the first frame of the stack that is a dead end by a sum of covers."""
        first, last = 0, self.dive.frame
        while first < last:
            middle = (first + last) // 2
            if self._ask(middle, slices, self._params.rounds):
                last = middle
            else:
                first = middle + 1

    def _ask(self, frame: int, slices: TimeSlices, rounds: int) -> bool:
        """Decide whether a sum of covers proves a frame to be a dead end; the sum is kept."""
        allowed, pool = self.dive.allowed(frame), self._separation.pool
        for _ in range(rounds):
            if slices.stop() is not None:
                return False
            relaxed = self._program.solve(allowed, slices.seconds_left)
            if relaxed is None:
                return False
            lacking, terms = self._program.lacking(relaxed, allowed)
            if lacking > self._params.shortfall:
                self.sums.add(relaxed.covers, relaxed.weights, terms)
                return True
            if not self._program.add(
                pool.violated(
                    relaxed.x * self._separation.count,
                    self._program.enough,
                    self.level,
                    self._separation.params.separation.violated,
                )
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
        used = np.flatnonzero(x > self._separation.params.separation.negligible)
        np.add.at(mixed, problem.robot[used], x[used, None, None, None] * objective.information[used])
        self._incumbent.adversary.learn_relaxed(mixed)
        return self._separation.partitions.add_cuts_of(self._incumbent.pool)


class CoverSearch(SearchByLevels):
    """Bounds the optimum by searches whose dead ends are covers."""

    def __init__(self, known: Known, elements: Elements) -> None:
        super().__init__(known, elements)
        self._separation = Separation(elements.problem, known.task.params)
        self._proof: DiveProof | None = None

    def proof(self) -> UpperProof:
        """The proof of ``upper``."""
        assert self._proof is not None
        return self._proof.written()

    def _begun(self) -> LevelSearch:
        return CoverLevelSearch(self._elements, self._separation, self._known.incumbent, self._level)

    def _make_room(self) -> None:
        """Forget old covers, and the searches that know them, if there are too many."""
        most = self._separation.params.covers.covers
        if len(self._separation.pool) > most:
            self._separation.pool.keep_latest(most // 4)
            self._searches.clear()
        super()._make_room()

    def _keep(self, search: LevelSearch) -> None:
        """Take what a search proved; its covers are stated now, since what numbers them changes."""
        assert isinstance(search, CoverLevelSearch)
        nodes, pool = search.dive.record.nodes, self._separation.pool
        by_cover = nodes[nodes[:, 0] == Reason.COVER, 1]
        in_sums = [search.sums.leaves[r].covers for r in np.unique(nodes[nodes[:, 0] == Reason.SUM, 1]).tolist()]
        used = np.unique(np.concatenate([by_cover, *(np.array(own, dtype=np.int64) for own in in_sums)])).tolist()
        covers = {k: self._separation.stated(k, self._elements) for k in used}
        bound = max((cover_bound(self._elements.whole, cover) for cover in covers.values()), default=0.0)
        if bound < self.upper:
            self.upper = bound
            left_out = {k: pool.masks[k].tolist() for k in used}
            leaves, terms = search.sums.leaves, search.sums.rows().terms
            self._proof = DiveProof(self._elements, nodes, covers=covers, left_out=left_out, sums=leaves, terms=terms)


class CoversStage(DepthStage):
    """Stage that counts the robots that must choose what no attack can afford to leave."""

    name = "covers"

    def fits(self, known: Known) -> bool:
        """Tell whether no robot has more elements than its masks hold."""
        return max(map(len, known.elements.problem.choices)) <= MOST_CHOICES

    def begin(self, known: Known) -> CoverSearch:
        """Begin at the level of the best plan."""
        return CoverSearch(known, known.elements)
