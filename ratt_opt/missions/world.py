"""World of one step of a mission: motions, sensors, and the max-min problem that follows from them."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Literal, get_args

import networkx as nx
import numpy as np

from ratt_opt._validation import FloatArray, IntArray, check_integer, readonly
from ratt_opt.errors import InputError
from ratt_opt.graph.communication import CommunicationGraph
from ratt_opt.missions.ahead.horizon import (
    OUTPUTS,
    Sequences,
    control_sequences,
    joint_covariance,
    output_matrix,
)
from ratt_opt.missions.models.robots import RobotMotion, TeamMotion, check_robot_motion
from ratt_opt.missions.models.sensors import check_sensor, robots_by_sensor, sensors_of
from ratt_opt.missions.models.targets import TargetMotion, check_motion, target_motion
from ratt_opt.missions.params import MissionParams
from ratt_opt.problem import Attack, Problem
from ratt_opt.scenario.model import Scenario
from ratt_opt.setfunctions.checked_matrices import WIDEST
from ratt_opt.setfunctions.criteria.registry import WITH_OUTPUT, get_criterion
from ratt_opt.solvers.undominated import undominated_elements

if TYPE_CHECKING:
    from collections.abc import Sequence

    from ratt_opt.missions.belief import Belief
    from ratt_opt.scenario.sensor import Sensor
    from ratt_opt.scenario.sensors.model import SensorModel
    from ratt_opt.setfunctions.information import InformationObjective

__all__ = ["Linearisation", "MissionModel", "Threatened", "World"]

Linearisation = Literal["first order", "second order", "iterated"]


@dataclass(frozen=True, slots=True, kw_only=True)
class MissionModel:
    """Model of a mission: motions and sensors of its targets and robots, and the criterion of its plans.

    Parameters
    ----------
    motion : of the targets: ``"known velocity"`` (the paper's), ``"constant velocity"``, ``"coordinated turn"``, or a
        :class:`TargetMotion`
    sensor : ``None`` for the scenario's sensors; ``"range and bearing"``, ``"range"`` or ``"bearing"``, a part of what
        its range-and-bearing sensors measure; a registered kind of sensor; or a :class:`Sensor` or
        :class:`SensorModel` for all robots, or one for each
    robot_motion : of unicycles ``"paper"``, or ``"arc"`` for headings that turn during the step; ``"holonomic"`` for
        all robots, or a :class:`RobotMotion`
    linearisation : ``"second order"`` adds the second-order term to the noise of plans and filter; ``"first order"``
        is the textbook EKF, which leaves it out and is overconfident; ``"iterated"`` also linearises again at the
        estimate
    objective : criterion of a plan; the log-det only if a plan looks one step ahead
    output : of joint states, what counts: ``"mean"`` over the steps, or ``"last"``. The max-eigenvalue's mean is the
        worst axis of the errors of all steps together, over their number
    area : x and y of two corners [m] that robots do not leave, or ``None``. Controls that end outside are not offered;
        a robot that has no other keeps the one that ends nearest to it.
    beam : number of control sequences of each robot to plan with, those worth most alone; ``None`` for all
    params : numbers of the filter, of plans and of the clock
    """

    motion: str | TargetMotion = "known velocity"
    sensor: str | Sensor | SensorModel | Sequence[Sensor | SensorModel] | None = None
    robot_motion: str | RobotMotion = "paper"
    linearisation: Linearisation = "second order"
    objective: str = "trace"
    output: Literal["mean", "last"] = "mean"
    area: tuple[float, float, float, float] | None = None
    beam: int | None = None
    params: MissionParams = field(default_factory=MissionParams, repr=False)  # a journal states those that are changed

    def __post_init__(self) -> None:
        for name, known in (("linearisation", get_args(Linearisation)), ("output", OUTPUTS)):
            if getattr(self, name) not in known:
                raise InputError(name, f"must be {', '.join(known)}", getattr(self, name))
        get_criterion(self.objective)
        check_sensor(self.sensor)
        if not isinstance(self.motion, TargetMotion):
            check_motion(self.motion)
        check_robot_motion(self.robot_motion)
        if self.area is not None and not _is_rectangle(self.area):
            raise InputError("area", "must be x and y of its lower left and upper right corner", self.area)
        if self.beam is not None:
            check_integer("beam", self.beam, low=1)
        if not isinstance(self.params, MissionParams):
            raise InputError("params", "must be MissionParams", type(self.params).__name__)


def _beside(prior: FloatArray, information: FloatArray) -> FloatArray:
    """The information (E, M, d, d), scaled down if a prior (M, d, d) would lose its digits beside it.

    If nothing is known of a target yet, a sighting that is worth 1e14 times as much leaves it as well known as one
    that is worth more: the value changes in its last digits.
    """
    sizes = np.trace(information, axis1=-2, axis2=-1) * np.trace(prior, axis1=-2, axis2=-1)  # at least the largest axes
    if sizes.max() <= WIDEST / 2:
        return information
    return np.asarray(information * np.minimum(1.0, WIDEST / 2 / np.maximum(sizes, 1.0))[..., None, None])


def _is_rectangle(area: object) -> bool:
    corners = np.array(area) if isinstance(area, (tuple, list, np.ndarray)) else np.zeros(0)
    return corners.shape == (4,) and corners.dtype.kind in "iuf" and bool((corners[:2] < corners[2:]).all())


@dataclass(frozen=True, slots=True)
class Threatened:
    """Known failures when a plan is made, and the budgets that may still strike."""

    standing: Attack
    alpha_s: int
    alpha_c: int


@dataclass(frozen=True, slots=True, eq=False)
class World:
    """A scenario with the models of a mission."""

    scenario: Scenario
    model: MissionModel
    horizon: int
    motion: TargetMotion = field(init=False)
    sensors: tuple[SensorModel, ...] = field(init=False)
    move: TeamMotion = field(init=False)
    alike: tuple[tuple[SensorModel, IntArray], ...] = field(init=False)
    """Every different sensor with the robots that have it: what they measure is worked out together."""

    def __post_init__(self) -> None:
        if not isinstance(self.scenario, Scenario):
            raise InputError(
                "scenario", "must be a Scenario: missions need robots that move", type(self.scenario).__name__
            )
        if not isinstance(self.model, MissionModel):
            raise InputError("model", "must be a MissionModel", type(self.model).__name__)
        check_integer("horizon", self.horizon, low=1)
        object.__setattr__(self, "motion", target_motion(self.model.motion, self.scenario))
        object.__setattr__(self, "sensors", sensors_of(self.scenario, self.model.sensor))
        object.__setattr__(self, "alike", robots_by_sensor(self.sensors))
        object.__setattr__(self, "move", TeamMotion.of(self.scenario, self.model.robot_motion))
        if self.model.objective not in WITH_OUTPUT and self.horizon > 1:
            rule = f"must be {' or '.join(WITH_OUTPUT)} if a plan looks several steps ahead"
            raise InputError("objective", rule, self.model.objective)
        if self.reads > self.motion.dimension:
            rule = f"must have states of {self.reads} numbers, as a sensor reads (such as 'constant velocity')"
            raise InputError("motion", rule, f"{self.motion.dimension} of {type(self.motion).__name__}")

    @property
    def period(self) -> float:
        """Sampling period [s]."""
        return self.scenario.sampling_period

    @property
    def on_time(self) -> float:
        """Seconds within which two times count as one."""
        return self.model.params.on_time * self.period

    @property
    def reads(self) -> int:
        """Numbers r of a target's state that some sensor's measurement depends on."""
        return max(sensor.reads for sensor in self.sensors)

    def sequences(self, poses: FloatArray) -> Sequences:
        """The elements of a plan from poses (N, p), those that leave the area left out."""
        offered = control_sequences(self.scenario, poses, self.horizon, self.move, self.model.params.sequences)
        if self.model.area is None:
            return offered
        low, high = np.array(self.model.area[:2]), np.array(self.model.area[2:])
        places = offered.poses[..., :2]
        outside = np.maximum(np.maximum(low - places, places - high), 0.0).sum(axis=(1, 2))
        nearest = np.array([outside[offered.owner == i].min() for i in range(self.scenario.n_robots)])
        return offered.only(outside <= nearest[offered.owner])

    def objective(self, belief: Belief, sequences: Sequences, time: float) -> tuple[InformationObjective, Sequences]:
        """The criterion of all sequences that are not dominated, and these; a single step keeps them all."""
        if self.horizon > 1 and self.reads == 2:
            blocks = self._blocks(sequences, self._predictions(belief, time))
            kept = undominated_elements(blocks.reshape(len(blocks), -1, 2, 2), sequences.owner)
            sequences = sequences.only(kept)
        return self.criterion(belief, sequences, time), sequences

    def criterion(self, belief: Belief, sequences: Sequences, time: float) -> InformationObjective:
        """The criterion of these sequences: of the part of the state in all steps that measurements depend on.

        A Gaussian's marginal is updated by what is measured of it alone, so velocities need not be carried along unless
        a sensor reads them; then only positions count, but to the log-det, which takes all that is read.
        """
        predicted = self._predictions(belief, time)
        blocks = self._blocks(sequences, predicted)
        r = self.reads
        information = np.zeros((*blocks.shape[:2], r * self.horizon, r * self.horizon))
        for h in range(self.horizon):
            information[:, :, r * h : r * h + r, r * h : r * h + r] = blocks[:, :, h]
        prior = joint_covariance(predicted, self.motion, self.period, r, self.model.params.noise_floor)
        information = _beside(prior, information)
        weights = np.array([target.weight for target in self.scenario.targets])
        output = output_matrix(self.model.output, self.horizon, r)
        if output is None or self.model.objective not in WITH_OUTPUT:
            return get_criterion(self.model.objective)(prior, information, weights)
        return WITH_OUTPUT[self.model.objective](prior, information, weights, output=output)

    def communication(self, poses: FloatArray, standing: Attack) -> CommunicationGraph:
        """The links of robots at poses (N, 3) that have not failed."""
        graph = self._graph(poses, standing)
        n_robots = self.scenario.n_robots
        if graph is None:
            return CommunicationGraph.complete(n_robots)
        return CommunicationGraph.from_networkx(graph, n_robots)

    def problem(
        self,
        objective: InformationObjective,
        owner: IntArray,
        poses: FloatArray,
        threatened: Threatened,
    ) -> Problem:
        """The max-min problem of the whole team, without what has failed."""
        blind = np.isin(owner, sorted(threatened.standing.sensing))
        if blind.any():
            information = np.where(blind[:, None, None, None], 0.0, objective.information)
            objective = objective.with_information(information)
        team, graph = self.scenario, self._graph(poses, threatened.standing)
        n_links = team.n_robots * (team.n_robots - 1) // 2 if graph is None else graph.number_of_edges()
        safe = frozenset(link for link in team.protected_links if graph is None or graph.has_edge(*link))
        return Problem(
            objective,
            owner,
            graph,
            min(threatened.alpha_s, team.n_robots),
            min(threatened.alpha_c, n_links),
            frozenset(team.protected_robots),
            safe,
        )

    def _graph(self, poses: FloatArray, standing: Attack) -> nx.Graph | None:
        graph = self.scenario.graph_at(poses)
        if standing.links:
            graph = nx.complete_graph(self.scenario.n_robots) if graph is None else graph
            graph.remove_edges_from(standing.links)
        return graph

    def _predictions(self, belief: Belief, time: float) -> list[Belief]:
        """Predict the belief 1, ..., H steps ahead without a measurement."""
        beliefs: list[Belief] = []
        for h in range(self.horizon):
            belief = belief.predicted(self.motion, self.period, time + h * self.period)
            beliefs.append(belief)
        return beliefs

    def _blocks(self, sequences: Sequences, predicted: list[Belief]) -> FloatArray:
        """(E, M, H, r, r) information about what is read of the states, step by step."""
        steps = [self._information(sequences, h, ahead) for h, ahead in enumerate(predicted)]
        return np.stack(steps, axis=2)

    def _information(self, sequences: Sequences, h: int, ahead: Belief) -> FloatArray:
        """(E, M, r, r) of the h-th step."""
        information = np.zeros((len(sequences.owner), len(ahead.mean), self.reads, self.reads))
        for sensor, robots in self.alike:
            own, r = np.isin(sequences.owner, robots), sensor.reads
            spread = None if self.model.linearisation == "first order" else ahead.covariance[:, :r, :r]
            with np.errstate(divide="ignore", invalid="ignore"):  # on top of a target there is no bearing
                information[own, :, :r, :r] = sensor.information(sequences.poses[own, h], ahead.mean[:, :r], spread)
        usable = np.asarray(np.isfinite(information).all(axis=(-1, -2)))
        return readonly(np.where(usable[..., None, None], information, 0.0))
