"""The search at one level whose dead ends are attacks that leave too little to gain.

Its loop is ``native/src/marginal_dive.c``.
"""

from __future__ import annotations

from ctypes import byref, c_double, c_int, c_int64, c_void_p
from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.native.library import function
from ratt_opt.solvers.maxmin.levels.level_search import LevelSearch, Outcome
from ratt_opt.solvers.maxmin.levels.packed import PackedElements
from ratt_opt.solvers.maxmin.marginals.raised import raised_information
from ratt_opt.solvers.maxmin.marginals.tables import BRANCHED, Attacks, Choosers, Gains, Path
from ratt_opt.solvers.maxmin.proof import ElementBranch, MarginalLeaf, UpperProof

if TYPE_CHECKING:
    from collections.abc import Callable

    from ratt_opt._validation import IntArray
    from ratt_opt.solvers.maxmin.levels.elements import Elements
    from ratt_opt.solvers.maxmin.plans.incumbent import Incumbent
    from ratt_opt.solvers.maxmin.plans.outcome_pool import OutcomePool

__all__ = ["ChoosingTeam", "MarginalLevelSearch", "MarginalProof"]

RUN = 1000
"""Nodes between two looks at the clock: some ten milliseconds with ten robots."""
FIRST_RECORD, MOST_RECORDED = 1 << 14, 10_000_000
"""Nodes of a record: it grows, to 40 MB at most."""
MOST_TRIED = 200
"""Attacks that are tried at a node if robots have not chosen yet."""
SETS = 64
"""Sets of its seers for which the gains of each target are kept."""
ROUNDINGS = 4
"""Evaluation errors by which values of one plan, computed in two ways, may differ, and both from the exact one."""


class ChoosingTeam:
    """The team in the order in which robots choose, and the attacks known on it.

    ``order`` (N,) : robots, those of fewest elements first; ``elements`` (E,) : elements in that order
    """

    def __init__(self, elements: Elements, pool: OutcomePool) -> None:
        problem, self._pool = elements.problem, pool
        objective = problem.information_objective
        sizes = np.array(list(map(len, problem.choices)))
        self.order = np.argsort(sizes, kind="stable")
        self.elements = np.concatenate([problem.choices[i] for i in self.order])
        information = raised_information(elements)[self.elements]
        sees = information.any(axis=(-2, -1))
        self.choosers = Choosers(PackedElements.of(objective, information, sees), sizes[self.order])
        none = np.zeros(0, dtype=np.int64)
        self._attacks = Attacks(none.astype(np.uint64), none[:, None], none)

    def attacks(self) -> Attacks:
        """All attacks that are known by now, the new ones first."""
        known, outcomes = len(self._attacks.order), self._pool.of_outcome
        if len(outcomes) > known:
            of = np.full((len(outcomes), max(map(len, outcomes))), -1, dtype=np.int64)
            for row, own in zip(of, outcomes, strict=True):
                row[: len(own)] = own
            bits = np.left_shift(np.uint64(1), np.arange(len(self.order), dtype=np.uint64))
            members = np.where(self._pool.membership()[:, self.order] > 0, bits, np.uint64(0)).sum(axis=1)
            order = np.concatenate([np.arange(known, len(outcomes)), self._attacks.order])
            self._attacks = Attacks(members, of, order)
        return self._attacks


def dive(
    choosers: Choosers, attacks: Attacks, gains: Gains, path: Path, *, level: float, slack: float, nodes: int
) -> Outcome:
    """Search on for some nodes; how that ended. A plan worth more than ``level`` by up to ``slack`` is not found."""
    path.make_room(nodes)
    call = function("dive_by_marginals", c_int, *[c_void_p] * 4, *[c_double] * 2, *[c_int64] * 2)
    records = (byref(table.record) for table in (choosers, attacks, gains, path))
    return Outcome(call(*records, level, slack, nodes, MOST_TRIED))


class MarginalLevelSearch(LevelSearch):
    """``error`` : of a value as computed; a plan that is worth up to :data:`ROUNDINGS` of it more is not looked for."""

    def __init__(
        self, elements: Elements, team: ChoosingTeam, incumbent: Incumbent, level: Callable[[], float], error: float
    ) -> None:
        super().__init__(elements, incumbent, level)
        self._team, self._error = team, error
        self._path, self._gains = Path(team.choosers, FIRST_RECORD), Gains(team.choosers.elements, SETS)

    @property
    def is_long(self) -> bool:
        """Whether its record is as long as memory should hold."""
        return len(self.record) >= MOST_RECORDED

    @property
    def record(self) -> IntArray:
        """(R,) how each node ended, in preorder."""
        return np.asarray(self._path.nodes)

    def _search_on(self) -> Outcome:
        team, slack = self._team, ROUNDINGS * self._error
        return dive(team.choosers, team.attacks(), self._gains, self._path, level=self.level, slack=slack, nodes=RUN)

    def _plan(self) -> IntArray:
        plan = np.empty(len(self._team.order), dtype=np.int64)
        plan[self._team.order] = self._team.elements[self._path.chosen]
        return plan


class MarginalProof:
    """A record that is complete, over the elements of the search."""

    def __init__(self, elements: Elements, team: ChoosingTeam, pool: OutcomePool, record: IntArray) -> None:
        self._elements, self._team, self._pool, self._record = elements, team, pool, record.copy()

    def written(self) -> UpperProof:
        """The tree, which the record has in preorder already, with the attacks that it uses."""
        used = np.unique(self._record[self._record != BRANCHED])
        leaf = {a: MarginalLeaf(attack=number) for number, a in enumerate(used.tolist())}
        branches = [self._branch(robot) for robot in self._team.order.tolist()]
        tree: list[MarginalLeaf | ElementBranch] = []
        open_children: list[int] = []
        for ended in self._record.tolist():
            if ended == BRANCHED:
                tree.append(branches[len(open_children)])
                open_children.append(len(branches[len(open_children)].parts))
                continue
            tree.append(leaf[ended])
            while open_children:
                open_children[-1] -= 1
                if open_children[-1]:
                    break
                open_children.pop()
        return UpperProof(attacks=tuple(self._pool.attack(a) for a in used.tolist()), cuts=(), tree=tuple(tree))

    def _branch(self, robot: int) -> ElementBranch:
        parts = tuple(self._elements.members(np.array([e])) for e in self._elements.problem.choices[robot].tolist())
        return ElementBranch(robot=robot, parts=parts)
