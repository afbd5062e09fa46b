"""Scenario: robots, targets, sensors, links and budgets, as in Section VI of the paper."""

from __future__ import annotations

import re
from functools import cached_property
from typing import TYPE_CHECKING, Annotated, Any, Literal, Self

import numpy as np
from pydantic import Field, SerializerFunctionWrapHandler, model_serializer, model_validator

from ratt_opt._validation import readonly
from ratt_opt.errors import InputError
from ratt_opt.scenario.information_input import InformationInput, nested
from ratt_opt.scenario.motion import fly_robots, move_robots, predict_targets, white_acceleration
from ratt_opt.scenario.own_sensors import replaced_methods
from ratt_opt.scenario.problem_record import Link, ProblemRecord, near_pairs
from ratt_opt.scenario.record import NonNegative, Number, Positive, Record, Text, Whole, without_defaults
from ratt_opt.scenario.sensor import Sensor
from ratt_opt.scenario.sensors.kinds import AnySensor, kind_of
from ratt_opt.scenario.sensors.model import SensorModel
from ratt_opt.setfunctions.criteria.registry import WITH_OUTPUT, get_criterion

if TYPE_CHECKING:
    import networkx as nx

    from ratt_opt._validation import FloatArray, IntArray
    from ratt_opt.setfunctions.information import InformationObjective

__all__ = ["DEFAULT_CONTROLS", "STATE_UNITS", "Robot", "Scenario", "Target"]

DEFAULT_CONTROLS = tuple((speed, turn) for speed in (1.0, -1.0, 3.0, -3.0) for turn in (0.0, 1.0, 3.0))
"""{1, -1, 3, -3} m/s x {0, 1, 3} rad/s. Source: ratt.tex, Section VI, common parameters."""


STATE_UNITS = ("m", "m", "m/s", "m/s", "m", "m/s")
"""Units of a target's state: x, y, velocity in x and y, height, climb rate."""


Control = Annotated[tuple[Number, ...], Field(min_length=2, max_length=4)]


class Robot(Record):
    """A robot: pose now, and the finite set of controls it can execute.

    ``x``, ``y`` [m], ``heading`` [rad], ``z`` : height [m]; ``sensor`` : its own sensor, or ``None`` for the team's.
    ``motion`` : ``"unicycle"``, whose ``controls`` are (speed [m/s], turn rate [rad/s]) pairs, or ``"holonomic"``:
    velocity forward and to the left [m/s], and if wanted turn rate [rad/s] and climb rate [m/s].
    """

    x: Number
    y: Number
    heading: Number = 0.0
    controls: Annotated[tuple[Control, ...], Field(min_length=1)] = DEFAULT_CONTROLS
    sensor: Annotated[Sensor | SensorModel, AnySensor] | None = None
    name: Text = ""
    z: Number = 0.0
    motion: Literal["unicycle", "holonomic"] = "unicycle"

    @model_serializer(mode="wrap")
    def _as_before(self, whole: SerializerFunctionWrapHandler) -> dict[str, Any]:
        return without_defaults(self, whole(self), ("z", "motion"))

    @model_validator(mode="after")
    def _check_controls(self) -> Self:
        lengths = {len(control) for control in self.controls}
        if len(lengths) > 1 or (self.motion == "unicycle" and lengths != {2}):
            rule = "must be pairs of a unicycle, and of one length of 2 to 4 of a holonomic robot"
            raise InputError("controls", rule, f"lengths {sorted(lengths)}")
        return self


