"""The loop inside a real system: measurements in, the next plan out, within a time limit; the state is plain data.

The plan after a step is for the next one. Everything that the next step needs is in :class:`TrackerState`, which
pickles and becomes JSON and back without losing a bit: a robot may die, and another go on from its state.
"""

from __future__ import annotations

import warnings
from collections.abc import Iterable
from dataclasses import replace
from time import monotonic
from typing import TYPE_CHECKING

import numpy as np

from ratt_opt._validation import FloatArray, IntArray, check_number, readonly
from ratt_opt.errors import InputError
from ratt_opt.missions.live.arrivals import Arrivals
from ratt_opt.missions.live.history import Filter
from ratt_opt.missions.live.in_time import InTime, Planned
from ratt_opt.missions.live.roster import threat, with_attack, with_target, without_robot, without_target
from ratt_opt.missions.live.state import Moment, TrackerState
from ratt_opt.missions.planning import offered_sequences, part_problem
from ratt_opt.missions.players.planners import planner_called
from ratt_opt.missions.world import MissionModel, World
from ratt_opt.problem import Attack, Plan
from ratt_opt.scenario.record import LARGEST

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from ratt_opt.missions.ahead.horizon import Sequences
    from ratt_opt.missions.belief import Belief
    from ratt_opt.missions.live.state import Measurement
    from ratt_opt.missions.players.planners import Planner
    from ratt_opt.scenario.model import Scenario, Target

__all__ = ["Tracker"]

LAG = 10.0
"""Sampling periods that a measurement may come late, unless the caller says."""


