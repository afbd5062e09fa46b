"""Pricing: groups of small reduced cost that an attack may leave below a threshold, or the proof that no group is one.

The reduced cost of a group is the links that leave it plus the dual price of each robot blinded in it, minus the dual
prices of its robots. Branch and bound decides who is inside, then who must be blinded. At each node one Lagrangian
bound is a flow: the links that leave a group are its cuts, and multipliers pay for what every group keeps: the most
that its sensing robots weigh, as levels are concave (``native/src/levels.c``), the robots that can be blinded, and the
links that one group may cut.
"""

from __future__ import annotations

from ctypes import byref, c_int64
from dataclasses import dataclass
from functools import lru_cache
from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.attack.params import DEFAULT
from ratt_opt.attack.team import Links, Team
from ratt_opt.attack.thresholds.columns import UNIT
from ratt_opt.native.library import Answered, address, address_of
from ratt_opt.native.loops import PricingRecord, loops
from ratt_opt.running.pace import Pace, PaceParams

if TYPE_CHECKING:
    from collections.abc import Iterator
    from ctypes import c_uint64

    from numpy.typing import NDArray

    from ratt_opt._validation import BoolArray, FloatArray, IntArray
    from ratt_opt.attack.params import AttackParams
    from ratt_opt.budget import Budget
    from ratt_opt.graph.threat import Threat
    from ratt_opt.setfunctions.base import SetFunction

__all__ = ["BLINDED", "UNIT", "DualPrices", "GroupSearch", "PricedGroup", "PricingProblem", "Question"]

NODES = PaceParams(first=2**3, most=2**20)
"""Nodes of a search for groups in one call."""
BLINDED = 2
"""State of a robot towards a group; 1 is sensing, 0 outside."""


