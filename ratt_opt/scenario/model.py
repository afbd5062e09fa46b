"""Scenario: robots, targets, sensors, links and budgets, as in Section VI of the paper."""

from __future__ import annotations

import re
from functools import cached_property
from typing import TYPE_CHECKING, Annotated, Literal, Self

import numpy as np
from pydantic import Field, model_validator

from ratt_opt._validation import readonly
from ratt_opt.errors import InputError
from ratt_opt.scenario.information_input import InformationInput, nested
from ratt_opt.scenario.motion import move_robots, predict_targets
from ratt_opt.scenario.own_sensors import replaced_methods
from ratt_opt.scenario.problem_record import Link, ProblemRecord, near_pairs
from ratt_opt.scenario.record import NonNegative, Number, Positive, Record, Text, Whole
from ratt_opt.scenario.sensor import Sensor
from ratt_opt.scenario.sensors.kinds import AnySensor, kind_of
from ratt_opt.scenario.sensors.model import SensorModel

if TYPE_CHECKING:
    import networkx as nx

    from ratt_opt._validation import FloatArray, IntArray

__all__ = ["DEFAULT_CONTROLS", "Robot", "Scenario", "Target"]

DEFAULT_CONTROLS = tuple((speed, turn) for speed in (1.0, -1.0, 3.0, -3.0) for turn in (0.0, 1.0, 3.0))
"""{1, -1, 3, -3} m/s x {0, 1, 3} rad/s. Source: ratt.tex, Section VI, common parameters."""

ON_TOP = 1e-9
"""A predicted range [m] below this is refused: the bearing has no derivative there."""


class Robot(Record):
    """A unicycle robot: pose now, and the finite set of controls it can execute.

    ``x``, ``y`` [m], ``heading`` [rad]; ``controls`` : (speed [m/s], turn rate [rad/s]) pairs;
    ``sensor`` : its own sensor, or ``None`` for the team's.
    """

    x: Number
    y: Number
    heading: Number = 0.0
    controls: Annotated[tuple[tuple[Number, Number], ...], Field(min_length=1)] = DEFAULT_CONTROLS
    sensor: Annotated[Sensor | SensorModel, AnySensor] | None = None
    name: Text = ""


class Target(Record):
    """A target: what is believed about it now, and how it moves.

    ``x``, ``y`` : estimated position [m]; ``covariance`` : of that estimate [m^2], symmetric positive
    definite; ``speed`` [m/s], ``turn_rate`` [rad/s], ``heading`` [rad] : its motion;
    ``process_std`` : standard deviation per axis of the motion noise in one period [m];
    ``weight`` : importance.

    The paper leaves covariance and noise open. Defaults: 3 m and 0.5 m standard deviation, a target
    known to within a few of the robots' steps.
    """

    x: Number
    y: Number
    covariance: tuple[tuple[Number, Number], tuple[Number, Number]] = ((9.0, 0.0), (0.0, 9.0))
    speed: Number = 0.0
    turn_rate: Number = 0.0
    heading: Number = 0.0
    process_std: NonNegative = 0.5
    weight: Positive = 1.0
    name: Text = ""

    @model_validator(mode="after")
    def _check_covariance(self) -> Self:
        (a, b), (c, d) = self.covariance
        if b != c:
            raise InputError("covariance", "must be symmetric", self.covariance)
        if not (a > 0 and a * d - b * c > 0):
            raise InputError("covariance", "must be positive definite", self.covariance)
        return self


