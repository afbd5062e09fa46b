"""The loop inside a real system: measurements in, the next plan out, within a time limit; the state is plain data.

The plan after a step is for the next one. Everything that the next step needs is in :class:`TrackerState`, which
pickles and becomes JSON and back without losing a bit: a robot may die, and another go on from its state.
"""

from __future__ import annotations

import logging
from collections.abc import Iterable
from dataclasses import dataclass, replace
from time import monotonic
from typing import TYPE_CHECKING

import numpy as np

from ratt_opt._validation import FloatArray, IntArray, check_number, readonly
from ratt_opt.errors import InputError
from ratt_opt.missions.live.arrivals import Arrivals
from ratt_opt.missions.live.gate import Gate, gate_of
from ratt_opt.missions.live.history import MomentFilter, StampedMeasurement
from ratt_opt.missions.live.in_time import LATE, Planned, PlanRequest, TimedPlanner
from ratt_opt.missions.live.packets import PacketError, Skipped, TrackerPlan
from ratt_opt.missions.live.roster import threat, with_attack, with_target, without_robot, without_target
from ratt_opt.missions.live.state import Moment, TrackerState
from ratt_opt.missions.planning import offered_sequences, part_problem, planner_world
from ratt_opt.missions.players.planners import get_planner
from ratt_opt.missions.world import MissionModel, World
from ratt_opt.scenario.planner_world import Now
from ratt_opt.scenario.record import LARGEST

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from ratt_opt.missions.ahead.horizon import Sequences
    from ratt_opt.missions.belief import Belief
    from ratt_opt.missions.live.history import FilterUpdate
    from ratt_opt.missions.live.packets import MeasurementInnovation
    from ratt_opt.missions.live.state import Measurement
    from ratt_opt.missions.players.planners import Planner
    from ratt_opt.problem import Attack
    from ratt_opt.scenario.model import Scenario, Target

__all__ = ["Tracker"]

LOG = logging.getLogger("ratt_opt.tracker")


@dataclass(frozen=True, slots=True)
class Reception:
    """Limits on the times of measurements that are accepted.

    ``lag`` : seconds that one may come late (a longer one stores more moments, and takes more work); ``skew`` :
    seconds by which a stamp may be ahead of the step's clock, as clocks differ; it then counts as the step's. ``None``
    : ten sampling periods, and a tenth of one.
    """

    lag: float | None = None
    skew: float | None = None

    def seconds(self, period: float) -> tuple[float, float]:
        """Lag and skew [s] at this sampling period [s]. InputError : one is negative or not finite."""
        lag = 10 * period if self.lag is None else check_number("lag", self.lag, low=0.0)
        return lag, period / 10 if self.skew is None else check_number("skew", self.skew, low=0.0)


