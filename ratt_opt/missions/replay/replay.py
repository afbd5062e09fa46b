"""The MRCLAM dataset replayed: real poses and measurements, cameras that are planned, blinded and cut off."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from ratt_opt._validation import FloatArray, IntArray, check_integer, check_number, readonly
from ratt_opt._values import ByValue
from ratt_opt.errors import InputError
from ratt_opt.missions.belief import Belief
from ratt_opt.missions.memory import Memory, Pieces
from ratt_opt.missions.planning import capped
from ratt_opt.missions.players.attack_models import AttackModel, attack_model
from ratt_opt.missions.players.attackers import attack_of, get_attacker
from ratt_opt.missions.players.planners import elements_of, get_planner
from ratt_opt.missions.replay.fit_sensor import FittedSensor, fit_sensor
from ratt_opt.missions.sensing import Reading, group_pieces
from ratt_opt.missions.world import MissionModel, Threatened, World
from ratt_opt.problem import Attack, Problem
from ratt_opt.scenario.mrclam import MRCLAM_SENSOR, from_mrclam
from ratt_opt.scenario.mrclam_labels import pose_at
from ratt_opt.scenario.mrclam_reader import opened_mrclam
from ratt_opt.scenario.record import LARGEST
from ratt_opt.setfunctions.criteria.trace import TraceObjective

if TYPE_CHECKING:
    from collections.abc import Mapping
    from pathlib import Path

    from ratt_opt.missions.players.attackers import Attacker, OwnAttacker
    from ratt_opt.missions.players.planners import Planner
    from ratt_opt.scenario.mrclam_reader import MrclamData

__all__ = ["Replay", "ReplaySettings", "ReplayStep", "replay_mrclam"]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class ReplayStep(ByValue):
    """One step: robots whose cameras are ``running``, the ``attack``, the team's ``belief`` after it.

    ``group`` : its robots; ``errors`` : (M, 2) [m]; ``used``, ``gated`` : measurements taken in, and refused as
    outliers, by that group.
    """

    running: frozenset[int]
    attack: Attack
    group: frozenset[int]
    belief: Belief
    errors: FloatArray
    used: int
    gated: int


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class Replay(ByValue):
    """A replayed mission; ``sensor`` as fitted; ``labels`` : which labelling of the landmarks, and who decided that."""

    sensor: FittedSensor
    steps: tuple[ReplayStep, ...]
    labels: str = ""

    def __repr__(self) -> str:
        ends = f"RMSE {self.rmse[-1]:.3g} m at the end, NEES {self.nees[-1]:.3g} of 2"
        return f"Replay({len(self.steps)} steps, {ends}; {self.labels})"

    @property
    def rmse(self) -> FloatArray:
        """(T,) root of the mean squared error over the landmarks [m]."""
        return readonly(np.array([np.sqrt((step.errors**2).sum(axis=1).mean()) for step in self.steps]))

    @property
    def nees(self) -> FloatArray:
        """(T,) mean over the landmarks; 2 if the filter is consistent."""
        return readonly(np.array([step.belief.nees(step.belief.mean - step.errors).mean() for step in self.steps]))

    @property
    def log_score(self) -> FloatArray:
        """(T,) log density that the beliefs gave to where the landmarks are, mean over them; beliefs that claim too
        much and beliefs that claim too little both score less than honest ones."""
        sizes = [np.linalg.slogdet(2 * np.pi * step.belief.covariance)[1].mean() for step in self.steps]
        return readonly(-(self.nees + np.array(sizes)) / 2)


@dataclass(frozen=True, slots=True, kw_only=True)
class ReplaySettings:
    """Settings of a replay.

    ``start`` : seconds since all poses have begun; ``period`` : of a step [s], in which every running camera gives its
    last sighting of each landmark (successive ones have correlated errors); ``cameras`` : how many may run;
    ``prior_std`` : standard deviation of the first beliefs about the landmarks [m]; ``drift_std`` : assumed standard
    deviation of the landmarks' motion in a step [m], so that the filter does not trust errors that do not average out;
    ``seed`` : of the first beliefs and of random players.
    """

    start: float = 60.0
    period: float = 5.0
    cameras: int = 3
    alpha_s: int = 1
    alpha_c: int = 2
    prior_std: float = 0.5
    drift_std: float = 0.0
    seed: int = 0

    def __post_init__(self) -> None:
        for name in ("start", "period", "prior_std", "drift_std"):
            if check_number(name, getattr(self, name), low=0.0) > LARGEST:
                raise InputError(name, f"must be at most {LARGEST:g}", getattr(self, name))
        for name in ("cameras", "seed"):
            check_integer(name, getattr(self, name), low=0)


def replay_mrclam(
    directory: str | Path | MrclamData,
    *,
    steps: int,
    planner: str | Planner = "ratt",
    attacker: str | OwnAttacker = "worst",
    attacks: str | AttackModel = "renewed",
    sensor: FittedSensor | None = None,
    settings: ReplaySettings | None = None,
    corrections: Mapping[int, int] | None = None,
) -> Replay:
    """Track the landmarks with the dataset's own measurements, under attack.

    Each group keeps its own belief; they are merged without double counting when links return. The team is the group
    with the smallest uncertainty.

    Parameters
    ----------
    directory : dataset folder, see :func:`read_mrclam`, or the dataset
    steps : T >= 1
    planner : of the cameras, as in :func:`run_mission`, but none that sees the world; a camera that does not run is an
        idle robot of ``Problem(at_most=cameras)``
    attacker, attacks : as in :func:`run_mission`
    sensor : noise law and gate; by default fitted to all sightings of the dataset
    settings : when, how many cameras, which budgets
    corrections : of a folder's labels, see :func:`read_mrclam`; by default the sightings decide, and ``labels`` of the
        result says what

    Raises
    ------
    FileFormatError : a file is missing or malformed.
    InputError : an argument breaks its rule, or the poses end before the replay does.
    """
    s = ReplaySettings() if settings is None else settings
    if not isinstance(s, ReplaySettings):
        raise InputError("settings", "must be a ReplaySettings", type(s).__name__)
    if sensor is not None and not isinstance(sensor, FittedSensor):
        raise InputError("sensor", "must be a FittedSensor, as fit_sensor returns", type(sensor).__name__)
    check_integer("steps", steps, low=1)
    data = opened_mrclam(directory, corrections)
    check_integer("cameras", s.cameras, low=0, high=len(data.poses))
    flight = _Replay(data, s, sensor)
    if steps > float(min(poses[-1, 0] for poses in data.poses) - flight.begin) / s.period:
        raise InputError("steps", "must end before the poses do", steps)
    plan, attack, model = get_planner(planner), get_attacker(attacker), attack_model(attacks)
    for step in range(steps):
        problem = flight.problem(step, model)
        running = elements_of(plan(problem), problem)
        flight.attacked(step, problem, running, (attack, model))
        flight.measure(step, running)
    return Replay(sensor=flight.sensor, steps=tuple(flight.steps), labels=data.labels)


class _Replay:
    """The state of a replay under way."""

    def __init__(self, data: MrclamData, settings: ReplaySettings, sensor: FittedSensor | None) -> None:
        self.data, self.settings = data, settings
        self.begin = max(poses[0, 0] for poses in data.poses) + settings.start
        fitted = fit_sensor(data) if sensor is None else sensor
        reach = {"max_range": MRCLAM_SENSOR.max_range, "field_of_view": MRCLAM_SENSOR.field_of_view}
        self.sensor: FittedSensor = fitted.replace(**reach)
        scenario = from_mrclam(
            data,
            settings.start,
            alpha_s=settings.alpha_s,
            alpha_c=settings.alpha_c,
            sensor=self.sensor,
            prior_std=max(settings.prior_std, 1e-3),
            sampling_period=settings.period,
        )
        drifting = tuple(target.replace(process_std=settings.drift_std) for target in scenario.targets)
        self.world = World(scenario.replace(targets=drifting), MissionModel(linearisation="second order"), 1)
        self.truth = np.array([(target.x, target.y) for target in scenario.targets])
        self.subjects = sorted(data.landmarks)
        shift = np.random.default_rng(settings.seed).standard_normal(self.truth.shape) * settings.prior_std
        belief = self.world.motion.initial(scenario)
        belief = Belief.of(belief.mean + shift, belief.covariance)
        self.memory = Memory.start(self.world.motion, settings.period, belief, scenario.n_robots)
        self.attack, self.threatened = Attack(), Threatened(Attack(), settings.alpha_s, settings.alpha_c)
        self.steps: list[ReplayStep] = []

    def problem(self, step: int, model: AttackModel) -> Problem:
        """Every robot's camera off (its first element) or on, from where it is now, with the best belief there is."""
        scenario = self.world.scenario
        self.threatened = model.threatened(step, self.attack, scenario)
        poses = self._poses(self.begin + step * self.settings.period)
        groups = self.world.communication(poses, self.threatened.standing).groups()
        self.memory = self.memory.shared(groups)
        knowing = min((self.memory.belief(min(group)) for group in groups), key=lambda belief: belief.trace)
        ahead = knowing.predicted(self.world.motion, self.settings.period, step * self.settings.period)
        information = np.zeros((2 * scenario.n_robots, *ahead.covariance.shape))
        for i, sensor in enumerate(self.world.sensors):
            information[2 * i + 1] = sensor.information(poses[i : i + 1], ahead.positions, ahead.position_covariance)[0]
        objective = TraceObjective(ahead.covariance, information)
        owner = np.repeat(np.arange(scenario.n_robots), 2)
        whole = self.world.problem(objective, owner, poses, self.threatened)
        return replace(whole, at_most=self.settings.cameras)

    def attacked(self, step: int, problem: Problem, plan: IntArray, players: tuple[Attacker, AttackModel]) -> None:
        """Combine the failures in force with the attacker's new ones."""
        attacker, model = players
        rng = np.random.default_rng([self.settings.seed, step])
        sensors, links = model.strikes(self.threatened, len(problem.communication.links), rng)
        standing = self.threatened.standing
        limited = capped(problem, sensors, links)
        found = attacker(limited, plan, self.settings.seed + step) if sensors or links else Attack()
        new = attack_of(found, limited)
        self.attack = Attack(standing.sensing | new.sensing, standing.links | new.links)

    def measure(self, step: int, plan: IntArray) -> None:
        """Groups take in what their running cameras saw in this step."""
        n_robots = self.world.scenario.n_robots
        end = self.begin + (step + 1) * self.settings.period
        poses = self._poses(end)
        groups = sorted(self.world.communication(poses, self.attack).groups(), key=min)
        running = frozenset(int(i) for i in np.flatnonzero(plan % 2))
        whole, made = Pieces.none(n_robots, self.memory.base), np.zeros(n_robots, dtype=np.bool_)
        counts = []
        for group in groups:
            see = sorted((group & running) - self.attack.sensing)
            belief = self.memory.belief(min(group))
            ahead = belief.predicted(self.world.motion, self.settings.period, step * self.settings.period)
            readings = {i: self._sightings(i, end) for i in see}
            seen = sum(int(reading.seen.sum()) for reading, _ in readings.values())
            usable = {i: self._gated(i, reading, at, ahead) for i, (reading, at) in readings.items()}
            paths = {i: at for i, (_, at) in readings.items()}
            pieces, innovation = group_pieces(self.world, ahead, paths, usable, see)
            whole.information[see], whole.vector[see] = pieces.information[see], pieces.vector[see]
            made[see] = True
            used = innovation.count // 2
            counts.append((used, seen - sum(int(reading.seen.sum()) for reading in usable.values())))
        self.memory = self.memory.advanced(whole, made).shared(groups)
        beliefs = [self.memory.belief(min(group)) for group in groups]
        best = int(np.argmin([belief.trace for belief in beliefs]))
        record = ReplayStep(
            running=running,
            attack=self.attack,
            group=groups[best],
            belief=beliefs[best],
            errors=readonly(beliefs[best].mean - self.truth),
            used=counts[best][0],
            gated=counts[best][1],
        )
        self.steps.append(record)

    def _poses(self, time: float) -> FloatArray:
        return np.concatenate([pose_at(poses, np.array([time])) for poses in self.data.poses])

    def _sightings(self, robot: int, end: float) -> tuple[Reading, FloatArray]:
        """The last sighting of each landmark in the step that ends then, and the poses (M, 3) they were made from."""
        rows = self.data.measurements[robot]
        rows = rows[(rows[:, 0] > end - self.settings.period) & (rows[:, 0] <= end)]
        values, seen = np.zeros((len(self.subjects), 2)), np.zeros(len(self.subjects), dtype=np.bool_)
        times = np.full(len(self.subjects), end)
        for time, code, distance, bearing in rows:
            subject = self.data.subject_of.get(int(code), -1)
            if subject in self.data.landmarks:
                j = self.subjects.index(subject)
                values[j], seen[j], times[j] = (distance, bearing), True, time
        return Reading(values, seen), pose_at(self.data.poses[robot], times)

    def _gated(self, robot: int, reading: Reading, at: FloatArray, ahead: Belief) -> Reading:
        """The reading without what is more likely an outlier, seen from what is believed."""
        sensor = self.world.sensors[robot]
        slope = sensor.jacobian(at, ahead.positions)
        spread = slope @ ahead.position_covariance @ np.swapaxes(slope, -1, -2)
        spread = spread + sensor.noise_covariance(at, ahead.positions, ahead.position_covariance)
        surprise = sensor.surprise(reading.values, sensor.measure(at, ahead.positions))
        squared = np.einsum("mi,mij,mj->m", surprise, np.linalg.inv(spread), surprise)
        return Reading(reading.values, reading.seen & (squared <= self.sensor.gate))