class Target(Record):
    """A target: what is believed about it now, and how it moves.

    ``x``, ``y``, ``z`` : estimated position and height [m]; ``speed`` [m/s], ``turn_rate`` [rad/s], ``heading`` [rad],
    ``climb`` [m/s] : its motion. ``covariance`` : 2 x 2 of the position [m^2], 4 x 4 of position and velocity in x and
    y, or 6 x 6 with height and climb rate behind them; symmetric positive definite. ``velocity_std`` : standard
    deviation per axis of the velocity [m/s], if the covariance does not say; ``None`` for the motion's default.
    ``process_noise`` : intensity of the motion noise per root second, whatever the sampling period: of a known velocity
    the position's [m/s^0.5], of an estimated velocity the acceleration's [m/s^1.5]. Without it, ``process_std`` :
    standard deviation per axis of the motion noise in one sampling period [m]. ``weight`` : importance.

    The paper leaves covariance and noise open. Defaults: 3 m and 0.5 m standard deviation, a target
    known to within a few of the robots' steps.
    """

    x: Number
    y: Number
    covariance: tuple[tuple[Number, ...], ...] = ((9.0, 0.0), (0.0, 9.0))
    speed: Number = 0.0
    turn_rate: Number = 0.0
    heading: Number = 0.0
    process_std: NonNegative = 0.5
    weight: Positive = 1.0
    name: Text = ""
    z: Number = 0.0
    climb: Number = 0.0
    velocity_std: Positive | None = None
    process_noise: NonNegative | None = None

    @model_serializer(mode="wrap")
    def _as_before(self, whole: SerializerFunctionWrapHandler) -> dict[str, Any]:
        return without_defaults(self, whole(self), ("z", "climb", "velocity_std", "process_noise"))

    @model_validator(mode="after")
    def _check_covariance(self) -> Self:
        size = len(self.covariance)
        if size not in {2, 4, 6} or any(len(row) != size for row in self.covariance):
            raise InputError("covariance", "must be 2 x 2, 4 x 4 or 6 x 6", [len(row) for row in self.covariance])
        if self.covariance != tuple(zip(*self.covariance, strict=True)):
            raise InputError("covariance", "must be symmetric", self.covariance)
        (a, b, *_), (_, d, *_) = self.covariance[:2]
        if not (a > 0 and a * d - b * b > 0 and (size == 2 or np.linalg.eigvalsh(self.covariance)[0] > 0)):
            raise InputError("covariance", "must be positive definite", self.covariance)
        return self

    def state_covariance(self, size: int, velocity_std: float = 1.0) -> FloatArray:
        """(size, size) covariance of the first numbers of the state; ``velocity_std`` [m/s] if nothing says.

        A height that nothing is said of is taken to be as uncertain as x.
        """
        known = min(len(self.covariance), size)
        std = velocity_std if self.velocity_std is None else self.velocity_std
        whole = np.diag([self.covariance[0][0] if unit == "m" else std**2 for unit in STATE_UNITS])[:size, :size]
        whole[:known, :known] = np.array(self.covariance)[:known, :known]
        return whole


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
        self._check_sizes(sum(len(robot.controls) for robot in self.robots), self.reads)
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
        """(E, c) control of each element, as its robot's motion reads it; shorter ones have zeros behind."""
        width = max(len(robot.controls[0]) for robot in self.robots)
        controls = [control for robot in self.robots for control in robot.controls]
        return readonly(np.array([(*control, *(0.0,) * (width - len(control))) for control in controls]))

    @cached_property
    def poses(self) -> FloatArray:
        """(N, 3) poses now: x [m], y [m], heading [rad]; (N, 4) with the height [m] if a robot has one or can climb."""
        poses = np.array([(robot.x, robot.y, robot.heading, robot.z) for robot in self.robots])
        flat = not poses[:, 3].any() and all(len(robot.controls[0]) < 4 for robot in self.robots)
        return readonly(poses[:, :3] if flat else poses)

    @cached_property
    def predicted_poses(self) -> FloatArray:
        """(E, 3 or 4) pose of the owner after each element's control."""
        poses, controls = self.poses[self.robot], self.controls
        flying = np.array([robot.motion == "holonomic" for robot in self.robots])[self.robot]
        after = move_robots(poses, controls, self.sampling_period)
        after[flying] = fly_robots(poses[flying], controls[flying], self.sampling_period)
        return readonly(after)

    @cached_property
    def predicted_targets(self) -> FloatArray:
        """(M, 2) predicted mean positions [m]; the sensor model is linearised there."""
        positions = np.array([(target.x, target.y) for target in self.targets])
        motions = np.array([(target.speed, target.turn_rate, target.heading) for target in self.targets])
        return readonly(predict_targets(positions, motions, self.sampling_period))

    @property
    def reads(self) -> int:
        """Numbers r of a target's state that some sensor's measurement depends on: 2, or 4 with velocities, or 6."""
        sensors = (robot.sensor or self.sensor for robot in self.robots)
        return max(getattr(sensor, "reads", 2) for sensor in sensors)

    @cached_property
    def step_noise_std(self) -> FloatArray:
        """(M,) standard deviation per axis of the motion noise of a known velocity in a sampling period [m]."""
        root = self.sampling_period**0.5
        stds = [t.process_std if t.process_noise is None else t.process_noise * root for t in self.targets]
        return readonly(np.array(stds))

    @cached_property
    def acceleration_density(self) -> FloatArray:
        """(M,) spectral density of the acceleration of targets whose velocity is estimated [m^2/s^3].

        Without ``process_noise`` that by which ``process_std`` is the position's standard deviation after one period.
        """
        cube = self.sampling_period**3
        pairs = [(t.process_std, t.process_noise) for t in self.targets]
        return readonly(np.array([3 * std**2 / cube if noise is None else noise**2 for std, noise in pairs]))

    @cached_property
    def predicted_states(self) -> FloatArray:
        """(M, r) predicted means of what is read of the states, positions first."""
        turned = [target.heading + self.sampling_period * target.turn_rate for target in self.targets]
        velocity = [(t.speed * np.cos(a), t.speed * np.sin(a)) for t, a in zip(self.targets, turned, strict=True)]
        upward = [(target.z + self.sampling_period * target.climb, target.climb) for target in self.targets]
        states = np.concatenate([self.predicted_targets, np.array(velocity), np.array(upward)], axis=1)
        return readonly(states[:, : self.reads])

    @cached_property
    def prior(self) -> FloatArray:
        """(M, r, r) predicted covariances (EKF prediction) of what sensors read of the states: ``P + Q`` of positions.

        If a sensor reads velocities, they are estimated, too: ``F P F' + Q`` of a constant velocity.
        """
        r = self.reads
        known = np.array([target.state_covariance(r) for target in self.targets])
        if r == 2:
            return readonly(known + (self.step_noise_std**2)[:, None, None] * np.eye(2))
        step, noise = np.eye(6), np.zeros((self.n_targets, 6, 6))
        step[[0, 1, 4], [2, 3, 5]] = self.sampling_period
        noise[:, :4, :4] = planar = white_acceleration(self.acceleration_density, self.sampling_period)
        noise[:, 4:, 4:] = planar[:, ::2, ::2]
        moved = step[:r, :r] @ known @ step[:r, :r].T
        return readonly((moved + np.swapaxes(moved, -1, -2)) / 2 + noise[:, :r, :r])

    @cached_property
    def information(self) -> FloatArray:
        """(E, M, r, r) information ``H^T R^{-1} H`` of each element about what is read of each target's state."""
        information = np.zeros((len(self.robot), self.n_targets, self.reads, self.reads))
        for i, robot in enumerate(self.robots):
            own, sensor = self.robot == i, robot.sensor or self.sensor
            r = getattr(sensor, "reads", 2)
            information[own, :, :r, :r] = sensor.information(self.predicted_poses[own], self.predicted_states[:, :r])
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
        return self.control_labels(self.robot, self.controls)

    def control_labels(self, owner: IntArray, controls: FloatArray) -> tuple[str, ...]:
        """(E,) controls (E, c) of their robots ``owner`` (E,) in words."""
        return tuple(
            _label(self.robots[i].motion, control) for i, control in zip(owner, controls.tolist(), strict=True)
        )

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
        """Return the same one-step problem as matrices; files hold a sensor class of your own this way."""
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
            output=None if self._output is None else nested(self._output),
            units=STATE_UNITS[: self.reads],
            element_headings=nested(self.predicted_poses[:, 2]),
            element_controls=nested(self.controls) if self.controls.shape[1] == 2 else None,
        )

    @property
    def _owners(self) -> IntArray:
        return self.robot

    @property
    def _places(self) -> FloatArray:
        return self.poses

    @property
    def _output(self) -> FloatArray | None:
        return None if self.reads == 2 else np.eye(2, self.reads)

    def _criterion(self, objective: str) -> InformationObjective:
        """The criterion of positions; the log-det's of all that is read, whose gains do not depend on units."""
        if objective in WITH_OUTPUT:
            return super()._criterion(objective)
        return get_criterion(objective)(*self._matrices)

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
            if (
                error.argument == "alpha_c"
                and self.communication_range is not None
                and not near_pairs(self.poses, self.communication_range)
            ):
                rule = f"{error.rule}, as no two robots are within {self.communication_range:g} m (communication_range)"
                raise InputError(error.argument, rule, error.value) from None
            raise

    def _check_ranges(self) -> None:
        apart = np.linalg.norm(self.predicted_poses[:, None, :2] - self.predicted_targets[None], axis=-1)
        on_top = apart < 1e-9  # [m]; the bearing has no derivative there
        if on_top.any():
            e, j = (int(k) for k in np.argwhere(on_top)[0])
            rule = f"must not end on top of target {j}'s predicted position (range 0 has no bearing)"
            raise InputError(
                f"robots[{self.robot[e]}] with control {self.element_labels[e]}",
                rule,
                tuple(self.predicted_targets[j].tolist()),
            )


def _label(motion: str, control: list[float]) -> str:
    """A control in words."""
    if motion == "unicycle":
        return f"{control[0]:g} m/s, {control[1]:.4g} rad/s"
    forward, left, turn, climb = (*control, 0.0, 0.0)[:4]
    words = [f"{forward:g} m/s forward", f"{left:g} m/s left"]
    words += [f"{turn:.4g} rad/s"] if turn else []
    return ", ".join([*words, f"{climb:g} m/s up"] if climb else words)


def _unnamed(sensor: Sensor | SensorModel) -> str:
    """Describe a sensor that no file can name; empty if one can."""
    if type(sensor) is Sensor or kind_of(sensor):
        return ""
    if isinstance(sensor, SensorModel):
        return f"{type(sensor).__name__}, which is not registered"
    own = replaced_methods(sensor)
    return f"{type(sensor).__name__} with its own {', '.join(own)}" if own else ""