class Tracker:
    """Estimates targets from measurements and plans the robots' next controls.

    Parameters
    ----------
    scenario : the team as it starts, what is believed of the targets, and the adversary's budgets
    planner : as in :func:`run_mission`; if a callable is late, its work goes on in a thread and is discarded
    horizon : steps that a plan looks ahead
    time_limit : seconds for a step; ``None`` waits for the planner. If the planner is late, ``missed`` counts it, and
        RATT's plan is used; that one is made first and takes some milliseconds.
    model : motions, sensors and filter, as in :func:`run_mission`
    state : where to go on; the scenario's start by default
    lag : seconds that a measurement may come late; ten sampling periods by default

    ``state`` : the tracker's whole state; ``controls`` : (N, 2) speed [m/s] and turn rate [rad/s] that every robot
    executes next.
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
    ) -> None:
        if time_limit is not None and not check_number("time_limit", time_limit, low=0.0) > 0:
            raise InputError("time_limit", "must be positive", time_limit)
        self.world = World(scenario, model or MissionModel(), horizon)
        self.lag = LAG * self.world.period if lag is None else check_number("lag", lag, low=0.0)
        self._plan = InTime(planner_called(planner), time_limit)
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
        """What is believed of the targets now, in the order of :attr:`targets`."""
        return self.state.belief

    @property
    def targets(self) -> tuple[int, ...]:
        """Numbers of the targets that there are now."""
        return self.state.targets

    def step(
        self,
        measurements: Iterable[Measurement] = (),
        now: float | None = None,
        *,
        poses: ArrayLike | None = None,
        pose_covariances: ArrayLike | None = None,
    ) -> Plan:
        """Take in what was measured, and plan the next control.

        The first call, before any control, plans from the start; measurements may be given to it too.

        Parameters
        ----------
        measurements : those that arrived; which groups' they are is the caller's matter. Each is taken in at its own
            time, in whatever order they arrive. One that tells nothing is not used, and a ``RuntimeWarning`` says so.
        now : the caller's clock [s]; it must not run backwards, and the belief is predicted by what has passed.
            ``None`` is one sampling period after the last step.
        poses : (N, 3) poses that the robots know of themselves; by default those that the last plan led to
        pose_covariances : (N, 3, 3) of these poses [m^2], [m rad], [rad^2]; exact by default. They are taken for
            further noise of every measurement made from there.

        Returns
        -------
        Plan : ``elements`` index the control sequences that were offered, all in file order unless the model has an
            area or a beam; :attr:`controls` (N, 2) has the first of each as numbers. A lost robot's mean nothing.

        Raises
        ------
        InputError : a measurement names no robot or target, has another length, cannot be its sensor's, is of the
            future or of a time too long past; a number is not finite or puts a target beyond 1e12 m; or time runs
            backwards. The state is then as it was.
        """
        began = monotonic()
        if not isinstance(measurements, Iterable):
            raise InputError("measurements", "must be Measurements", measurements)
        state = self._measured(list(measurements), now, (poses, pose_covariances))
        offered = offered_sequences(self.world, state.belief, state.poses, state.time)
        planned = self._planned(state, offered, began)
        chosen, lost = offered.only(planned.elements), [robot for robot, _ in state.lost]
        left = np.concatenate([chosen.controls[:, 1:], chosen.controls[:, -1:]], axis=1)
        controls, poses_next = chosen.controls[:, 0].copy(), chosen.poses[:, 0].copy()
        controls[lost], poses_next[lost] = 0.0, state.poses[lost]
        self.state = replace(
            state,
            poses=readonly(poses_next),
            controls=readonly(left),
            steps=state.steps + 1,
            missed=state.missed + planned.late,
        )
        self.controls = readonly(controls)
        return Plan(elements=readonly(planned.elements), evaluations=0)

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
        """A target has vanished; the others keep their numbers. InputError : there is none of that number, or it is the
        last one."""
        self.world, self.state = without_target(self.world, self.state, target)

    def _start(self) -> TrackerState:
        scenario = self.scenario
        first = np.array([robot.controls[0] for robot in scenario.robots])
        exact = readonly(np.zeros((scenario.n_robots, 3, 3)))
        belief = self.world.motion.initial(scenario)
        return TrackerState(
            time=0.0,
            now=None,
            poses=scenario.poses,
            moments=(Moment(time=0.0, poses=scenario.poses, pose_covariances=exact, belief=belief),),
            controls=readonly(np.repeat(first[:, None], self.world.horizon, axis=1)),
            targets=tuple(range(scenario.n_targets)),
            born=(0.0,) * scenario.n_targets,
            next_target=scenario.n_targets,
        )

    def _checked(self, state: TrackerState) -> TrackerState:
        if not isinstance(state, TrackerState):
            raise InputError("state", "must be a TrackerState", type(state).__name__)
        n, m, d = self.scenario.n_robots, self.scenario.n_targets, self.world.motion.dimension
        expected = {"poses": (n, 3), "targets": (m,), "controls": (n, self.world.horizon, 2)}
        found = {"poses": state.poses.shape, "targets": (len(state.targets),), "controls": state.controls.shape}
        for moment in state.moments:
            expected |= {"mean": (m, d), "moment poses": (n, 3), "pose_covariances": (n, 3, 3)}
            found |= {"mean": moment.belief.mean.shape, "moment poses": moment.poses.shape}
            found |= {"pose_covariances": moment.pose_covariances.shape}
            for name, shape in expected.items():
                if found[name] != shape:
                    raise InputError(f"state {name}", f"must have shape {shape} for this team", f"shape {found[name]}")
        return _within_reach(state)

    def _measured(
        self, measurements: list[Measurement], now: float | None, given: tuple[ArrayLike | None, ArrayLike | None]
    ) -> TrackerState:
        """The state after time has passed and the measurements are taken in."""
        arrivals = Arrivals(self.world, self.state)
        passed, clock = arrivals.passed(now)
        poses, unsure = arrivals.poses(*given)
        time = self.state.time + passed
        made = arrivals.made(measurements, time, clock)
        moment = Moment(time=time, poses=poses, pose_covariances=unsure, belief=self.state.belief)
        filtering = Filter(self.world, self.state.targets, np.array(self.state.born))
        moments, unused = filtering.taken_in((*self.state.moments, moment), made)
        state = replace(self.state, time=time, now=clock, poses=poses, moments=_recent(moments, time - self.lag))
        _within_reach(state)
        if unused:
            first, more = unused[0], f" (and {len(unused) - 1} more)" if len(unused) > 1 else ""
            text = f"robot {first.robot}'s sighting of target {first.target} was not used: it tells nothing{more}"
            warnings.warn(text, RuntimeWarning, stacklevel=3)
        return state

    def _planned(self, state: TrackerState, offered: Sequences, began: float) -> Planned:
        """A plan of the robots that are left; none is dropped, so that elements always mean the same to the caller."""
        rest = _nearest(offered, state.controls)
        lost = {robot for robot, _ in state.lost}
        alive = [i for i in range(self.scenario.n_robots) if i not in lost]
        if not alive:
            return Planned(rest, late=False)
        threatened = threat(self.world, state)
        objective = self.world.criterion(state.belief, offered, state.time)
        problem = self.world.problem(objective, offered.owner, state.poses, threatened)
        if not lost:
            return self._plan(problem, rest, began)
        own = np.flatnonzero(np.isin(offered.owner, alive))
        part = part_problem(problem, objective.restricted_to(own), alive, own, threatened)
        planned = self._plan(part, np.searchsorted(own, rest[alive]), began)
        elements = rest.copy()
        elements[alive] = own[planned.elements]
        return Planned(elements, planned.late)


def _recent(moments: tuple[Moment, ...], oldest: float) -> tuple[Moment, ...]:
    """The moments of times not before the ``oldest``, and the last one before these to go on from."""
    first = max((k for k, moment in enumerate(moments) if moment.time <= oldest), default=0)
    return moments[first:]


def _within_reach(state: TrackerState) -> TrackerState:
    """Return the state after checking that what is computed with it stays finite.

    Raises ``InputError`` : a robot or target is outside every scenario, as after a range of 1e300 m.
    """
    for name, numbers in (("poses", state.poses), ("estimates", state.belief.mean)):
        if not np.abs(numbers).max() <= LARGEST:
            raise InputError(name, f"must stay within {LARGEST:g}", float(np.abs(numbers).max()))
    return state


def _nearest(offered: Sequences, wanted: FloatArray) -> IntArray:
    """(N,) elements whose controls are those wanted (N, H, 2), or nearest to them if they are not offered."""
    apart = np.abs(offered.controls - wanted[offered.owner]).sum(axis=(1, 2))
    return np.array([(own := np.flatnonzero(offered.owner == i))[np.argmin(apart[own])] for i in range(len(wanted))])
