"""Planners of a mission: the library's planners by name, and the user's own."""

from __future__ import annotations

from dataclasses import dataclass
from inspect import Parameter, signature
from typing import TYPE_CHECKING, Protocol, runtime_checkable

import numpy as np

from ratt_opt._validation import IntArray, check_integer
from ratt_opt.budget import uninterrupted
from ratt_opt.decentralised.knowledge import ExchangeParams
from ratt_opt.decentralised.plan import decentralised_ratt, decentralised_refined
from ratt_opt.errors import InputError
from ratt_opt.missions.players import names
from ratt_opt.missions.players.named import get_player, table_of
from ratt_opt.planners.registry import PUBLISHED
from ratt_opt.solvers.maxmin.solve import nonrobust_optimum, solve_maxmin
from ratt_opt.solvers.ratt import greedy, myopic, random_plan, ratt
from ratt_opt.solvers.refined import RefinedPlan, refined

if TYPE_CHECKING:
    from collections.abc import Callable

    from ratt_opt.budget import Budget
    from ratt_opt.decentralised.faults import Faults
    from ratt_opt.decentralised.plan import DecentralisedPlan
    from ratt_opt.problem import Plan, Problem
    from ratt_opt.scenario.planner_world import PlannerWorld
    from ratt_opt.solvers.result import MaxMinResult

    Planned = Plan | MaxMinResult | IntArray
    Planner = Callable[..., Planned]  # f(problem) or f(problem, world): see ``planned_with``

__all__ = [
    "PLANNERS",
    "AnytimePlanner",
    "DecentralisedPlanner",
    "MaxMinPlanner",
    "RandomPlanner",
    "RefinedPlanner",
    "elements_of",
    "get_planner",
    "planned_with",
]


@runtime_checkable
class AnytimePlanner(Protocol):
    """A planner that improves a known plan ``start`` until a budget is spent: a tracker gives it the time it has."""

    def __call__(self, problem: Problem, start: IntArray | None = None) -> Plan | MaxMinResult:
        """Plan within limits of its own."""

    def within(self, problem: Problem, budget: Budget, start: IntArray) -> Plan | MaxMinResult:
        """Plan within this budget instead."""


@dataclass(frozen=True, slots=True)
class MaxMinPlanner:
    """The max-min plan with a bracket, within limits. With ``max_nodes`` alone it is reproducible."""

    gap: float = 1e-3
    time_limit: float | None = None
    max_nodes: int | None = 30

    def __call__(self, problem: Problem, start: IntArray | None = None) -> MaxMinResult:
        """Search until closed to the gap or out of limits, from a plan ``start`` if one is known."""
        return solve_maxmin(problem, gap=self.gap, time_limit=self.time_limit, max_nodes=self.max_nodes, start=start)

    def within(self, problem: Problem, budget: Budget, start: IntArray) -> MaxMinResult:
        """Search until closed to the gap or the budget is spent, whatever the limits are."""
        return solve_maxmin(problem, gap=self.gap, budget=budget, start=start)


@dataclass(frozen=True, slots=True)
class RefinedPlanner:
    """RATT's plan, improved against the attacks that hurt it; reproducible with a limit of kicks alone."""

    time_limit: float | None = None
    max_kicks: int | None = 20

    def __call__(self, problem: Problem, start: IntArray | None = None) -> RefinedPlan:
        """Improve until out of limits, from a plan ``start`` too if one is known."""
        return refined(problem, time_limit=self.time_limit, max_kicks=self.max_kicks, start=start)

    def within(self, problem: Problem, budget: Budget, start: IntArray) -> RefinedPlan:
        """Improve until the budget is spent, whatever the limits are."""
        return refined(problem, time_limit=None, budget=budget, start=start)


@dataclass(frozen=True, slots=True)
class DecentralisedPlanner:
    """The plan by messages between neighbours: RATT's, or with ``exchanges``, or with choices told ``hops`` far.

    Raises
    ------
    InputError : exchanges with limited hops.
    """

    exchanges: ExchangeParams | None = None
    hops: int | None = None
    faults: Faults | None = None
    seed: int = 0

    def __post_init__(self) -> None:
        if None not in {self.hops, self.exchanges}:
            raise InputError("hops", "must be None if robots exchange: all choices must be known", self.hops)

    def __call__(self, problem: Problem) -> DecentralisedPlan:
        """Plan in a simulation of the radios."""
        if self.exchanges is None:
            return decentralised_ratt(problem, hops=self.hops, faults=self.faults, seed=self.seed)
        return decentralised_refined(problem, params=self.exchanges, faults=self.faults, seed=self.seed)


@dataclass(frozen=True, slots=True)
class RandomPlanner:
    """A random plan; the numbers of a step depend on the seed and on the numbers of elements."""

    seed: int = 0

    def __call__(self, problem: Problem) -> Plan:
        """A uniformly random element of every robot."""
        information = getattr(problem.objective, "information", np.zeros(0))
        mixed = np.random.SeedSequence([check_integer("seed", self.seed, low=0), *information.tobytes()[:64]])
        return random_plan(problem, seed=int(mixed.generate_state(1)[0]))


_BY_NAME: dict[str, Planner] = {
    "ratt": ratt,
    "decentralised": DecentralisedPlanner(),
    "decentralised_refined": DecentralisedPlanner(exchanges=ExchangeParams()),
    "maxmin": MaxMinPlanner(),
    "refined": RefinedPlanner(),
    "greedy": greedy,
    "myopic": myopic,
    "nonrobust_optimum": nonrobust_optimum,
    "random": RandomPlanner(),
    **{name: published.plan for name, published in PUBLISHED.items() if published.takes_any},
}
PLANNERS = table_of(names.PLANNERS, _BY_NAME)
"""The planners of missions by name: the library's, and published ones."""


def get_planner(planner: str | Planner) -> Planner:
    """The planner of that name, or the given one. InputError : there is none, or it cannot be called."""
    return get_player("planner", planner, PLANNERS)


def planned_with(planner: Planner, problem: Problem, world: PlannerWorld | None) -> Planned:
    """Call a planner as ``f(problem)`` or, if it takes one, with the world.

    InputError : it needs a world, and the problem comes from none.
    """
    if not sees_world(planner):
        return planner(problem)
    if world is None:
        rule = "must be f(problem): this problem comes from no scenario, so there is no world to see"
        raise InputError("planner", rule, getattr(planner, "__name__", type(planner).__name__))
    return planner(problem, world)


def sees_world(planner: Planner) -> bool:
    """Tell whether a planner is ``f(problem, world)``: it has a parameter of that name, or requires a second one."""
    try:
        taken = list(signature(planner).parameters.values())
    except (TypeError, ValueError):  # compiled, or odd
        return False
    places = [p for p in taken if p.kind in {Parameter.POSITIONAL_ONLY, Parameter.POSITIONAL_OR_KEYWORD}]
    return len(places) > 1 and (places[1].name == "world" or places[1].default is Parameter.empty)


def elements_of(plan: Plan | MaxMinResult | IntArray, problem: Problem) -> IntArray:
    """A planner's elements, checked. InputError : they are no plan of the problem.

    A search that the user interrupted planned nothing: KeyboardInterrupt, or the mission would go on with another plan.
    """
    elements = plan if isinstance(plan, (np.ndarray, list, tuple)) else getattr(uninterrupted(plan), "elements", None)
    if elements is None:
        raise InputError("planner", "must return a plan or its elements", type(plan).__name__)
    return problem.check_plan(elements)
