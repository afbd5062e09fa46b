"""The world that a planner's problem comes from: where robots and targets are, by name, with links and attacks."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from ratt_opt._validation import FloatArray, IntArray, readonly
from ratt_opt._values import ByValue

if TYPE_CHECKING:
    from collections.abc import Sequence

    from ratt_opt.problem import Attack, Problem
    from ratt_opt.scenario.model import Scenario

__all__ = ["Now", "PlannerWorld", "scenario_world", "world_of"]


@dataclass(frozen=True, slots=True, eq=False)
class Now:
    """A step's number, its time [s], and the poses (N, p) at it; ``attacks`` so far."""

    step: int
    time: float
    poses: FloatArray
    attacks: tuple[tuple[int, Attack], ...] = ()


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class PlannerWorld(ByValue):
    """World that a planner ``f(problem, world)`` may look at beside the problem.

    ``step``, ``time`` : number of the step, and seconds since the start.
    ``poses`` : (N, 3 or 4) x [m], y [m], heading [rad] and, if a robot flies, height [m], now.
    ``ends`` : (E, 3 or 4) where each element's first control leads; ``controls`` : (E, c) that control.
    ``states`` : (M, d) predicted states of the targets when they are measured next; ``covariances`` : (M, d, d).
    ``weights`` : (M,). ``robot_names``, ``target_names`` : as in the scenario, ``""`` if it gives none.
    ``links`` : pairs ``(i, j)`` of robots that can communicate with their lengths [m], without what has failed.
    ``attacks`` : ``(step, attack)`` of each step in which the attack in force changed, oldest first, in team numbers.
    ``robots`` : (N,) numbers in the team of the robots that plan together; a problem numbers them 0, ..., N - 1.
    """

    step: int
    time: float
    poses: FloatArray
    ends: FloatArray
    controls: FloatArray
    states: FloatArray
    covariances: FloatArray
    weights: FloatArray
    robot_names: tuple[str, ...]
    target_names: tuple[str, ...]
    links: dict[tuple[int, int], float]
    robots: tuple[int, ...]
    attacks: tuple[tuple[int, Attack], ...] = ()

    @property
    def targets(self) -> FloatArray:
        """(M, 2) predicted positions x, y [m]."""
        return self.states[:, :2]

    @property
    def target_covariances(self) -> FloatArray:
        """(M, 2, 2) covariances of the predicted positions [m^2]."""
        return self.covariances[:, :2, :2]

    def part(
        self, members: Sequence[int], elements: IntArray, states: FloatArray, covariances: FloatArray
    ) -> PlannerWorld:
        """The world of some robots that plan together, with what they believe."""
        number = {robot: k for k, robot in enumerate(members)}
        links = {(number[i], number[j]): d for (i, j), d in self.links.items() if i in number and j in number}
        return replace(
            self,
            poses=readonly(self.poses[list(members)]),
            ends=readonly(self.ends[elements]),
            controls=readonly(self.controls[elements]),
            states=readonly(states),
            covariances=readonly(covariances),
            robot_names=tuple(self.robot_names[i] for i in members),
            links=links,
            robots=tuple(self.robots[i] for i in members),
        )


def _lengths(problem: Problem, poses: FloatArray) -> dict[tuple[int, int], float]:
    """Links of a problem with their lengths [m], heights included."""
    places = np.delete(poses, 2, axis=1)
    links = sorted(problem.communication.links)
    if not links:
        return {}
    ends = np.array(links)
    apart = np.linalg.norm(places[ends[:, 0]] - places[ends[:, 1]], axis=-1)
    return dict(zip(links, apart.tolist(), strict=True))


def world_of(
    scenario: Scenario,
    problem: Problem,
    beliefs: tuple[FloatArray, FloatArray],
    moves: tuple[FloatArray, FloatArray],
    now: Now,
) -> PlannerWorld:
    """The world of a team's problem in one step.

    ``beliefs`` : predicted states and covariances of the targets; ``moves`` : where each element leads, and its control
    """
    return PlannerWorld(
        step=now.step,
        time=now.time,
        poses=readonly(now.poses),
        ends=readonly(moves[0]),
        controls=readonly(moves[1]),
        states=beliefs[0],
        covariances=beliefs[1],
        weights=np.array([target.weight for target in scenario.targets]),
        robot_names=tuple(robot.name for robot in scenario.robots),
        target_names=tuple(target.name for target in scenario.targets),
        links=_lengths(problem, now.poses),
        robots=tuple(range(scenario.n_robots)),
        attacks=now.attacks,
    )


def scenario_world(scenario: Scenario, problem: Problem) -> PlannerWorld:
    """The world of a scenario's one-step problem."""
    beliefs, moves = (scenario.predicted_targets, scenario.prior), (scenario.predicted_poses, scenario.controls)
    return world_of(scenario, problem, beliefs, moves, Now(0, 0.0, scenario.poses))
