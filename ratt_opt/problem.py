"""The max-min problem, a plan for it, and an attack on the plan."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property
from operator import attrgetter
from typing import TYPE_CHECKING, Any

import networkx as nx
import numpy as np

from ratt_opt._validation import IntArray, check_distinct, check_integer, check_link, integer_array, readonly
from ratt_opt._values import ByValue, ReprMixin
from ratt_opt.choice_limit import ChoiceLimit
from ratt_opt.errors import InputError
from ratt_opt.graph.communication import CommunicationGraph
from ratt_opt.graph.threat import Threat
from ratt_opt.setfunctions.base import SetFunction
from ratt_opt.setfunctions.evaluation_error import evaluation_error, largest_fall
from ratt_opt.setfunctions.information import InformationObjective
from ratt_opt.setfunctions.metered import unmetered

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Sequence

    from numpy.typing import ArrayLike, DTypeLike, NDArray

__all__ = ["Attack", "Plan", "Problem"]


@dataclass(frozen=True, slots=True)
class Attack(ReprMixin):
    """Robots whose sensor is blinded, and links ``(i, j)``, ``i < j``, that are cut."""

    sensing: frozenset[int] = frozenset()
    links: frozenset[tuple[int, int]] = frozenset()

    def __post_init__(self) -> None:
        robots = (i if type(i) is int else check_integer("attack robot", i, low=0) for i in self.sensing)
        object.__setattr__(self, "sensing", check_distinct("attack robot", robots))
        if type(self.links) is frozenset and all(map(_is_link, self.links)):
            return  # as nearly always, and there may be hundreds of thousands
        links = (check_link("attack link", link) for link in self.links)
        object.__setattr__(self, "links", check_distinct("attack link", links))
        for link in self.links:
            if not link[0] < link[1]:
                raise InputError("attack link", "must be (i, j) with i < j", link)


def _is_link(link: tuple[int, int]) -> bool:
    return type(link) is tuple and len(link) == 2 and type(link[0]) is int is type(link[1]) and 0 <= link[0] < link[1]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class Plan(ByValue, ReprMixin):
    """One element per robot; two plans are equal when all their fields are. Iterating gives the elements as ``int``.

    ``elements`` : (N,) flat element indices, robot by robot.
    ``evaluations`` : set-function values that the planner computed.
    ``bait`` : robots that RATT gave their individually best element, ascending; empty for other planners.
    ``alpha_cs`` : sensing attacks that RATT took the link attacks to be worth; ``None`` for other planners.
    """

    elements: IntArray
    evaluations: int
    bait: tuple[int, ...] = ()
    alpha_cs: int | None = None

    def __iter__(self) -> Iterator[int]:
        return iter(self.elements.tolist())

    def __array__(self, dtype: DTypeLike | None = None, copy: bool | None = None) -> NDArray[Any]:
        """Return the plan's elements: functions that take elements take a plan, too."""
        return np.array(self.elements, dtype=dtype, copy=copy)


def _of_threat(name: str) -> Any:
    """A field of a problem that its threat holds."""
    return property(attrgetter(f"threat.{name}"))


