"""Task of an attacker (one plan, its known values, and the budget), and its result."""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace
from numbers import Real
from typing import TYPE_CHECKING, Any, Protocol

import numpy as np

from ratt_opt._rounding import down, up
from ratt_opt._values import ReprMixin, counted, plain
from ratt_opt.attack import params as parameters
from ratt_opt.attack.params import AttackParams
from ratt_opt.errors import InputError, ProofError
from ratt_opt.problem import Attack, check_problem
from ratt_opt.setfunctions.base import SetFunction
from ratt_opt.setfunctions.metered import metered

if TYPE_CHECKING:
    from collections.abc import Iterable

    from numpy.typing import ArrayLike

    from ratt_opt._validation import BoolArray, FloatArray, IntArray
    from ratt_opt.budget import Budget, Stop
    from ratt_opt.problem import Problem

__all__ = [
    "AttackBracket",
    "AttackMemory",
    "AttackOptions",
    "AttackResult",
    "AttackTask",
    "CutoffReached",
    "PlanValues",
    "Resumable",
    "StageRecord",
    "metered_problem",
    "widened_result",
]


class PlanValues(SetFunction):
    """``phi`` of the elements that a set of robots has in one plan; counts what it was asked.

    ``problem`` : N robots, E elements; ``elements`` : (N,) element chosen for each robot
    """

    __slots__ = ("evaluations", "objective", "plan")

    def __init__(self, problem: Problem, elements: ArrayLike) -> None:
        self.plan: IntArray = check_problem(problem, knows_at_most=True).check_plan(elements)
        self.objective: SetFunction = problem.objective
        self.evaluations = 0

    @property
    def n(self) -> int:
        """Number of robots N."""
        return len(self.plan)

    def evaluate(self, membership: BoolArray) -> FloatArray:
        """(K,) values of the sets of robots in the rows of ``membership`` (K, N)."""
        self.evaluations += len(membership)
        values, chunk = np.empty(len(membership)), 4096  # a table of 2**20 sets in one would take gigabytes of matrices
        for start in range(0, len(membership), chunk):
            rows = membership[start : start + chunk]
            selected = np.zeros((len(rows), self.objective.n), dtype=np.bool_)
            selected[:, self.plan] = rows
            values[start : start + len(rows)] = self.objective.evaluate(selected)
        return values


def metered_problem(problem: Problem, budget: Budget) -> Problem:
    """The problem whose objective counts its values in a budget and keeps within it."""
    return replace(problem, objective=metered(problem.objective, budget))


@dataclass(frozen=True, slots=True, kw_only=True)
class StageRecord(ReprMixin):
    """Record of one stage of an attack: seconds, nodes, and the bracket before and after [unit of the objective]."""

    name: str
    seconds: float
    nodes: int
    lower_before: float
    lower: float
    upper_before: float
    upper: float

    def to_dict(self) -> dict[str, Any]:
        """The record as plain data: an end that is not known is ``None``."""
        ends = {name: plain(getattr(self, name)) for name in ("lower_before", "lower", "upper_before", "upper")}
        return {"stage": self.name, "seconds": self.seconds, "nodes": self.nodes, **ends}


@dataclass(frozen=True, slots=True, kw_only=True)
class AttackResult(ReprMixin):
    """Claim: ``lower <= min over attacks of the team value <= upper`` [unit of the objective].

    ``attack`` leaves ``upper``, up to the rounding of its value. ``lower`` is
    proved when ``stop`` is ``EXHAUSTED`` or ``CLOSED``, with a margin for rounding errors; it is 0 (the value
    of no measurement) for a heuristic. Results are equal when all their fields but ``stages`` are.
    """

    attack: Attack
    lower: float
    upper: float
    stop: Stop
    evaluations: int
    nodes: int = 0
    stages: tuple[StageRecord, ...] = field(default=(), compare=False)
    """Stages of an exact attack, in the order in which they ran."""
    relies_on: tuple[str, ...] = ()
    """Properties of a set function of your own that ``lower`` takes from its word, such as ``"submodular"``."""

    def to_dict(self) -> dict[str, Any]:
        """The result as plain data: unknown numbers are ``None``."""
        ends = {"lower": plain(self.lower), "upper": plain(self.upper)}
        cost = {"evaluations": self.evaluations, "nodes": self.nodes}
        return {**ends, **self.attack.to_dict(), "stop": self.stop.value, **cost, "relies_on": list(self.relies_on)}

    def __repr__(self) -> str:
        attack = f"{counted(len(self.attack.sensing), 'robot')} blinded, {counted(len(self.attack.links), 'link')} cut"
        cost = f"{self.evaluations} evaluations, {self.nodes} nodes"
        return f"AttackResult([{down(self.lower, 6)}, {up(self.upper, 6)}], {attack}, {self.stop.value}, {cost})"


def widened_result(problem: Problem, plan: IntArray, found: AttackResult) -> AttackResult:
    """A plan's attack, the ends moved apart by what computing them may have rounded.

    What the attack leaves is exactly 0 if nobody tells anything: not if the difference of two criteria is.
    """
    lower, upper = problem.widen_by_rounding(found.lower, found.upper)
    if found.upper == 0.0 and (error := problem.evaluation_error) > 0:
        upper = float(np.nextafter(error, np.inf)) if problem.has_information(plan, found.attack) else 0.0
    return replace(found, lower=lower, upper=upper)