class Tracker:
    """Estimates targets from measurements and plans the robots' next controls.

    Parameters
    ----------
    scenario : the team as it starts, what is believed of the targets, and the adversary's budgets
    planner : as in :func:`run_mission`; if a callable is late, its work goes on in a thread and is discarded
    horizon : steps that a plan looks ahead
    time_limit : seconds for a step; ``None`` waits for the planner. If the planner is late, ``state.missed`` counts it,
        and RATT's plan is used; that one is made first and takes some milliseconds. If it raises an error,
        ``state.failed`` counts it, and the better of RATT's plan and of the rest of the last plan is used.
    model : motions, sensors and filter, as in :func:`run_mission`
    state : where to go on; the scenario's start by default
    lag : seconds that a measurement may come late; ten sampling periods by default
    skew : seconds by which a stamp may be ahead of the step's clock; a tenth of a sampling period by default
    gate : probability with which a good measurement passes (chi-square), a :class:`Gate`, or ``None`` to take all.
        What is refused is in ``skipped``. A target all of whose sightings were refused at five times in a row is lost:
        it is then found again where most of its sightings agree (see :class:`Gate`).
    strict : measurements that cannot be taken in, and errors of the planner, are raised; the state is then as it was.
        Outliers are refused and reported all the same

    ``state`` : the tracker's whole state; ``controls`` : (N, c) what every robot executes next, a unicycle's speed
    [m/s] and turn rate [rad/s].
    ``scenario`` : the team with its present targets; needed to go on from ``state``.

    Raises
    ------
    InputError : an argument breaks its rule, or the state is of another team.
    """

    def __init__(
        self,
        scenario: Scenario,
        *,
        planner: str | Planner = "ratt",
        horizon: int = 1,
        time_limit: float | None = None,
        model: MissionModel | None = None,
        state: TrackerState | None = None,
        lag: float | None = None,
        skew: float | None = None,
        gate: float | Gate | None = 0.999,
        strict: bool = False,
    ) -> None:
        if time_limit is not None and not check_number("time_limit", time_limit, low=0.0) > 0:
            raise InputError("time_limit", "must be positive", time_limit)
        self.world = World(scenario, model or MissionModel(), horizon)
        params = self.world.model.params
        self.lag, self.skew = Reception(lag, skew).seconds(self.world.period)
        self.gate, self.strict = gate_of(gate), strict
        self._plan = TimedPlanner(get_planner(planner), time_limit, params.fallback_nodes, params.search_share)
        self.state = self._start() if state is None else self._checked(state)
        self.controls: FloatArray = readonly(self.state.controls[:, 0])

    @property
    def scenario(self) -> Scenario:
        """The team as it started, with the targets that there are now."""
        return self.world.scenario

    @property
    def time_limit(self) -> float | None:
        """Seconds for a step."""
        return self._plan.time_limit

    @property
    def beliefs(self) -> Belief:
        """Belief about the targets now, in the order of :attr:`targets`."""
        return self.state.belief

    @property
    def targets(self) -> tuple[int, ...]:
        """Numbers of the targets that there are now."""
        return self.state.targets

    @property
    def links(self) -> frozenset[tuple[int, int]]:
        """Links ``(i, j)`` at the robots' poses, without those known to be cut and those of lost robots."""
        lost, attack = dict(self.state.lost), self.state.attack
        links = self.world.communication(self.state.poses, attack).links
        return frozenset(link for link in links if not lost.keys() & set(link))

    def step(
        self,
        measurements: Iterable[Measurement] = (),
        now: float | None = None,
        *,
        poses: ArrayLike | None = None,
        pose_covariances: ArrayLike | None = None,
        strict: bool | None = None,
    ) -> TrackerPlan:
        """Take in what was measured, and plan the next control.

        The first call, before any control, plans from the start; measurements may be given to it too.

        Parameters
        ----------
        measurements : those that arrived; which groups' they are is the caller's matter. Each is taken in at its own
            time, in whatever order they arrive. One that cannot be taken in, or is an outlier, is skipped: ``skipped``
            of the plan says why, and so does the log ``ratt_opt.tracker``.
        now : the caller's clock [s]; it must not run backwards, and the belief is predicted by what has passed.
            ``None`` is one sampling period after the last step.
        poses : (N, 3 or 4) poses that the robots know of themselves; by default those that the last plan led to
        pose_covariances : (N, p, p) of these poses [m^2], [m rad], [rad^2]; exact by default. They are taken for
            further noise of every measurement made from there.
        strict : as the tracker's, for this step

        Returns
        -------
        TrackerPlan : ``elements`` index the control sequences that were offered, all in file order unless the model has
            an area or a beam; :attr:`controls` has the first of each as numbers. A lost robot's mean nothing.
            ``skipped`` and ``innovations`` say what became of the measurements.

        Raises
        ------
        InputError : a measurement has another length than its sensor's or a number that is not finite; poses break
            their rules; or time runs backwards. If ``strict``, also a measurement that cannot be taken in. The state is
            then as it was.
        """
        began = monotonic()
        if not isinstance(measurements, Iterable):
            raise InputError("measurements", "must be Measurements", measurements)
        strict = self.strict if strict is None else strict
        state, told = self._measured(list(measurements), now, (poses, pose_covariances), strict=strict)
        offered = self._offered(state)
        planned = self._planned(state, offered, began, strict=strict)
        chosen, lost = offered.only(planned.elements), [robot for robot, _ in state.lost]
        left = np.concatenate([chosen.controls[:, 1:], chosen.controls[:, -1:]], axis=1)
        controls, poses_next = chosen.controls[:, 0].copy(), chosen.poses[:, 0].copy()
        controls[lost], poses_next[lost] = 0.0, state.poses[lost]
        self.state = replace(
            state,
            poses=readonly(poses_next),
            controls=readonly(left),
            steps=state.steps + 1,
            missed=state.missed + (planned.fallback == LATE),
            failed=state.failed + (planned.fallback not in {"", LATE}),
        )
        self.controls = readonly(controls)
        return replace(told, elements=readonly(planned.elements), fallback=planned.fallback)

    def lose(self, robot: int) -> None:
        """A robot is lost: it moves, measures and relays no more. InputError : there is none, or it is lost already."""
        self.state = without_robot(self.world, self.state, robot)

    def attacked(self, attack: Attack) -> None:
        """Say which sensors are known to be blinded and which links to be cut, in place of what was said before.

        Plans do without them, and against the remaining budgets. ``Attack()`` : nothing is attacked any more.

        Raises
        ------
        InputError : it is no attack, or names robots that do not exist.
        """
        self.state = with_attack(self.world, self.state, attack)

    def add_target(self, target: Target) -> int:
        """A target appears, known now as ``target`` says; returns its number, which measurements name it by.

        Raises
        ------
        InputError : it is no target, or the model's motion is for a fixed number of them.
        """
        self.world, self.state = with_target(self.world, self.state, target)
        return self.state.targets[-1]

    def drop_target(self, target: int) -> None:
        """A target has vanished; the others keep their numbers. InputError : there is none of that number.

        After the last one robots go on as planned, then as they do last, until a target appears.
        """
        self.world, self.state = without_target(self.world, self.state, target)

    def _start(self) -> TrackerState:
        scenario = self.scenario
        elements = np.searchsorted(scenario.robot, np.arange(scenario.n_robots))
        first, width = scenario.controls[elements], scenario.poses.shape[1]
        exact = readonly(np.zeros((scenario.n_robots, width, width)))
        belief, fresh = self.world.motion.initial(scenario), (0,) * scenario.n_targets
        return TrackerState(
            time=0.0,
            now=None,
            poses=scenario.poses,
            moments=(Moment(time=0.0, poses=scenario.poses, pose_covariances=exact, belief=belief, refused=fresh),),
            controls=readonly(np.repeat(first[:, None], self.world.horizon, axis=1)),
            targets=tuple(range(scenario.n_targets)),
            born=(0.0,) * scenario.n_targets,
            next_target=scenario.n_targets,
        )

    def _checked(self, state: TrackerState) -> TrackerState:
        if not isinstance(state, TrackerState):
            raise InputError("state", "must be a TrackerState", type(state).__name__)
        (n, p), c = self.scenario.poses.shape, self.scenario.controls.shape[1]
        m, d = self.scenario.n_targets if state.targets else 0, self.world.motion.dimension
        expected = {"poses": (n, p), "targets": (m,), "controls": (n, self.world.horizon, c)}
        found = {"poses": state.poses.shape, "targets": (len(state.targets),), "controls": state.controls.shape}
        for moment in state.moments:
            expected |= {"mean": (m, d), "refused": (m,), "moment poses": (n, p), "pose_covariances": (n, p, p)}
            found |= {"mean": moment.belief.mean.shape, "refused": (len(moment.refused),)}
            found |= {"moment poses": moment.poses.shape, "pose_covariances": moment.pose_covariances.shape}
            for name, shape in expected.items():
                if found[name] != shape:
                    raise InputError(f"state {name}", f"must have shape {shape} for this team", f"shape {found[name]}")
        return _within_reach(state)

    def _measured(
        self,
        measurements: list[Measurement],
        now: float | None,
        given: tuple[ArrayLike | None, ArrayLike | None],
        *,
        strict: bool,
    ) -> tuple[TrackerState, TrackerPlan]:
        """The state after time has passed and the measurements are taken in, and what became of each."""
        arrivals = Arrivals(self.world, self.state, self.skew)
        passed, clock = arrivals.passed(now)
        poses, unsure = arrivals.poses(*given)
        time, belief = self.state.time + passed, self.state.belief
        made = arrivals.made(measurements, time, clock)
        moment = Moment(time=time, poses=poses, pose_covariances=unsure, belief=belief, refused=(0,) * len(belief.mean))
        filtering = MomentFilter(self.world, self.state.targets, np.array(self.state.born), self.gate)
        good = [one for one in made if isinstance(one, StampedMeasurement)]
        taken = filtering.taken_in((*self.state.moments, moment), good)
        faults = [one if isinstance(one, PacketError) else taken.faults.get(id(one.measurement)) for one in made]
        if strict and (first := next((fault for fault in faults if fault is not None), None)) is not None:
            raise first
        moments = _recent(taken.moments, time - self.lag)
        state = _within_reach(replace(self.state, time=time, now=clock, poses=poses, moments=moments))
        return state, self._told(measurements, made, faults, taken)

    def _told(
        self,
        measurements: list[Measurement],
        made: list[StampedMeasurement | PacketError],
        faults: list[PacketError | None],
        taken: FilterUpdate,
    ) -> TrackerPlan:
        """Report the fate of each measurement; the plan itself is still to be made."""
        skipped, innovations = [], []
        for given, one, fault in zip(measurements, made, faults, strict=True):
            innovation = None if isinstance(one, PacketError) else taken.innovations.get(id(one.measurement))
            if innovation is not None:
                innovations.append(replace(innovation, measurement=given))
            if fault is not None:
                skipped.append(Skipped(given, fault.reason, str(fault)))
            elif innovation is not None and not innovation.accepted:
                skipped.append(Skipped(given, "outlier", _outlying(innovation, self.gate)))
            elif isinstance(one, StampedMeasurement) and id(one.measurement) in taken.silent:
                why = f"robot {given.robot}'s sighting of target {given.target} tells nothing about it"
                skipped.append(Skipped(given, "tells nothing", why))
        for packet in skipped:
            LOG.warning("skipped (%s): %s", packet.reason, packet.why)
        counts = zip(self.state.targets, taken.moments[-1].refused, strict=True)
        lost = [j for j, count in counts if self.gate is not None and count >= self.gate.patience]
        return TrackerPlan(
            elements=readonly(np.zeros(0, dtype=np.int64)),
            evaluations=0,
            skipped=tuple(skipped),
            innovations=tuple(innovations),
            lost=tuple(lost),
            found=tuple(sorted(taken.found)),
        )

    def _offered(self, state: TrackerState) -> Sequences:
        """Control sequences to choose from: without a target there is nothing that a beam could choose by."""
        if not state.targets:
            return self.world.sequences(state.poses)
        return offered_sequences(self.world, state.belief, state.poses, state.time)

    def _planned(self, state: TrackerState, offered: Sequences, began: float, *, strict: bool) -> Planned:
        """A plan of the robots that are left; none is dropped, so that elements always mean the same to the caller."""
        rest = _nearest(offered, state.controls)
        lost = {robot for robot, _ in state.lost}
        alive = [i for i in range(self.scenario.n_robots) if i not in lost]
        if not (alive and state.targets):
            return Planned(rest)
        threatened = threat(self.world, state)
        objective = self.world.criterion(state.belief, offered, state.time)
        problem = self.world.problem(objective, offered.owner, state.poses, threatened)
        at = Now(state.steps, state.time, state.poses, state.attacks)
        world = planner_world(self.world, state.belief, offered, problem, at)
        if not lost:
            return self._plan(PlanRequest(problem, world, rest), began, strict=strict)
        own = np.flatnonzero(np.isin(offered.owner, alive))
        part = part_problem(problem, objective.restricted_to(own), alive, own, threatened)
        world = world.part(alive, own, world.states, world.covariances)
        planned = self._plan(PlanRequest(part, world, np.searchsorted(own, rest[alive])), began, strict=strict)
        elements = rest.copy()
        elements[alive] = own[planned.elements]
        return Planned(elements, planned.fallback)