class PricingProblem:
    """Robots of one plan on one network."""

    def __init__(self, team: Team, links: Links, threat: Threat) -> None:
        self.team, self.links, self.threat = team, links, threat
        self.robots, self.pace = team.robots, Pace(NODES)
        self.least_cuts = _least_cuts(threat)

    @classmethod
    def of(
        cls, objective: SetFunction, elements: IntArray, threat: Threat, params: AttackParams = DEFAULT
    ) -> PricingProblem | None:
        """Build the problem of one plan; ``None`` if the compiled code does not support the objective."""
        team = Team.of(objective, elements, params)
        return None if team is None else cls(team, Links.of(threat), threat)

    def most_below(self, threshold: float, group: BoolArray | None = None, effort: int | None = None) -> int:
        """A size that no set of robots, or of those of a group (N,), worth less than the threshold exceeds.

        ``effort`` : robots valued at most for each size
        """
        inside = np.ones(self.robots, dtype=np.bool_) if group is None else np.ascontiguousarray(group)
        nothing = np.zeros(self.robots, dtype=np.int64)
        search = GroupSearch(self, Question(threshold, self.robots, nothing, 0, 0, effort=effort), nothing)
        return loops.most_below(search.handle, address(inside))

    def annealed(
        self, question: Question, moves: int, warm: tuple[float, float], random: c_uint64
    ) -> Iterator[PricedGroup]:
        """A group around each robot, annealed between two temperatures [links that leave a group]."""
        best, record = np.zeros(self.robots, dtype=np.int8), self.record(question, question.duals)
        hot, cold = warm[0] * UNIT, warm[1] * UNIT
        for first in range(self.robots):
            best[:] = 0
            cost = loops.anneal_column(record, first, moves, hot, cold, byref(random), address(best))
            need = int((best == BLINDED).sum())
            yield PricedGroup(robots=best > 0, blinded=best == BLINDED, need=need, found=need, cost=cost)

    def record(self, question: Question, robots: IntArray) -> PricingRecord:
        """Record that the C code reads; all arrays that it has the addresses of must be kept alive."""
        links, params = self.links, self.team.params.pricing
        return PricingRecord(
            team=address_of(self.team.record),
            threshold=question.threshold,
            level=loops.level_of_threshold(self.team.record, question.threshold),
            n_blinded=self.threat.n_blinded,
            most_cut=self.threat.alpha_c,
            most=question.most,
            start=address(links.start),
            robot=address(links.robot),
            back=address(links.back),
            fixed=address(links.fixed),
            seeing=address(links.seeing),
            least_cut=address(self.least_cuts),
            duals=address(question.duals),
            order=address(robots),
            blinding=question.blinding,
            unit=question.unit,
            limit=question.limit,
            effort=question.effort or min(params.effort, params.work // self.team.work + 1),
        )


@dataclass(frozen=True, slots=True, kw_only=True)
class DualPrices:
    """``robot`` : (N,) pi; ``blinded`` : mu; ``links`` : links they claim an attack cuts."""

    robot: FloatArray
    blinded: float
    links: float

    def scaled(self, links: float) -> DualPrices:
        """Scale the prices so that they claim that many links."""
        factor = links / self.links
        return DualPrices(robot=self.robot * factor, blinded=self.blinded * factor, links=links)

    def lowered(self, amount: float) -> DualPrices:
        """Every robot cheaper by an amount: every group's reduced cost rises by at least as much."""
        return DualPrices(robot=self.robot - amount, blinded=self.blinded, links=self.links - amount * len(self.robot))


@dataclass(frozen=True, slots=True)
class Question:
    """Groups below a threshold of less reduced cost than ``limit``, in units of 1 / ``unit`` links that leave them.

    ``most`` : sensing robots of a set below the threshold; ``duals`` : (N,) of each robot; ``blinding`` >= 0 : of a
    blinded robot; ``effort`` : robots valued at most to decide what a group needs
    """

    threshold: float
    most: int
    duals: IntArray
    blinding: int
    limit: int
    unit: int = UNIT
    effort: int | None = None

    def is_same(self, other: Question) -> bool:
        """Test whether another question equals this one."""
        numbers = [(q.threshold, q.most, q.blinding, q.limit, q.unit, q.effort) for q in (self, other)]
        return numbers[0] == numbers[1] and np.array_equal(self.duals, other.duals)

    def claim(self, n_blinded: int) -> int:
        """Return the dual bound: the least cost of groups that cover the team, each link counted twice.

        Valid if no group has a negative reduced cost.
        """
        return int(self.duals.sum()) - n_blinded * self.blinding


@dataclass(frozen=True, slots=True, kw_only=True)
class PricedGroup:
    """A group: ``robots``, ``blinded`` (N,); ``need`` : blinded robots, at least; ``found`` : that many are enough."""

    robots: BoolArray
    blinded: BoolArray
    need: int
    found: int
    cost: int


class GroupSearch:
    """A search for the groups of one question, which may be gone on with.

    ``nodes`` : so far; ``first`` : (N,) robots; groups come by the first of theirs; by default, the dearest first
    """

    def __init__(self, plan: PricingProblem, question: Question, first: IntArray | None = None) -> None:
        if first is None:
            first = np.argsort(-question.duals, kind="stable").astype(np.int64)
        self._plan, self._kept = plan, (question.duals, first)  # the record has their addresses only
        self._record = plan.record(question, first)
        self.handle = loops.open_pricing(self._record)
        if not self.handle:
            raise MemoryError
        self.nodes = 0

    def __del__(self) -> None:
        """Free what the search holds."""
        if getattr(self, "handle", None):
            loops.close_pricing(self.handle)
            self.handle = None

    def columns(self, nodes: int, room: int, budget: Budget) -> tuple[list[PricedGroup], bool]:
        """The next groups, at most ``room``, within ``nodes`` nodes; and whether there are no others.

        Raises
        ------
        OutOfBudget : the time is up.
        """
        table, is_complete = (np.zeros((room, self._plan.robots), np.int8), np.zeros((room, 4), np.int64)), False
        stop, pace, count = self.nodes + budget.nodes_left(nodes), self._plan.pace, 0
        while self.nodes < stop and count < room and not is_complete:
            budget.check()
            before = self.nodes
            units = min(pace.units, stop - before)
            with pace.timed(units):
                count, is_complete = self._fill(units, table, count)
            budget.nodes += self.nodes - before
        rows = zip(table[0][:count], table[1][:count].tolist(), strict=True)
        columns = [
            PricedGroup(robots=part > 0, blinded=part == BLINDED, need=need, found=found, cost=cost)
            for part, (need, found, _, cost) in rows
        ]
        return columns, is_complete

    def _fill(self, nodes: int, table: tuple[NDArray[np.int8], IntArray], count: int) -> tuple[int, bool]:
        """List groups from row ``count`` on for ``nodes`` nodes; the rows filled, and whether there are no others.

        ``table`` : (C, N) what robots are to each group; (C, 4) its need, robots found, links, reduced cost
        """
        rows, progress = c_int64(count), c_int64(0)
        places = address(table[0]), address(table[1]), byref(rows), byref(progress)
        code = loops.list_groups_below(self.handle, nodes, len(table[0]), *places)
        self.nodes = progress.value
        return rows.value, code == Answered.FINISHED


@lru_cache(maxsize=8)
def _least_cuts(threat: Threat) -> IntArray:
    """(N + 1,) links that leave a group of that many robots, at least; kept, as every exact attack asks.

    By degrees, and by the second least eigenvalue of the Laplacian, which is N for a complete graph.

    Source: for the latter, Fiedler, Czechoslovak Mathematical Journal 25 (1975).
    """
    robots, links = threat.graph.n_robots, Links.of(threat)
    degrees = np.diff(links.start).astype(np.float64)
    sizes = np.arange(robots + 1)
    if threat.graph.is_complete:
        second = float(robots)
    else:
        laplacian = np.diag(degrees)
        laplacian[np.repeat(np.arange(robots), np.diff(links.start)), links.robot] = -1.0
        second = float(np.linalg.eigvalsh(laplacian)[1]) if robots > 1 else 0.0
    spread = second * sizes * (robots - sizes) / robots
    by_degree = np.concatenate([[0.0], np.cumsum(np.sort(degrees))]) - sizes * (sizes - 1.0)
    least = np.maximum(np.maximum(by_degree, by_degree[::-1]), spread - 1e-9 * (1.0 + np.abs(spread)))
    return np.asarray(np.ceil(np.maximum(least - 1e-6, 0.0)), dtype=np.int64)