@dataclass(frozen=True, eq=False, init=False)
class Problem:
    """Choose one element per robot so that the worst attack leaves the most value.

    Parameters
    ----------
    objective : set function over the elements ``0..E-1``; the solvers rely on it being
        normalised and non-decreasing (not checked here; see ``find_monotonicity_violation``)
    robot : (E,) owner of each element; every robot ``0..N-1`` owns at least one
    graph : ``networkx.Graph`` on the robots, or ``None`` for the complete graph; kept as a frozen copy
    alpha_s : robots the attacker may blind, in ``[0, N]``
    alpha_c : links the attacker may cut, in ``[0, number of links]``
    protected_robots : robots that cannot be blinded
    protected_links : links ``(i, j)`` that cannot be cut
    at_most : robots that may choose an element that is not their idle one, or ``None`` for all. The idle element of a
        robot is its first one without information, or, of other set functions, its first one that is worth nothing
        alone; ``idle`` holds them

    Two problems are equal when they are the same object. ``dataclasses.replace`` makes a changed copy.
    ``threat`` holds what the adversary may do; ``choices`` the elements of each robot, ascending.

    Raises
    ------
    InputError : sizes disagree, a robot owns nothing, the graph is not simple, or a budget is out of range.

    Source: ratt.tex, eqn:resi_target_prob.
    """

    objective: SetFunction
    robot: IntArray
    graph: nx.Graph | None
    alpha_s: int = _of_threat("alpha_s")
    alpha_c: int = _of_threat("alpha_c")
    protected_robots: frozenset[int] = _of_threat("protected_robots")
    protected_links: frozenset[tuple[int, int]] = _of_threat("protected_links")
    at_most: int | None = None
    threat: Threat = field(init=False)
    choices: tuple[IntArray, ...] = field(init=False)

    def __init__(  # noqa: PLR0917  (the public contract gives the order)
        self,
        objective: SetFunction,
        robot: ArrayLike,
        graph: nx.Graph | None,
        alpha_s: int,
        alpha_c: int,
        protected_robots: Iterable[int] = (),
        protected_links: Iterable[tuple[int, int]] = (),
        at_most: int | None = None,
    ) -> None:
        if not isinstance(objective, SetFunction):
            raise InputError("objective", "must be a SetFunction", type(objective).__name__)
        if not isinstance(objective.n, (int, np.integer)):
            raise InputError("objective.n", "must be an integer, of a property", type(objective.n).__name__)
        owners = _check_owners(robot, int(objective.n))
        n_robots = int(owners.max()) + 1
        communication = (
            CommunicationGraph.complete(n_robots)
            if graph is None
            else CommunicationGraph.from_networkx(graph, n_robots)
        )
        robots = check_distinct("protected robot", protected_robots)
        links = check_distinct("protected link", (check_link("protected link", link) for link in protected_links))
        fields = {
            "objective": objective,
            "robot": owners,
            "graph": graph if graph is None or nx.is_frozen(graph) else nx.freeze(graph.copy()),
            "threat": Threat(communication, alpha_s, alpha_c, robots, links),
            "choices": tuple(readonly(np.flatnonzero(owners == i)) for i in range(n_robots)),
            "at_most": None if at_most is None else check_integer("at_most", at_most, low=0, high=n_robots),
        }
        for name, value in fields.items():
            object.__setattr__(self, name, value)
        if at_most is not None:
            assert self.choice_limit is not None  # refuses robots without an idle element

    def __repr__(self) -> str:
        robots = f"{self.n_robots} robots, {self.objective.n} elements"
        links = "every link" if self.graph is None else f"{len(self.communication.links)} links"
        budgets = f"alpha_s={self.alpha_s}, alpha_c={self.alpha_c}"
        return f"Problem({type(self.objective).__name__}, {robots}, {links}, {budgets})"

    @property
    def n_robots(self) -> int:
        """Number of robots N."""
        return len(self.choices)

    @cached_property
    def idle(self) -> IntArray:
        """(N,) the first element of each robot without information, or that is worth nothing alone.

        Raises
        ------
        InputError : a robot has none.
        """
        return idle_elements(self.objective, self.choices)

    @cached_property
    def choice_limit(self) -> ChoiceLimit | None:
        """The limit ``at_most`` with the idle elements, or ``None``."""
        return None if self.at_most is None else ChoiceLimit(self.at_most, self.idle)

    @property
    def information_objective(self) -> InformationObjective:
        """The objective as a criterion of information matrices.

        Raises
        ------
        InputError : it is another kind of set function.
        """
        if not isinstance(self.objective, InformationObjective):
            rule = "must be a criterion of information matrices (a subclass of InformationObjective) for this"
            raise InputError("objective", rule, type(self.objective).__name__)
        return self.objective

    @property
    def communication(self) -> CommunicationGraph:
        """The communication graph; complete if ``graph`` is ``None``."""
        return self.threat.graph

    @cached_property
    def evaluation_error(self) -> float:
        """No value of a plan's robots is computed further from the exact one, of the matrices given.

        It includes the :attr:`largest_fall`, as searches rely on a non-decreasing objective.
        0 if nothing is known of that: set functions and criteria of your own count as exact.
        """
        if not isinstance(self.objective, InformationObjective):
            return 0.0
        return evaluation_error(self.objective, self.choices)

    @cached_property
    def largest_fall(self) -> float:
        """No robots of a plan are worth less than some of them by more, in exact arithmetic; 0 if nothing is known.

        Information that is semidefinite only up to rounding takes a little away.
        """
        return largest_fall(self.objective, self.choices) if isinstance(self.objective, InformationObjective) else 0.0

    @property
    def least_value(self) -> float:
        """No robots of a plan are worth less, in exact arithmetic: no information is worth 0."""
        return -self.largest_fall

    def widen_by_rounding(self, lower: float, upper: float) -> tuple[float, float]:
        """Ends of a worst case's bracket as computed, moved apart by what rounding may have done.

        That is the :attr:`evaluation_error`. No team is worth less than the :attr:`least_value`; if all robots that
        tell anything can be blinded, the worst case is at most 0.
        """
        error = self.evaluation_error
        if error == 0.0:
            return lower, upper
        lowest = np.nextafter(lower - error, -np.inf)
        highest = 0.0 if upper == 0.0 and self._can_be_blinded else float(np.nextafter(upper + error, np.inf))
        return float(max(lowest, min(lower, self.least_value))), highest

    @property
    def _can_be_blinded(self) -> bool:
        information = self.information_objective.information
        telling = {i for i, choice in enumerate(self.choices) if information[choice].any()}
        return len(telling) <= self.alpha_s and not telling & self.protected_robots

    def has_information(self, plan: IntArray, attack: Attack) -> bool:
        """Tell whether a robot that is not blinded has any information under this plan."""
        seeing = [i for i in range(self.n_robots) if i not in attack.sensing]
        f = self.objective
        return bool(f.information[plan[seeing]].any() if isinstance(f, InformationObjective) else seeing)

    def check_plan(self, elements: ArrayLike) -> IntArray:
        """Return ``elements`` as an (N,) array after checking that each is its robot's.

        Raises
        ------
        InputError : wrong shape, not integers, or an element of another robot.
        """
        array = integer_array(elements)
        if array.shape != (self.n_robots,):
            raise InputError("elements", f"must hold one element per robot, shape ({self.n_robots},)", elements)
        exists = array.dtype.kind in "iu" and array.min() >= 0 and array.max() < self.objective.n
        if not (exists and np.array_equal(self.robot[array], np.arange(self.n_robots))):  # as hardly ever
            for i, element in enumerate(array):
                e = check_integer(f"elements[{i}]", element, low=0, high=self.objective.n - 1)
                if self.robot[e] != i:
                    found = f"{e} of robot {self.robot[e]}"
                    raise InputError(f"elements[{i}]", f"must be an element of robot {i}", found)
        if (limit := self.choice_limit) is not None and not limit.allows(array):
            busy = int(limit.busy(array).sum())
            raise InputError("elements", f"must choose at most {limit.most} elements that are not idle", busy)
        return readonly(array.astype(np.int64))

    def check_attack(self, attack: Attack) -> Attack:
        """Return ``attack`` after checking that it is within the budgets and names real robots and links.

        Raises
        ------
        InputError : a robot or link does not exist or is protected, or a budget is exceeded.
        """
        for i in attack.sensing:
            check_integer("attack robot", i, low=0, high=self.n_robots - 1)
        for link in sorted(attack.links - self.communication.links):
            raise InputError("attack link", "must be a link of the graph", link)
        for i in sorted(attack.sensing & self.protected_robots):
            raise InputError("attack robot", "must not be protected", i)
        for link in sorted(attack.links & self.protected_links):
            raise InputError("attack link", "must not be protected", link)
        if len(attack.sensing) > self.alpha_s:
            raise InputError("attack", f"must blind at most alpha_s = {self.alpha_s} robots", len(attack.sensing))
        if len(attack.links) > self.alpha_c:
            raise InputError("attack", f"must cut at most alpha_c = {self.alpha_c} links", len(attack.links))
        return attack

    def team_value(self, elements: ArrayLike, attack: Attack) -> float:
        """Value of the best group's non-blinded robots under one attack [unit of the objective].

        Raises
        ------
        InputError : the plan is not one element per robot, or the attack is not allowed.
        """
        plan = self.check_plan(elements)
        return self.objective(plan[sorted(self.best_group(plan, attack))])

    def best_group(self, elements: ArrayLike, attack: Attack) -> frozenset[int]:
        """Non-blinded robots of the group whose value is the team's; among equals the group of the lowest robot.

        Raises
        ------
        InputError : the plan is not one element per robot, or the attack is not allowed.
        """
        plan = self.check_plan(elements)
        self.check_attack(attack)
        return max(self.groups_left(attack), key=lambda group: self.objective(plan[sorted(group)]))

    def groups_left(self, attack: Attack) -> list[frozenset[int]]:
        """Non-blinded robots of every group, by the group's lowest robot; empty if all of one are blinded."""
        return [group - attack.sensing for group in self.communication.groups(attack.links)]


