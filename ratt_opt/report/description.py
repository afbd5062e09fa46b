"""Meaning of the numbers of a problem: names, labels, places, as far as its source has them."""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.scenario.information_input import InformationInput
from ratt_opt.scenario.model import Scenario
from ratt_opt.scenario.sensors.range_bearing import RangeBearing

if TYPE_CHECKING:
    from ratt_opt._validation import FloatArray
    from ratt_opt.problem import Problem

__all__ = ["Description", "FieldOfView", "describe", "named", "views_of"]


@dataclass(frozen=True, slots=True)
class FieldOfView:
    """A sensor's field of view: full ``angle`` about the heading [rad] and ``reach`` [m]; ``None`` for no limit."""

    angle: float | None
    reach: float | None


@dataclass(frozen=True, slots=True, kw_only=True)
class Description:
    """Names are empty, and the rest ``None``, if the source does not tell.

    ``robot_names`` : (N,); ``target_names`` : (M,); ``weights`` : (M,) importance of the targets.
    ``labels`` : (E,) what each element is ("3 m/s, 1 rad/s"); ``controls`` : (E, 2) speed [m/s] and turn rate [rad/s].
    ``poses`` : (N, 2 or 3) x, y [m] (and heading [rad]) now; ``poses_after`` : (E, 2 or 3) after each element.
    ``targets`` : (M, 2) predicted positions [m]; ``views`` : (N,) what each robot's sensor can see at most.
    """

    robot_names: tuple[str, ...]
    target_names: tuple[str, ...] | None
    weights: FloatArray | None
    labels: tuple[str, ...] | None
    controls: FloatArray | None = None
    poses: FloatArray | None = None
    poses_after: FloatArray | None = None
    targets: FloatArray | None = None
    views: tuple[FieldOfView, ...] | None = None

    def robot(self, i: int) -> str:
        """Robot ``i`` for people: its number, and its name if that says more."""
        return named(i, self.robot_names[i], "robot")

    def label(self, element: int) -> str:
        """Return the label of an element; its index if none is known."""
        return self.labels[element] if self.labels else f"element {element}"

    def pose_after(self, element: int) -> list[float] | None:
        """Return its robot's pose after an element's control: x, y [m], heading [rad] as far as known."""
        return None if self.poses_after is None else [float(x) for x in self.poses_after[element]]


def named(number: int, name: str, kind: str) -> str:
    """A robot's number, or a target's after a T, with its name unless that says the same ("R2", "robot 2", "2")."""
    shown = f"T{number}" if kind == "target" else f"{number}"
    again = re.fullmatch(rf"(?:{kind}|{kind[0]})?[\s_#-]*0*{number}", name, re.IGNORECASE)
    return f"{shown} {name}" if name and not again else shown


def describe(problem: Problem, source: object = None) -> Description:
    """Collect what ``source`` (a scenario, the contents of a model-free file, or neither) tells about a problem."""
    weights = getattr(problem.objective, "weights", None)
    if isinstance(source, Scenario):
        return Description(
            robot_names=tuple(robot.name for robot in source.robots),
            target_names=tuple(target.name for target in source.targets),
            weights=weights,
            labels=source.element_labels,
            controls=source.controls,
            poses=source.poses,
            poses_after=source.predicted_poses,
            targets=source.predicted_targets,
            views=views_of(source),
        )
    n_targets = getattr(problem.objective, "n_targets", None)
    unnamed = (("",) * problem.n_robots, None if n_targets is None else ("",) * n_targets)
    if not isinstance(source, InformationInput):
        return Description(robot_names=unnamed[0], target_names=unnamed[1], weights=weights, labels=None)
    return Description(
        robot_names=source.robot_names or unnamed[0],
        target_names=source.target_names or unnamed[1],
        weights=weights,
        labels=source.labels,
        controls=_array(source.element_controls),
        poses=_array(source.robot_positions),
        poses_after=_poses_after(source),
        targets=_array(source.target_positions),
    )


def _poses_after(source: InformationInput) -> FloatArray | None:
    places, headings = _array(source.element_positions), source.element_headings
    return places if places is None or headings is None else np.column_stack([places, headings])


def views_of(scenario: Scenario) -> tuple[FieldOfView, ...]:
    """(N,) limits of each robot's sensor."""
    sensors = [robot.sensor or scenario.sensor for robot in scenario.robots]
    limited = [sensor.sensor if isinstance(sensor, RangeBearing) else sensor for sensor in sensors]
    return tuple(FieldOfView(getattr(one, "field_of_view", None), getattr(one, "max_range", None)) for one in limited)


def _array(places: tuple[tuple[float, float], ...] | None) -> FloatArray | None:
    return None if places is None else np.array(places)