class Scenario(ProblemRecord):
    """A team, its targets and the adversary's budgets: everything one planning step needs.

    ``links`` : pairs of robots that can communicate, or ``None``; ``communication_range`` : robots
    within this distance now are linked [m], or ``None``; with both ``None`` every pair is linked (the paper's case).
    ``sampling_period`` [s]. ``notes`` : remarks kept with the file, for instance corrections made on import.
    """

    format: Literal["ratt-opt scenario"] = "ratt-opt scenario"
    version: Literal[1] = 1
    robots: Annotated[tuple[Robot, ...], Field(min_length=1)]
    targets: Annotated[tuple[Target, ...], Field(min_length=1)]
    sensor: Annotated[Sensor | SensorModel, AnySensor] = Sensor()
    sampling_period: Positive = 1.0
    alpha_s: Whole
    alpha_c: Whole
    links: tuple[Link, ...] | None = None
    communication_range: Positive | None = None
    protected_robots: tuple[Whole, ...] = ()
    protected_links: tuple[Link, ...] = ()
    notes: tuple[Text, ...] = ()

    @model_validator(mode="after")
    def _check_whole(self) -> Self:
        if self.links is not None and self.communication_range is not None:
            raise InputError("communication_range", "must be absent if links are listed", self.communication_range)
        self._check_sizes(sum(len(robot.controls) for robot in self.robots), 2)
        self._check_links()
        self._check_ranges()
        self._check_matrices()
        return self

    @property
    def n_robots(self) -> int:
        """Number of robots N."""
        return len(self.robots)

    @property
    def n_targets(self) -> int:
        """Number of targets M."""
        return len(self.targets)

    @cached_property
    def robot(self) -> IntArray:
        """(E,) owner of each element; elements are the robots' controls, robot by robot, in file order."""
        return readonly(np.repeat(np.arange(self.n_robots), [len(robot.controls) for robot in self.robots]))

    @cached_property
    def controls(self) -> FloatArray:
        """(E, 2) speed [m/s] and turn rate [rad/s] of each element."""
        return readonly(np.array([control for robot in self.robots for control in robot.controls]))

    @cached_property
    def poses(self) -> FloatArray:
        """(N, 3) poses now: x [m], y [m], heading [rad]."""
        return readonly(np.array([(robot.x, robot.y, robot.heading) for robot in self.robots]))

    @cached_property
    def predicted_poses(self) -> FloatArray:
        """(E, 3) pose of the owner after each element's control."""
        return readonly(move_robots(self.poses[self.robot], self.controls, self.sampling_period))

    @cached_property
    def predicted_targets(self) -> FloatArray:
        """(M, 2) predicted mean positions [m]; the sensor model is linearised there."""
        positions = np.array([(target.x, target.y) for target in self.targets])
        motions = np.array([(target.speed, target.turn_rate, target.heading) for target in self.targets])
        return readonly(predict_targets(positions, motions, self.sampling_period))

    @cached_property
    def prior(self) -> FloatArray:
        """(M, 2, 2) predicted covariances ``P + Q`` [m^2] (EKF prediction)."""
        noise = np.array([target.process_std**2 for target in self.targets])
        return readonly(np.array([target.covariance for target in self.targets]) + noise[:, None, None] * np.eye(2))

    @cached_property
    def information(self) -> FloatArray:
        """(E, M, 2, 2) information ``H^T R^{-1} H`` of each element about each target [1/m^2]."""
        information = np.empty((len(self.robot), self.n_targets, 2, 2))
        for i, robot in enumerate(self.robots):
            own = self.robot == i
            information[own] = (robot.sensor or self.sensor).information(
                self.predicted_poses[own], self.predicted_targets
            )
        return readonly(information)

    @property
    def graph(self) -> nx.Graph | None:
        """The communication graph, or ``None`` for the complete one."""
        return self.graph_at(self.poses)

    def graph_at(self, poses: FloatArray) -> nx.Graph | None:
        """The communication graph of robots at poses (N, 3), or ``None`` for the complete one."""
        if self.communication_range is None:
            return super().graph
        return self._graph_of(near_pairs(poses, self.communication_range))

    @cached_property
    def element_labels(self) -> tuple[str, ...]:
        """(E,) what each element is, for people."""
        return tuple(f"{speed:g} m/s, {turn:.4g} rad/s" for speed, turn in self.controls)

    @property
    def own_sensors(self) -> dict[str, str]:
        """Fields that hold a sensor with behaviour of its own that no file can name, and in words which."""
        fields = {"sensor": self.sensor}
        fields |= {f"robots[{i}].sensor": own for i, robot in enumerate(self.robots) if (own := robot.sensor)}
        return {name: words for name, sensor in fields.items() if (words := _unnamed(sensor))}

    @property
    def storable(self) -> Scenario | InformationInput:
        """This scenario, or its matrices if a sensor has behaviour that no scenario file can name."""
        return self.to_information() if self.own_sensors else self

    def to_information(self) -> InformationInput:
        """The same one-step problem as matrices: what a sensor class of your own tells goes into a file this way."""
        links = near_pairs(self.poses, self.communication_range) if self.communication_range else self.links
        return InformationInput(
            prior=nested(self.prior),
            information=nested(self.information),
            robot=tuple(self.robot.tolist()),
            alpha_s=self.alpha_s,
            alpha_c=self.alpha_c,
            weights=tuple(target.weight for target in self.targets),
            labels=self.element_labels,
            links=links,
            protected_robots=self.protected_robots,
            protected_links=self.protected_links,
            notes=self.notes,
            robot_names=tuple(robot.name for robot in self.robots),
            target_names=tuple(target.name for target in self.targets),
            robot_positions=nested(self.poses[:, :2]),
            element_positions=nested(self.predicted_poses[:, :2]),
            target_positions=nested(self.predicted_targets),
            units=("m", "m"),
            element_headings=nested(self.predicted_poses[:, 2]),
            element_controls=nested(self.controls),
        )

    @property
    def _owners(self) -> IntArray:
        return self.robot

    @property
    def _places(self) -> FloatArray:
        return self.poses

    @property
    def _matrices(self) -> tuple[FloatArray, FloatArray, FloatArray]:
        return self.prior, self.information, np.array([target.weight for target in self.targets])

    def _check_matrices(self) -> None:
        """Every rule of the matrices too, by the names that they have here: what loads can be planned."""
        try:
            self.problem()
        except InputError as error:
            about = [int(number) for number in re.findall(r"\d+", error.argument)]
            if error.argument.startswith("prior["):
                raise InputError(f"targets[{about[0]}].covariance: {error.argument}", error.rule, error.value) from None
            if error.argument.startswith("information["):
                where = f"sensor of robots[{self.robot[about[0]]}] for targets[{about[1]}].covariance"
                raise InputError(where, error.rule, error.value) from None
            raise

    def _check_ranges(self) -> None:
        apart = np.linalg.norm(self.predicted_poses[:, None, :2] - self.predicted_targets[None], axis=-1)
        if apart.min() < ON_TOP:
            e, j = (int(k) for k in np.argwhere(apart < ON_TOP)[0])
            rule = f"must not end on top of target {j}'s predicted position (range 0 has no bearing)"
            raise InputError(
                f"robots[{self.robot[e]}] with control {self.element_labels[e]}",
                rule,
                tuple(self.predicted_targets[j].tolist()),
            )


def _unnamed(sensor: Sensor | SensorModel) -> str:
    """What a sensor is that no file can name; nothing if one can."""
    if type(sensor) is Sensor or kind_of(sensor):
        return ""
    if isinstance(sensor, SensorModel):
        return f"{type(sensor).__name__}, which is not registered"
    own = replaced_methods(sensor)
    return f"{type(sensor).__name__} with its own {', '.join(own)}" if own else ""