CLOSED_WIDTH = 1e-10
"""Relative width that counts as closed: attacks that are worse for the team by less are not looked for. Values computed
in different orders differ by some 1e-13; a narrower width would ask for proofs within rounding."""


class CutoffReached(Exception):  # noqa: N818  (a signal within a search, never seen by a user)
    """An attack leaves the team no more than was aimed at; the bracket has it."""


@dataclass(slots=True)
class AttackBracket:
    """``lower <= worst-case value <= upper`` at any moment; ``attack`` attains ``upper``."""

    attack: Attack
    upper: float
    lower: float
    rounding: float = 0.0
    """Values that differ by no more are equal: a relative width alone never closes on a worst case of 0."""
    aim: float = -np.inf
    """The search ends at an attack that leaves the team no more."""
    is_submodular: bool = False
    """True if the lower end relies on a submodular function."""

    @property
    def goal(self) -> float:
        """Cutoff: a worse attack has a value below it, and a lower bound that reaches it closes the bracket."""
        return self.upper - max(CLOSED_WIDTH * abs(self.upper), self.rounding)

    @property
    def is_closed(self) -> bool:
        """Tell whether the bounds meet up to rounding."""
        return self.lower >= self.goal

    def offer(self, attack: Attack, value: float) -> bool:
        """Keep an attack of strictly smaller value; return whether it is one.

        Raises ``CutoffReached`` : no worse one is needed.
        """
        if better := value < self.upper:
            self.attack, self.upper = attack, float(value)
        self.check_aim()
        return better

    def check_aim(self) -> None:
        """Raise :class:`CutoffReached` if the attack in hand is as bad for the team as was aimed at."""
        if self.upper <= self.aim:
            raise CutoffReached

    def raise_lower(self, bound: float) -> None:
        """Keep a larger lower bound.

        Raises ``ProofError`` : it is no number, or above what the attack in hand leaves by more than rounding.
        """
        self.check(float(bound))
        self.lower = max(self.lower, float(bound))

    def check(self, lower: float) -> None:
        """Raise ``ProofError`` if ``lower`` is above the upper end by more than rounding, or no number."""
        if not lower <= self.upper + max(CLOSED_WIDTH * abs(self.upper), self.rounding):
            raise ProofError(
                f"no attack leaves less than {lower:.10g}, says a bound, but one leaves {self.upper:.10g}; "
                "the bound is false, or the set function is not what it says"
            )


class Resumable(Protocol):
    """A search that goes on where it was once :meth:`run` is called again, with another budget in its task."""

    task: AttackTask

    def run(self) -> Stop:
        """Narrow the task's bracket; why it stopped."""


@dataclass(slots=True, eq=False)
class AttackMemory:
    """Resumable state of the attack on one plan of one problem.

    ``problem`` : in the coordinates in which it is searched
    ``search`` : the last stage of an attack, once it was reached; ``seconds`` : that the stages before had shares of
    """

    problem: Problem | None = None
    plan: IntArray | None = None
    bracket: AttackBracket | None = None
    search: Resumable | None = None
    seconds: float = 0.0

    def check(self, problem: Problem, plan: IntArray) -> None:
        """Raise ``InputError`` if this is about another problem or plan."""
        if self.problem is None or self.plan is None:
            self.problem, self.plan = problem, plan
        if self.problem is not problem or not np.array_equal(self.plan, plan):
            raise InputError("memory", "must be of attacks on the same plan of the same problem", self.plan.tolist())


@dataclass(frozen=True, slots=True, kw_only=True)
class AttackOptions:
    """Options of one exact attack, as ``worst_case_attack`` explains them.

    Raises
    ------
    InputError : ``aim`` is no number.
    """

    max_nodes: int | None = None
    time_limit: float | None = None
    max_evaluations: int | None = None
    budget: Budget | None = None
    aim: float = -math.inf
    known: Attack | None = None
    memory: AttackMemory = field(default_factory=AttackMemory)
    params: AttackParams = field(default_factory=lambda: parameters.DEFAULT)
    brief: bool = False

    def __post_init__(self) -> None:
        if isinstance(self.aim, bool) or not isinstance(self.aim, Real) or math.isnan(self.aim):
            raise InputError("aim", "must be a number", self.aim)


@dataclass(frozen=True, slots=True)
class AttackTask:
    """Narrow ``bracket`` for the plan of ``values`` within ``budget``; the bracket holds the answer.

    ``memory`` : where a search that can go on later is left; ``records`` : what stages did, in order
    ``params`` : of the algorithms
    """

    problem: Problem
    values: PlanValues
    bracket: AttackBracket
    budget: Budget
    memory: AttackMemory = field(default_factory=AttackMemory)
    records: list[StageRecord] = field(default_factory=list)
    params: AttackParams = field(default_factory=AttackParams)

    def offer(self, attack: Attack) -> bool:
        """Value an attack and keep it if it is the worst so far; return whether it is."""
        return self.bracket.offer(attack, self.problem.team_value(self.values.plan, attack))

    def offer_split(self, groups: Iterable[Iterable[int]], blinded: Iterable[int]) -> bool:
        """Offer the attack that splits the team into these groups, blinded robots included."""
        return self.offer(Attack(frozenset(blinded), self.problem.communication.links_between(groups)))
