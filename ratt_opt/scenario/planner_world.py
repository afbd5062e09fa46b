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

__all__ = ["PlannerWorld", "lengths_of", "scenario_world"]


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


def lengths_of(problem: Problem, poses: FloatArray) -> dict[tuple[int, int], float]:
    """Links of a problem with their lengths [m], heights included."""
    places = np.delete(poses, 2, axis=1)
    links = sorted(problem.communication.links)
    if not links:
        return {}
    ends = np.array(links)
    apart = np.linalg.norm(places[ends[:, 0]] - places[ends[:, 1]], axis=-1)
    return dict(zip(links, apart.tolist(), strict=True))


def scenario_world(scenario: Scenario, problem: Problem) -> PlannerWorld:
    """The world of a scenario's one-step problem."""
    return PlannerWorld(
        step=0,
        time=0.0,
        poses=scenario.poses,
        ends=scenario.predicted_poses,
        controls=scenario.controls,
        states=scenario.predicted_targets,
        covariances=scenario.prior,
        weights=np.array([target.weight for target in scenario.targets]),
        robot_names=tuple(robot.name for robot in scenario.robots),
        target_names=tuple(target.name for target in scenario.targets),
        links=lengths_of(problem, scenario.poses),
        robots=tuple(range(scenario.n_robots)),
    )
