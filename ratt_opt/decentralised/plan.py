"""RATT's plan made by messages between neighbours, with what it cost and what it guarantees."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from typing import TYPE_CHECKING

import numpy as np

from ratt_opt._validation import check_integer, readonly
from ratt_opt.bounds.heard_sets import heard_sets_bound
from ratt_opt.budget import Budget, Stop
from ratt_opt.decentralised.agent import Agent
from ratt_opt.decentralised.faults import Faults
from ratt_opt.decentralised.knowledge import Disagreement, Knowledge
from ratt_opt.decentralised.simulator import Simulation
from ratt_opt.errors import InputError
from ratt_opt.problem import Plan, Problem, check_problem
from ratt_opt.solvers.ratt import links_worth

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from ratt_opt.bounds.guarantees import Curvatures, Guarantee
    from ratt_opt.graph.threat import Threat

__all__ = ["DecentralisedPlan", "decentralised_ratt", "knowledge_of", "make_agents", "network_left"]

MOST_ROBOTS = 2**15
"""Robots that the messages' numbers tell apart."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class DecentralisedPlan(Plan):
    """A plan made by messages. Robots that crashed keep the element that they had.

    ``components`` : robots that planned together, ascending, by the lowest; a crashed robot alone
    ``heard`` : of each robot, the robots whose choices it knew when it chose, in the order of their choices; bait none
    ``rounds`` : longest chain of messages; ``messages``, ``bytes`` : sent until the last robot ended
    ``decision_time`` : until then, at the radios' bandwidth and delays [s]
    ``disagreements`` : neighbours that were refused, and why
    ``faults_met`` : ``(round, kind, robots)`` of the faults that came before the end
    ``cliques`` : sets of greedy robots in each of which all had heard each other, one way; 1 if there are none
    ``guarantee`` : share of the optimum that the plan's worst case keeps, blinded robots without information
    ``stop`` : ``EXHAUSTED``, or why it stopped before the end; robots then keep the best element so far
    """

    components: tuple[tuple[int, ...], ...]
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


def decentralised_ratt(
    problem: Problem,
    *,
    faults: Faults | None = None,
    seed: int = 0,
    time_limit: float | None = None,
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
    k, c : curvature of a submodular criterion, or total curvature, over feasible sets: the guarantee is stated for it;
        if neither is given, for the total curvature known from theory, which is 1 for the criteria of this library

    Raises
    ------
    InputError : another set function, faults of robots or links that do not exist, or a negative seed.

    Source: ratt.tex, Section VII, first direction; Algorithm 1 for the plan.
    """
    problem, seed = check_problem(problem), check_integer("seed", seed, low=0)
    known = {"k": k, "c": problem.objective.most_total_curvature if (k, c) == (None, None) else c}
    heard_sets_bound(1, **known)
    budget = Budget(time_limit)
    agents = make_agents(problem)
    simulation = Simulation(agents, (faults or Faults()).check(problem), seed)
    stop = simulation.run(budget)
    return plan_of(problem, simulation, stop, known)


def plan_of(problem: Problem, simulation: Simulation, stop: Stop, known: Mapping[str, Curvatures]) -> DecentralisedPlan:
    """Collect the decisions of the agents; ``known`` : the curvature of the guarantee."""
    agents, costs = simulation.agents, simulation.costs
    robots = range(problem.n_robots)
    heard = {i: agents[i].heard for i in robots}
    cliques = _cliques({i: others for i, others in heard.items() if others})  # who heard nobody chose as bait does
    return DecentralisedPlan(
        elements=readonly(np.array([agents[i].element for i in robots])),
        evaluations=sum(agent.evaluations for agent in agents.values()),
        bait=tuple(i for i in robots if i not in simulation.crashed and i in agents[i].bait),
        components=network_left(problem, simulation),
        heard=tuple(heard.values()),
        rounds=costs.rounds,
        messages=costs.messages,
        bytes=costs.bytes,
        decision_time=costs.time,
        disagreements=tuple(one for i in robots for one in agents[i].disagreements),
        faults_met=tuple(simulation.met),
        cliques=cliques,
        guarantee=heard_sets_bound(cliques, **known),
        stop=stop,
    )


def _cliques(heard: Mapping[int, tuple[int, ...]]) -> int:
    """Number of cliques that cover the given robots, first fit in the order of how many each has heard; at least 1."""
    found: list[list[int]] = []
    for i in sorted(heard, key=lambda robot: (len(heard[robot]), robot)):
        known = set(heard[i])
        for clique in found:
            if known.issuperset(clique):
                clique.append(i)
                break
        else:
            found.append([i])
    return max(len(found), 1)


def network_left(problem: Problem, simulation: Simulation) -> tuple[tuple[int, ...], ...]:
    """Components that are left of the network: crashed robots alone, no cut or refused links."""
    lost = {link for link in problem.communication.links if set(link) & simulation.crashed} | simulation.cut
    lost |= {
        (min(one.robot, one.neighbour), max(one.robot, one.neighbour))
        for agent in simulation.agents.values()
        for one in agent.disagreements
    }
    return tuple(sorted(tuple(sorted(group)) for group in problem.communication.groups(lost)))


def make_agents(problem: Problem) -> dict[int, Agent]:
    """One agent for each robot of a problem.

    Raises
    ------
    InputError : the objective is no criterion of information matrices, or robots are too many for the messages.
    """
    if problem.n_robots > MOST_ROBOTS:
        raise InputError("problem", f"must have at most {MOST_ROBOTS} robots for messages", problem.n_robots)
    worth = lru_cache(maxsize=None)(links_worth)  # robots that know the same links find the same number
    near = problem.communication.neighbours_of
    return {i: Agent(knowledge_of(problem, i, near(i), worth)) for i in range(problem.n_robots)}


def knowledge_of(
    problem: Problem, robot: int, near: tuple[int, ...], worth: Callable[[Threat], int] = links_worth
) -> Knowledge:
    """Part of a problem that one robot knows at first."""
    elements = problem.choices[robot]
    kept = problem.protected_links
    return Knowledge(
        robot=robot,
        elements=elements,
        objective=problem.information_objective.restricted_to(elements),
        neighbours=near,
        protected=frozenset(j for j in near if (min(robot, j), max(robot, j)) in kept),
        alpha_s=problem.alpha_s,
        alpha_c=problem.alpha_c,
        links_worth=worth,
    )