def idle_elements(objective: SetFunction, choices: Sequence[IntArray]) -> IntArray:
    """(N,) the first element of each robot without information, or that is worth nothing alone.

    Raises
    ------
    InputError : a robot has none.
    """
    f = unmetered(objective)
    nothing = np.asarray(f.singletons() == 0.0)
    if isinstance(f, InformationObjective):
        nothing = ~np.any(f.information, axis=(1, 2, 3))
    without = [choice[nothing[choice]].tolist() for choice in choices]
    if [] in without:
        rule = "needs an idle element of every robot, worth 0 alone"
        raise InputError("at_most", rule, f"none of robot {without.index([])}")
    return readonly(np.array([elements[0] for elements in without]))


def check_problem(problem: Problem, *, knows_at_most: bool = False) -> Problem:
    """Return ``problem``.

    ``InputError`` : it is something else, as a scenario in its place; or it limits how many robots choose, and the
    caller does not know that.
    """
    if not isinstance(problem, Problem):
        raise InputError("problem", "must be a Problem, as scenario.problem() returns", type(problem).__name__)
    if problem.at_most is not None and not knows_at_most:
        rule = "must be None for this, which does not know a limit on how many robots choose"
        raise InputError("at_most", rule, problem.at_most)
    return problem


def _check_owners(robot: ArrayLike, n_elements: int) -> IntArray:
    owners = integer_array(robot)
    if owners.shape != (n_elements,):
        raise InputError("robot", f"must have shape ({n_elements},), one owner per element", f"shape {owners.shape}")
    if owners.dtype.kind not in "iu":
        raise InputError("robot", "must hold integers", owners.tolist())
    if owners.min() < 0:
        raise InputError("robot", "must hold robots >= 0", int(owners.min()))
    missing = sorted(set(range(int(owners.max()) + 1)) - set(owners.tolist()))
    if missing:
        raise InputError("robot", "must give every robot at least one element", f"none for robot {missing[0]}")
    return readonly(owners.astype(np.int64))
