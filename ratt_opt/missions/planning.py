"""The plan of one step for the whole team: one problem, or one for each part that standing failures keep apart."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from ratt_opt._validation import FloatArray, IntArray, readonly
from ratt_opt.missions.ahead.horizon import Sequences
from ratt_opt.missions.beam import beam_sequences
from ratt_opt.problem import Attack, Problem
from ratt_opt.scenario.planner_world import world_of

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from ratt_opt.missions.belief import Belief
    from ratt_opt.missions.memory import Memory
    from ratt_opt.missions.world import Threatened, World
    from ratt_opt.scenario.planner_world import Now, PlannerWorld
    from ratt_opt.setfunctions.information import InformationObjective

__all__ = ["PlanningGroup", "TeamPlan", "capped", "offered_sequences", "part_problem", "plan_team", "planner_world"]


@dataclass(frozen=True, slots=True, eq=False)
class PlanningGroup:
    """Robots that plan together: ``elements`` of the team, ascending, that are those of ``problem``.

    ``world`` : what they know of it.
    """

    elements: IntArray
    problem: Problem
    world: PlannerWorld


@dataclass(frozen=True, slots=True, eq=False)
class TeamPlan:
    """Choices of a team in one step: ``sequences`` are the elements of ``problem``, the whole team's.

    ``links_short`` : by how many links the network is smaller than what may be cut.
    """

    memory: Memory
    sequences: Sequences
    problem: Problem
    parts: tuple[PlanningGroup, ...]
    links_short: int

    def chosen(self, plan: Callable[[PlanningGroup], IntArray]) -> IntArray:
        """(N,) elements of the team, each part planned by ``plan``."""
        picked = [part.elements[plan(part)] for part in self.parts]
        return readonly(np.sort(np.concatenate(picked)))  # elements are ascending by robot

    def with_budgets(self, alpha_s: int, alpha_c: int) -> Problem:
        """The team's problem for an attacker with these budgets."""
        return capped(self.problem, alpha_s, alpha_c)

    def groups_under(self, attack: Attack) -> list[frozenset[int]]:
        """Connected robots, blinded ones included, by the lowest."""
        links = attack.links & self.problem.communication.links
        return sorted(self.problem.communication.groups(links), key=min)

    def best_of(self, groups: Sequence[frozenset[int]], elements: IntArray, attack: Attack) -> int:
        """Position of the group worth most; among equals the first."""
        return int(np.argmax([self.value(group - attack.sensing, elements) for group in groups]))

    def value(self, robots: frozenset[int], elements: IntArray) -> float:
        """Criterion of some robots' measurements."""
        return self.problem.objective(elements[sorted(robots)])


def capped(problem: Problem, alpha_s: int, alpha_c: int) -> Problem:
    """The problem for an attacker with these budgets, or with all the robots and links that there are."""
    links = len(problem.communication.links)
    return replace(problem, alpha_s=min(alpha_s, problem.n_robots), alpha_c=min(alpha_c, links))


def plan_team(world: World, memory: Memory, now: Now, threatened: Threatened) -> TeamPlan:
    """Build the problem of a step, after all connected robots have shared their measurements."""
    poses, time = now.poses, now.time
    apart = world.communication(poses, threatened.standing).groups()
    memory = memory.shared(apart)
    beliefs = [memory.belief(min(group)) for group in apart]
    if all(belief is beliefs[0] or belief == beliefs[0] for belief in beliefs[1:]):
        objective, sequences = world.objective(beliefs[0], offered_sequences(world, beliefs[0], poses, time), time)
        problem = world.problem(objective, sequences.owner, poses, threatened)
        seen = planner_world(world, beliefs[0], sequences, problem, now)
        whole = (PlanningGroup(np.arange(problem.objective.n), problem, seen),)
        return TeamPlan(memory, sequences, problem, whole, threatened.alpha_c - problem.alpha_c)
    return _apart(world, memory, (now, threatened), list(zip(apart, beliefs, strict=True)))


def planner_world(world: World, belief: Belief, sequences: Sequences, problem: Problem, now: Now) -> PlannerWorld:
    """Return the world that planners of a team's problem may look at."""
    ahead = belief.predicted(world.motion, world.period, now.time)
    moves = sequences.poses[:, 0], sequences.controls[:, 0]
    return world_of(world.scenario, problem, (ahead.mean, ahead.covariance), moves, now)


def offered_sequences(world: World, belief: Belief, poses: FloatArray, time: float) -> Sequences:
    """All control sequences, or the beam of a belief."""
    if world.model.beam is None or world.horizon == 1:
        return world.sequences(poses)
    return beam_sequences(world, belief, poses, time)


def _apart(
    world: World,
    memory: Memory,
    at: tuple[Now, Threatened],
    groups: list[tuple[frozenset[int], Belief]],
) -> TeamPlan:
    """Each group plans with its own belief; the attacker's problem is that of the belief that knows most."""
    now, threatened = at
    poses, time = now.poses, now.time
    own, kept = [], []
    for group, belief in groups:
        offered = offered_sequences(world, belief, poses, time)
        objective, sequences = world.objective(belief, offered.only(np.isin(offered.owner, sorted(group))), time)
        own.append(objective)
        kept.append(sequences)
    owner = np.concatenate([sequences.owner for sequences in kept])
    order = np.argsort(owner, kind="stable")
    joined = Sequences(
        readonly(owner[order]),
        readonly(np.concatenate([sequences.controls for sequences in kept])[order]),
        readonly(np.concatenate([sequences.poses for sequences in kept])[order]),
    )
    knowing = min((belief for _, belief in groups), key=lambda belief: belief.trace)
    criterion = world.criterion(knowing, joined, time)
    team = world.problem(criterion, joined.owner, poses, threatened)
    parts, seen = [], planner_world(world, knowing, joined, team, now)
    for (group, belief), objective in zip(groups, own, strict=True):
        members, elements = sorted(group), np.flatnonzero(np.isin(joined.owner, sorted(group)))
        ahead = belief.predicted(world.motion, world.period, time)
        problem = part_problem(team, objective, members, elements, threatened)
        parts.append(
            PlanningGroup(readonly(elements), problem, seen.part(members, elements, ahead.mean, ahead.covariance))
        )
    return TeamPlan(memory, joined, team, tuple(parts), threatened.alpha_c - team.alpha_c)


def part_problem(
    team: Problem, objective: InformationObjective, members: list[int], elements: IntArray, threatened: Threatened
) -> Problem:
    """The problem of some robots, numbered anew, with what of the budgets can hit them."""
    import networkx as nx

    number = {robot: k for k, robot in enumerate(members)}
    graph: nx.Graph = nx.Graph()
    graph.add_nodes_from(range(len(members)))
    links = {link for link in team.communication.links if link[0] in number and link[1] in number}
    graph.add_edges_from((number[i], number[j]) for i, j in links)
    owner = np.array([number[int(i)] for i in team.robot[elements]])
    blind = np.isin(team.robot[elements], sorted(threatened.standing.sensing))
    if blind.any():
        objective = objective.with_information(np.where(blind[:, None, None, None], 0.0, objective.information))
    return Problem(
        objective,
        owner,
        graph,
        min(team.alpha_s, len(members)),
        min(team.alpha_c, len(links)),
        frozenset(number[i] for i in team.protected_robots if i in number),
        frozenset((number[i], number[j]) for i, j in team.protected_links & links),
    )
