"""The search by marginal gains: what robots that have not chosen yet can add under one attack, each alone.

For log-determinants, which are submodular. At one level after the other robots choose in turn, in
``native/src/marginal_dive.c``; the dead ends are attacks that leave too little to gain.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.native.loops import loops
from ratt_opt.setfunctions.criteria.logdet import LogDetObjective
from ratt_opt.setfunctions.rounding_errors import UNIT
from ratt_opt.solvers.maxmin.elements import PackedElements, padded
from ratt_opt.solvers.maxmin.levels import DepthStage, LevelSearch, Outcome, SearchByLevels
from ratt_opt.solvers.maxmin.marginal_tables import BRANCHED, MOST_ROBOTS, Attacks, Choosers, Gains, Path
from ratt_opt.solvers.maxmin.proof import ElementBranch, MarginalLeaf, UpperProof

if TYPE_CHECKING:
    from collections.abc import Callable

    from ratt_opt._validation import FloatArray, IntArray
    from ratt_opt.solvers.maxmin.elements import Elements
    from ratt_opt.solvers.maxmin.incumbent import Incumbent
    from ratt_opt.solvers.maxmin.known import Known
    from ratt_opt.solvers.maxmin.outcome_pool import OutcomePool

__all__ = ["MarginalGainsStage", "MarginalSearch", "dive", "raised_information"]

ROUNDINGS = 4
"""Evaluation errors by which values of one plan, computed in two ways, may differ, and both from the exact one."""


def raised_information(elements: Elements) -> FloatArray:
    """(E, M, d, d) of each undominated element no less than of any that it stands for, and no less than zero.

    Both hold up to rounding already: what is missing is added to the eigenvalues. Then no set of elements tells more
    than that of the elements they stand for, and gains diminish.
    """
    whole = elements.whole.information_objective.information
    information = elements.problem.information_objective.information
    identity = np.eye(information.shape[-1])
    added = np.empty(information.shape[:2])
    for k, members in enumerate(elements.stands_for):
        others = np.concatenate([whole[list(members)], np.zeros((1, *whole.shape[1:]))])
        apart = information[k] - others
        sizes = np.linalg.norm(information[k], axis=(-2, -1)) + np.linalg.norm(others, axis=(-2, -1))
        error = 8 * len(identity) * UNIT * sizes  # of eigenvalues as computed
        missing = error - np.linalg.eigvalsh(apart)[..., 0]
        missing[~apart.any(axis=(-2, -1))] = 0.0
        added[k] = np.maximum(missing, 0.0).max(axis=0)
    return np.asarray(information + added[..., None, None] * identity)


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
            bits = np.left_shift(np.uint64(1), np.arange(len(self.order), dtype=np.uint64))
            members = np.where(self._pool.membership()[:, self.order] > 0, bits, np.uint64(0)).sum(axis=1)
            order = np.concatenate([np.arange(known, len(outcomes)), self._attacks.order])
            self._attacks = Attacks(members, padded(outcomes), order)
        return self._attacks


def dive(
    choosers: Choosers,
    attacks: Attacks,
    gains: Gains,
    path: Path,
    *,
    level: float,
    slack: float,
    nodes: int,
    tried: int,
) -> Outcome:
    """Search on for some nodes; how that ended. A plan worth more than ``level`` by up to ``slack`` is not found.

    ``tried`` : attacks that are tried at a node if robots have not chosen yet
    """
    path.make_room(nodes)
    records = choosers.record, attacks.record, gains.record, path.record
    return Outcome(loops.dive_by_marginals(*records, level, slack, nodes, tried))


class MarginalLevelSearch(LevelSearch):
    """``error`` : of a value as computed; a plan that is worth up to :data:`ROUNDINGS` of it more is not looked for."""

    def __init__(
        self, elements: Elements, team: ChoosingTeam, incumbent: Incumbent, level: Callable[[], float], error: float
    ) -> None:
        super().__init__(elements, incumbent, level)
        self._team, self._error, self._params = team, error, incumbent.params.marginals
        self._path, self._gains = (
            Path(team.choosers, self._params.room),
            Gains(team.choosers.elements, self._params.sets),
        )

    @property
    def is_long(self) -> bool:
        """True if the record is as long as memory should hold."""
        return len(self.record) >= self._params.recorded

    @property
    def record(self) -> IntArray:
        """(R,) how each node ended, in preorder."""
        return np.asarray(self._path.nodes)

    def _search_on(self) -> Outcome:
        team, limits = self._team, {"nodes": self._params.run, "tried": self._params.tried}
        slack = ROUNDINGS * self._error
        return dive(team.choosers, team.attacks(), self._gains, self._path, level=self.level, slack=slack, **limits)

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


class MarginalSearch(SearchByLevels):
    """Bounds the optimum by searches whose dead ends are attacks that leave too little to gain."""

    def __init__(self, known: Known, elements: Elements) -> None:
        super().__init__(known, elements)
        self._error = known.task.problem.evaluation_error
        self._margin = (2 * elements.problem.n_robots + 1 + ROUNDINGS) * self._error
        self._team: ChoosingTeam | None = None
        self._proof: MarginalProof | None = None

    def proof(self) -> UpperProof:
        """The proof of ``upper``."""
        assert self._proof is not None
        return self._proof.written()

    def _begun(self) -> LevelSearch:
        self._team = self._team or ChoosingTeam(self._elements, self._known.incumbent.pool)
        return MarginalLevelSearch(self._elements, self._team, self._known.incumbent, self._level, self._error)

    def _level(self) -> float:
        """Lower by the margin that values and their sums have for rounding, but not below the best plan."""
        return max(super()._level() - self._margin, self._known.incumbent.candidates.level)

    def _keep(self, search: LevelSearch) -> None:
        assert isinstance(search, MarginalLevelSearch)
        assert self._team is not None
        if (bound := search.level + self._margin) < self.upper:
            self.upper = bound
            self._proof = MarginalProof(self._elements, self._team, self._known.incumbent.pool, search.record)


class MarginalGainsStage(DepthStage):
    """Stage that bounds what robots that have not chosen yet can still gain."""

    name = "marginal gains"

    def fits(self, known: Known) -> bool:
        """Tell whether gains diminish, as those of log-determinants do, and there are not too many plans."""
        if known.task.objective.compiled_code != LogDetObjective.native_kernel:
            return False
        sizes = [float(len(choice)) for choice in known.elements.problem.choices]
        return len(sizes) <= MOST_ROBOTS and bool(np.prod(sizes) <= known.task.params.marginals.plans)

    def begin(self, known: Known) -> MarginalSearch:
        """Begin at the level of the best plan."""
        return MarginalSearch(known, known.elements)
