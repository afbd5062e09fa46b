"""The problem of a mission's first step, as data: what a plan is made for when nobody has moved yet."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.errors import InputError
from ratt_opt.missions.memory import Memory
from ratt_opt.missions.planning import TeamPlan, plan_team
from ratt_opt.missions.world import MissionModel, Threatened, World
from ratt_opt.problem import Attack
from ratt_opt.scenario.information_input import InformationInput, nested
from ratt_opt.scenario.model import STATE_UNITS, Scenario
from ratt_opt.scenario.planner_world import Now
from ratt_opt.scenario.problem_record import near_pairs
from ratt_opt.setfunctions.criteria.registry import WITH_OUTPUT
from ratt_opt.setfunctions.information import InformationObjective

if TYPE_CHECKING:
    from ratt_opt.scenario.planner_world import PlannerWorld

__all__ = ["first_step", "first_world"]


def first_step(scenario: object, model: MissionModel) -> InformationInput:
    """Return the input of the first step of a mission with this model: its sensors, motions and filter.

    Raises
    ------
    InputError : it is no scenario, or the model does not fit it.
    """
    world, memory, team = _first(scenario, model)
    scenario = world.scenario
    objective, sequences = team.problem.objective, team.sequences
    assert isinstance(objective, InformationObjective)
    targets = memory.belief(0).predicted(world.motion, world.period, 0.0).positions
    controls, poses = sequences.controls[:, 0], sequences.poses[:, 0]
    near = scenario.communication_range
    return InformationInput(
        prior=nested(objective.prior),
        information=nested(objective.information),
        robot=tuple(sequences.owner.tolist()),
        alpha_s=scenario.alpha_s,
        alpha_c=scenario.alpha_c,
        weights=tuple(target.weight for target in scenario.targets),
        labels=scenario.control_labels(sequences.owner, controls),
        links=scenario.links if near is None else near_pairs(scenario.poses, near),
        protected_robots=scenario.protected_robots,
        protected_links=scenario.protected_links,
        notes=(*scenario.notes, "the first step of a mission with a model of its own"),
        robot_names=tuple(robot.name for robot in scenario.robots),
        target_names=tuple(target.name for target in scenario.targets),
        robot_positions=nested(scenario.poses[:, :2]),
        element_positions=nested(poses[:, :2]),
        element_headings=tuple(poses[:, 2].tolist()),
        element_controls=nested(controls) if controls.shape[1] == 2 else None,
        target_positions=nested(targets),
        output=nested(np.eye(2, world.reads)) if world.reads > 2 and model.objective in WITH_OUTPUT else None,
        units=STATE_UNITS[: objective.dimension],
    )


def first_world(scenario: Scenario, model: MissionModel) -> PlannerWorld:
    """Return the world that planners of that problem may look at."""
    *_, team = _first(scenario, model)
    return team.parts[0].world


def _first(scenario: object, model: MissionModel) -> tuple[World, Memory, TeamPlan]:
    """The mission's world, what the team knows, and what it can choose."""
    if not isinstance(scenario, Scenario):
        rule = "must be absent, or come with a Scenario: its sensors and motions need poses"
        raise InputError("model", rule, type(scenario).__name__)
    world = World(scenario, model, 1)
    memory = Memory.start(world.motion, world.period, world.motion.initial(scenario), scenario.n_robots)
    threatened = Threatened(Attack(), scenario.alpha_s, scenario.alpha_c)
    return world, memory, plan_team(world, memory, Now(0, 0.0, scenario.poses), threatened)
