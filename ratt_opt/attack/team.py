"""A plan as the compiled loops read it."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property, lru_cache
from itertools import chain
from typing import TYPE_CHECKING, NamedTuple, TypeGuard

import numpy as np

from ratt_opt._validation import readonly
from ratt_opt.attack.params import DEFAULT
from ratt_opt.errors import InputError
from ratt_opt.native.library import address, checked
from ratt_opt.native.loops import TeamRecord, loops
from ratt_opt.running.pace import Pace, PaceParams
from ratt_opt.setfunctions.base import IMPROVEMENT
from ratt_opt.setfunctions.criteria.maxeig import MaxEigenvalueObjective
from ratt_opt.setfunctions.information import InformationObjective, triangles

if TYPE_CHECKING:
    from collections.abc import Iterable

    from ratt_opt._validation import BoolArray, FloatArray, IntArray
    from ratt_opt.attack.params import AttackParams
    from ratt_opt.graph.communication import CommunicationGraph
    from ratt_opt.graph.threat import Threat
    from ratt_opt.setfunctions.base import SetFunction

__all__ = ["LARGEST_DIMENSION", "WORK", "Links", "Team", "has_native_kernel", "work_of_value"]

EXCHANGES = PaceParams(first=2**12, most=2**26)
"""Pairs of robots that exchanges try in one call."""
PARTIAL_SETS = PaceParams(first=2**3)
"""Partial sets that a search of sets looks at in one call; the largest eigenvalue of six coordinates takes 500 times as
long as a trace of two."""
LARGEST_DIMENSION = 64
"""Largest dimension of states in the compiled code."""


def has_native_kernel(objective: SetFunction) -> TypeGuard[InformationObjective]:
    """Tell whether the compiled code has the criterion and supports the dimension of its states."""
    if not isinstance(objective, InformationObjective):
        return False
    return objective.compiled_code is not None and objective.dimension <= LARGEST_DIMENSION


@dataclass(frozen=True, slots=True, kw_only=True)
class WorkParams:
    """Cost of steps, in about multiplications (half a nanosecond each).

    ``rotations`` : times as long as a trace that a largest eigenvalue takes in more than two dimensions
    """

    rotations: int = 8


WORK = WorkParams()


def work_of_value(objective: InformationObjective) -> int:
    """Estimate the multiplications for one value of a set of robots."""
    d = objective.dimension
    by_rotations = d > 2 and objective.compiled_code == MaxEigenvalueObjective.native_kernel
    return objective.n_targets * d**3 * (WORK.rotations if by_rotations else 1)


class Team:
    """Information of the robots of one plan about the targets; symmetric matrices packed, T = d (d + 1) / 2 entries.

    ``objective`` : a criterion of the compiled code; ``weights`` : (M,) its own; ``prior`` : (M, T) prior information
    ``information`` : (N, M, T) of each robot's element; ``params`` : of the algorithms that attack the team

    Raises
    ------
    InputError : a shape or a type is another, or the compiled code does not support the objective.
    """

    def __init__(
        self,
        objective: InformationObjective,
        prior: FloatArray,
        information: FloatArray,
        params: AttackParams = DEFAULT,
    ) -> None:
        if not has_native_kernel(objective) or (criterion := objective.compiled_code) is None:
            raise InputError("objective", "must be one that the compiled code supports", type(objective).__name__)
        robots, targets, d = len(information), objective.n_targets, objective.dimension
        entries = d * (d + 1) // 2
        self.objective, self.robots, self.params = objective, robots, params
        self.weights = checked("weights", np.array(objective.weights), np.float64, (targets,))
        self.prior = checked("prior", prior, np.float64, (targets, entries))
        self.information = checked("information", information, np.float64, (robots, targets, entries))
        self._before = np.zeros(targets)
        self.record = TeamRecord(
            robots=robots,
            targets=targets,
            dimension=d,
            criterion=criterion,
            weights=address(self.weights),
            prior=address(self.prior),
            information=address(self.information),
            before=None,
            before_all=0.0,
            relative=IMPROVEMENT.relative,
            rounding=objective.rounding,
        )
        loops.criteria_before(self.record, address(self._before))

    @classmethod
    def of(cls, objective: SetFunction, plan: IntArray, params: AttackParams = DEFAULT) -> Team | None:
        """Build the team of a plan; ``None`` if the compiled code does not support the objective."""
        if not has_native_kernel(objective):
            return None
        return cls(objective, triangles(objective.prior_information), triangles(objective.information[plan]), params)

    def among(self, robots: IntArray) -> Team:
        """Some of the robots, in this order."""
        return Team(self.objective, self.prior, np.ascontiguousarray(self.information[robots]), self.params)

    @cached_property
    def pace(self) -> Pace:
        """Pace of exchanges."""
        return Pace(EXCHANGES)

    @cached_property
    def set_pace(self) -> Pace:
        """Pace of searches of sets."""
        return Pace(PARTIAL_SETS)

    @property
    def is_planar(self) -> bool:
        """Tell whether targets have states of two dimensions, for which there are sharper bounds."""
        return self.objective.dimension == 2

    @property
    def is_by_axis(self) -> bool:
        """Tell whether one axis of one target decides the value of a set (planar states)."""
        return self.is_planar and self.objective.overrides("planar_levels")

    @property
    def whole_value(self) -> float:
        """Value of all robots together."""
        return self.value(range(self.robots))

    @cached_property
    def single(self) -> FloatArray:
        """(N,) individual values."""
        return np.array([self.value([i]) for i in range(self.robots)])

    @property
    def traces(self) -> FloatArray:
        """(N, M) traces of the robots' information."""
        d = self.objective.dimension
        return np.asarray(self.information[..., [i * (i + 3) // 2 for i in range(d)]].sum(axis=-1))

    def sums(self, robots: Iterable[int]) -> FloatArray:
        """(M, T) posterior information of a set of robots."""
        return np.ascontiguousarray(self.prior + self.information[sorted(robots)].sum(axis=0))

    def value(self, robots: Iterable[int]) -> float:
        """Return the value of a set of robots."""
        sums = self.sums(robots)
        return loops.value_of(self.record, address(sums))

    def all_values(self) -> FloatArray:
        """(2**N,) values of all sets of robots, by bit mask.

        Raises
        ------
        InputError : there are more than 16 robots.
        """
        if self.robots > 16:  # of more, one call would take too long to be interrupted
            raise InputError("information", "must be of at most 16 robots", self.robots)
        values, sums = np.empty(2**self.robots), np.empty((self.robots + 1, *self.prior.shape))
        loops.all_values(self.record, address(values), address(sums))
        return values

    @property
    def work(self) -> int:
        """Estimated multiplications for one value."""
        return work_of_value(self.objective)


class Links(NamedTuple):
    """A threat's graph: robot ``i`` has arcs ``start[i]:start[i + 1]`` to ``robot``.

    ``start`` : (N + 1,); ``robot`` : (A,) the other end; ``back`` : (A,) the same link's arc the other way;
    ``fixed`` : (A,) whether the link cannot be cut; ``seeing`` : (N,) whether the robot cannot be blinded
    """

    start: IntArray
    robot: IntArray
    back: IntArray
    fixed: BoolArray
    seeing: BoolArray

    @classmethod
    def of(cls, threat: Threat) -> Links:
        """The graph of a threat; of one that was asked before, the same arrays: every exact attack asks."""
        return _links_of(threat)


@lru_cache(maxsize=8)  # some megabytes for a thousand robots
def _links_of(threat: Threat) -> Links:
    n_robots = threat.graph.n_robots
    tails, heads = np.divmod(_arcs(threat.graph), n_robots)
    fixed = _numbers(threat.protected_links, n_robots)
    arrays = (
        np.searchsorted(tails, np.arange(n_robots + 1)).astype(np.int64),
        heads,
        np.argsort(heads, kind="stable").astype(np.int64),  # arcs by head, then tail: those of the way back, in order
        np.isin(np.minimum(tails, heads) * n_robots + np.maximum(tails, heads), fixed),
        np.isin(np.arange(n_robots), list(threat.protected_robots)),
    )
    return Links(*map(readonly, arrays))


def _arcs(graph: CommunicationGraph) -> IntArray:
    """(A,) ``tail * N + head`` of all arcs, ascending."""
    if graph.is_complete:  # half a million links are slow to read one by one
        return np.flatnonzero(~np.eye(graph.n_robots, dtype=np.bool_))
    links = _numbers(graph.links, graph.n_robots)
    heads, tails = np.divmod(links, graph.n_robots)
    return np.sort(np.concatenate([links, tails * graph.n_robots + heads]))


def _numbers(links: Iterable[tuple[int, int]], n_robots: int) -> IntArray:
    """(L,) ``i * N + j`` of links ``(i, j)``."""
    ends = np.fromiter(chain.from_iterable(links), dtype=np.int64).reshape(-1, 2)
    return np.asarray(ends[:, 0] * n_robots + ends[:, 1])