def _outlying(innovation: MeasurementInnovation, gate: Gate | None) -> str:
    """Say in one line why the gate refused a measurement."""
    assert gate is not None
    m, limit = innovation.measurement, float(gate.limits(np.array(float(innovation.count))))
    square = f"normalised innovation squared {innovation.squared:.4g}"
    return f"robot {m.robot}'s sighting of target {m.target} must be within the gate; got {square}, above {limit:.4g}"


def _recent(moments: tuple[Moment, ...], oldest: float) -> tuple[Moment, ...]:
    """The moments of times not before the ``oldest``, and the last one before these to go on from."""
    first = max((k for k, moment in enumerate(moments) if moment.time <= oldest), default=0)
    return moments[first:]


def _within_reach(state: TrackerState) -> TrackerState:
    """Return the state after checking that what is computed with it stays finite.

    Raises ``InputError`` : a robot or target is outside every scenario, as after a range of 1e300 m.
    """
    for name, numbers in (("poses", state.poses), ("estimates", state.belief.mean)):
        if not np.abs(numbers).max(initial=0.0) <= LARGEST:
            raise InputError(name, f"must stay within {LARGEST:g}", float(np.abs(numbers).max()))
    return state


def _nearest(offered: Sequences, wanted: FloatArray) -> IntArray:
    """(N,) elements whose controls are those wanted (N, H, 2), or nearest to them if they are not offered."""
    apart = np.abs(offered.controls - wanted[offered.owner]).sum(axis=(1, 2))
    return np.array([(own := np.flatnonzero(offered.owner == i))[np.argmin(apart[own])] for i in range(len(wanted))])
