"""RATT's plan made by messages between neighbours, with what it cost and what it guarantees."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from graphlib import TopologicalSorter
from typing import TYPE_CHECKING, Any

import numpy as np

from ratt_opt._validation import check_integer, readonly
from ratt_opt.bounds.guarantees import Guarantee
from ratt_opt.bounds.heard_sets import heard_sets_bound
from ratt_opt.budget import Budget, Stop, interruptible
from ratt_opt.decentralised.agent import Agent
from ratt_opt.decentralised.faults import Faults
from ratt_opt.decentralised.knowledge import Disagreement, ExchangeParams, Knowledge
from ratt_opt.decentralised.messages import MOST_ROBOTS
from ratt_opt.decentralised.simulator import Simulation
from ratt_opt.errors import InputError
from ratt_opt.problem import Plan, Problem, check_problem
from ratt_opt.solvers.ratt import links_worth

if TYPE_CHECKING:
    from collections.abc import Mapping

    from ratt_opt._validation import IntArray
    from ratt_opt.bounds.guarantees import Curvatures

__all__ = ["DecentralisedPlan", "decentralised_ratt", "decentralised_refined", "knowledge_of", "make_agents"]

NOTHING = Guarantee(0.0, ("no exchange in a component that planned alone",), "none", "none")


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class DecentralisedPlan(Plan):
    """A plan made by messages. Robots that crashed keep the element that they had.

    ``components`` : robots that planned together, ascending, by the lowest; a crashed robot alone
    ``exchanges`` : after RATT's plan, by component; if planning was stopped, those that all of its robots had heard of
    ``heard`` : of each robot, the robots whose choices it knew when it chose, in the order of their choices; bait none
    ``rounds`` : longest chain of messages; ``messages``, ``bytes`` : sent until the last robot ended
    ``decision_time`` : until then, at the radios' bandwidth and delays [s]
    ``disagreements`` : neighbours that were refused, and why
    ``faults_met`` : ``(round, kind, robots)`` of the faults that came before the end
    ``cliques`` : sets of greedy robots in each of which all had heard each other's last choice, one way; at least 1
    ``guarantee`` : share of the optimum that the plan's worst case keeps, blinded robots without information
    ``stop`` : ``EXHAUSTED``, or why it stopped before the end; robots then keep the best element so far
    """

    components: tuple[tuple[int, ...], ...]
    exchanges: tuple[int, ...]
    heard: tuple[tuple[int, ...], ...]
    rounds: int
    messages: int
    bytes: int
    decision_time: float
    disagreements: tuple[Disagreement, ...]
    faults_met: tuple[tuple[int, str, tuple[int, ...]], ...]
    cliques: int
    guarantee: Guarantee
    stop: Stop


@interruptible
def decentralised_ratt(
    problem: Problem,
    *,
    faults: Faults | None = None,
    seed: int = 0,
    time_limit: float | None = None,
    hops: int | None = None,
    k: Curvatures = None,
    c: Curvatures = None,
) -> DecentralisedPlan:
    """Plan by messages between neighbours, in a deterministic simulation of their radios.

    On a connected network that stays so, the plan is RATT's, element by element, whatever is delayed, lost, repeated or
    overtaken. If the network splits meanwhile, each component has the plan that RATT makes for it alone, with
    both budgets clamped to it and blinded robots without information (``agent.py`` has the proof).

    Parameters
    ----------
    problem : with a criterion of information matrices: these are what robots send
    faults : what goes wrong; nothing by default
    seed : of delays, losses and duplicates
    time_limit : seconds of computing, not of the radios
    hops : links over which a choice is told. Then robots that are no bait choose in the order of their numbers, each
        beside the choices told within that distance, without auctions
    k, c : curvature of a submodular criterion, or total curvature, over feasible sets: the guarantee is stated for it;
        if neither is given, for the total curvature known from theory, which is 1 for the criteria of this library

    Raises
    ------
    InputError : another set function, faults of robots or links that do not exist, or a negative seed.

    Source: ratt.tex, Section VII, first direction; Algorithm 1 for the plan.
    """
    hops = None if hops is None else check_integer("hops", hops, low=1)
    return _planned(problem, {"hops": hops}, faults, seed, time_limit, {"k": k, "c": c})


@interruptible
def decentralised_refined(
    problem: Problem,
    *,
    params: ExchangeParams | None = None,
    faults: Faults | None = None,
    seed: int = 0,
    time_limit: float | None = None,
    k: Curvatures = None,
    c: Curvatures = None,
) -> DecentralisedPlan:
    """Improve the plan of :func:`decentralised_ratt` by exchanges that neighbours propose, in the same simulation.

    A robot searches for better elements of its own and its neighbours beside what the others have. The best proposal of
    a component is taken if the component's worst case is proved to rise. So every component's plan is at any time no
    worse for it than RATT's. A component that planned alone guards its own worst case only: the guarantee is then
    not claimed of exchanged elements.

    Parameters
    ----------
    params : of the exchanges
    problem, faults, seed, time_limit, k, c : as in :func:`decentralised_ratt`

    Raises
    ------
    InputError : as :func:`decentralised_ratt`.

    Source: this library; the neighbourhoods are those of large neighbourhood search (Shaw 1998), one a robot.
    """
    return _planned(problem, {"exchanges": params or ExchangeParams()}, faults, seed, time_limit, {"k": k, "c": c})


def _planned(  # noqa: PLR0917
    problem: Problem,
    way: Mapping[str, Any],
    faults: Faults | None,
    seed: int,
    time_limit: float | None,
    known: Mapping[str, Curvatures],
) -> DecentralisedPlan:
    problem, seed = check_problem(problem), check_integer("seed", seed, low=0)
    if known["k"] is None and known["c"] is None:
        known = {"c": problem.objective.most_total_curvature}
    heard_sets_bound(1, **known)
    budget = Budget(time_limit)
    simulation = Simulation(make_agents(problem, budget=budget, **way), (faults or Faults()).check(problem), seed)
    stop = simulation.run(budget)
    agents, costs, robots = simulation.agents, simulation.costs, range(problem.n_robots)
    components = _network_left(problem, simulation)
    exchanges = tuple(min(agents[i].exchanges for i in group) for group in components)  # that all have heard of
    after = {i: taken for group, taken in zip(components, exchanges, strict=True) for i in group}
    elements = readonly(np.array([agents[i].element_after(after[i]) for i in robots]))
    is_ratts = not any(exchanges)
    cliques = _cliques({i: agents[i].own.heard for i in robots}, elements) if is_ratts else len(components)
    return DecentralisedPlan(
        elements=elements,
        evaluations=sum(agent.own.evaluations for agent in agents.values()),
        bait=tuple(i for i in robots if i not in simulation.crashed and i in agents[i].bait),
        components=components,
        exchanges=exchanges,
        heard=tuple(tuple(agents[i].own.heard) for i in robots),
        rounds=costs.rounds,
        messages=costs.messages,
        bytes=costs.bytes,
        decision_time=costs.time,
        disagreements=tuple(one for i in robots for one in agents[i].disagreements),
        faults_met=tuple(simulation.met),
        cliques=cliques,
        guarantee=heard_sets_bound(cliques, **known) if is_ratts or len(components) == 1 else NOTHING,
        stop=stop,
    )


def _cliques(heard: Mapping[int, Mapping[int, int]], elements: IntArray) -> int:
    """Number of cliques that cover the robots that heard somebody, first fit in the order of their choices; at least 1.

    ``heard`` : of each robot the robots that it heard, with the elements that they had then: who changed was not heard.
    """
    last = {i: {j for j, e in others.items() if elements[j] == e} for i, others in heard.items() if others}
    found: list[set[int]] = []
    for i in TopologicalSorter({i: sorted(known & last.keys()) for i, known in last.items()}).static_order():
        clique = next((clique for clique in found if clique <= last[i]), None)
        if clique is None:
            found.append({i})
        else:
            clique.add(i)
    return max(len(found), 1)


def _network_left(problem: Problem, simulation: Simulation) -> tuple[tuple[int, ...], ...]:
    """Components that are left of the network: crashed robots alone, no cut or refused links."""
    lost = {link for link in problem.communication.links if set(link) & simulation.crashed} | simulation.cut
    lost |= {
        (min(one.robot, one.neighbour), max(one.robot, one.neighbour))
        for agent in simulation.agents.values()
        for one in agent.disagreements
    }
    return tuple(sorted(tuple(sorted(group)) for group in problem.communication.groups(lost)))


def make_agents(problem: Problem, **way: Any) -> dict[int, Agent]:
    """One agent for each robot of a problem; ``way`` : further fields of their :class:`Knowledge`.

    Raises
    ------
    InputError : the objective is no criterion of information matrices, or robots are too many for the messages.
    """
    if problem.n_robots > MOST_ROBOTS:
        raise InputError("problem", f"must have at most {MOST_ROBOTS} robots for messages", problem.n_robots)
    worth = lru_cache(maxsize=None)(links_worth)  # robots that know the same links find the same number
    return {i: Agent(knowledge_of(problem, i, links_worth=worth, **way)) for i in range(problem.n_robots)}


def knowledge_of(problem: Problem, robot: int, **more: Any) -> Knowledge:
    """Part of a problem that one robot knows at first; ``more`` : its further fields."""
    elements, near, kept = problem.choices[robot], problem.communication.neighbours_of(robot), problem.protected_links
    return Knowledge(
        robot=robot,
        elements=elements,
        objective=problem.information_objective.restricted_to(elements),
        neighbours=near,
        protected=frozenset(j for j in near if (min(robot, j), max(robot, j)) in kept),
        is_protected=robot in problem.protected_robots,
        alpha_s=problem.alpha_s,
        alpha_c=problem.alpha_c,
        **{"links_worth": links_worth, **more},
    )
