"""The loop inside a real system: measurements in, the next plan out, within a time limit; the state is plain data.

The plan after a step is for the next one. Everything that the next step needs is in :class:`TrackerState`, which
pickles and becomes JSON and back without losing a bit: a robot may die, and another go on from its state.
"""

from __future__ import annotations

from collections.abc import Iterable
from concurrent.futures import Future
from concurrent.futures import TimeoutError as LateError
from dataclasses import replace
from functools import partial
from threading import Thread
from time import monotonic
from typing import TYPE_CHECKING, Any

import numpy as np

from ratt_opt._validation import FloatArray, IntArray, check_finite, check_integer, check_number, readonly
from ratt_opt.budget import Budget
from ratt_opt.errors import InputError
from ratt_opt.missions.planning import offered_sequences
from ratt_opt.missions.players.planners import MaxMinPlanner, elements_of, planner_called
from ratt_opt.missions.sensing import Reading, group_pieces
from ratt_opt.missions.tracker_state import Measurement, TrackerState
from ratt_opt.missions.world import MissionModel, Threatened, World
from ratt_opt.problem import Attack, Plan
from ratt_opt.scenario.record import LARGEST
from ratt_opt.solvers.ratt import ratt

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import ArrayLike

    from ratt_opt.missions.ahead.horizon import Sequences
    from ratt_opt.missions.belief import Belief
    from ratt_opt.missions.players.planners import Planner
    from ratt_opt.problem import Problem
    from ratt_opt.scenario.model import Scenario

__all__ = ["Tracker"]

SEARCH_SHARE = 0.7
"""Of a step's time left, for the max-min search: it looks at the clock between nodes, which take a while themselves."""
FALLBACK_SHARE = 0.5
"""Of a step's time left, for RATT's plan, which takes milliseconds: what it has by then is a plan, too."""
ON_TIME = 1e-6
"""Clocks whose steps differ by less than this share of the period count as one period."""
MOST_PERIODS = 10_000
"""That may pass between two steps: each is predicted on its own; after so many nothing is known of a target."""


class Tracker:
    """Estimates targets from measurements and plans the robots' next controls.

    Parameters
    ----------
    scenario : the team as it starts, what is believed of the targets, and the adversary's budgets
    planner : as in :func:`run_mission`; a callable's work goes on in a thread when it is late, and is thrown away
    horizon : steps that a plan looks ahead
    time_limit : seconds for a step; ``None`` waits for the planner. A late plan counts in ``missed``, and RATT's plan,
        which is made first, is executed instead.
    model : motions, sensors and filter, as in :func:`run_mission`
    state : where to go on; the scenario's start by default

    ``state`` : all it knows; ``controls`` : (N, 2) speed [m/s] and turn rate [rad/s] that every robot executes next.

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
    ) -> None:
        if time_limit is not None and not check_number("time_limit", time_limit, low=0.0) > 0:
            raise InputError("time_limit", "must be positive", time_limit)
        self.scenario, self.time_limit = scenario, time_limit
        self.world = World(scenario, model or MissionModel(), horizon)
        self._plan = planner_called(planner)
        self._running: Future[IntArray] | None = None
        self.state = self._start() if state is None else self._checked(state)
        self.controls: FloatArray = readonly(self.state.controls[:, 0])

    @property
    def beliefs(self) -> Belief:
        """What is believed of the targets now."""
        return self.state.belief

    def __getstate__(self) -> dict[str, Any]:
        return {**self.__dict__, "_running": None}

    def step(
        self,
        measurements: Iterable[Measurement] = (),
        now: float | None = None,
        *,
        poses: ArrayLike | None = None,
    ) -> Plan:
        """Take in what was measured after the last plan's control, and plan the next one.

        The first call, before any control, plans from the start; measurements may be given to it too.

        Parameters
        ----------
        measurements : those that arrived; which groups' they are is the caller's matter
        now : the caller's clock [s]; it must not run backwards, and the belief is predicted by what has passed.
            ``None`` is one sampling period after the last step.
        poses : (N, 3) where the robots know to be; where the last plan led them by default

        Returns
        -------
        Plan : ``elements`` index the control sequences that were offered, all in file order unless the model has an
            area or a beam; :attr:`controls` (N, 2) has the first of each as numbers

        Raises
        ------
        InputError : a measurement names no robot or target or has another length, a number is not finite or puts a
            target beyond 1e12 m, or time runs backwards. The state is then as it was.
        """
        began = monotonic()
        if not isinstance(measurements, Iterable):
            raise InputError("measurements", "must be Measurements", measurements)
        state = self._measured(list(measurements), now, poses)
        offered = offered_sequences(self.world, state.belief, state.poses, state.time)
        rest = _nearest(offered, state.controls)
        elements, late = self._elements(self._problem(state, offered), rest, began)
        chosen = offered.only(elements)
        left = np.concatenate([chosen.controls[:, 1:], chosen.controls[:, -1:]], axis=1)
        self.state = replace(
            state,
            poses=readonly(chosen.poses[:, 0]),
            controls=readonly(left),
            steps=state.steps + 1,
            missed=state.missed + late,
        )
        self.controls = readonly(chosen.controls[:, 0])
        return Plan(elements=readonly(elements), evaluations=0)

    def _start(self) -> TrackerState:
        belief = self.world.motion.initial(self.scenario)
        first = np.array([robot.controls[0] for robot in self.scenario.robots])
        controls = np.repeat(first[:, None], self.world.horizon, axis=1)
        return TrackerState(time=0.0, now=None, poses=self.scenario.poses, belief=belief, controls=readonly(controls))

    def _checked(self, state: TrackerState) -> TrackerState:
        if not isinstance(state, TrackerState):
            raise InputError("state", "must be a TrackerState", type(state).__name__)
        n, m, d = self.scenario.n_robots, self.scenario.n_targets, self.world.motion.dimension
        expected = {"poses": (n, 3), "mean": (m, d), "controls": (n, self.world.horizon, 2)}
        found = {"poses": state.poses.shape, "mean": state.belief.mean.shape, "controls": state.controls.shape}
        for name, shape in expected.items():
            if found[name] != shape:
                raise InputError(f"state {name}", f"must have shape {shape} for this team", f"shape {found[name]}")
        return _within_reach(state)

    def _measured(self, measurements: list[Measurement], now: float | None, poses: ArrayLike | None) -> TrackerState:
        """The state after time has passed and the measurements are taken in."""
        state, period = self.state, self.world.period
        passed = self._passed(now)
        belief, time = state.belief, state.time
        for step in _parts(passed, period):
            belief = belief.predicted(self.world.motion, step, time)
            time += step
        places = state.poses if poses is None else check_finite("poses", poses, ndim=2)
        if places.shape != state.poses.shape:
            raise InputError("poses", f"must have shape {state.poses.shape}", f"shape {places.shape}")
        readings = self._readings(measurements)
        if readings:
            pieces, _ = group_pieces(self.world, belief, dict(enumerate(places)), readings, readings)
            belief = belief.updated(pieces.information.sum(axis=0), pieces.vector.sum(axis=0))
        clock = now if now is not None else None if state.now is None else state.now + passed
        return _within_reach(replace(state, time=time, now=clock, poses=places, belief=belief))

    def _passed(self, now: float | None) -> float:
        """Seconds since the last step; none before the first."""
        if now is not None:
            now = check_number("now", now)
        if self.state.steps == 0:
            return 0.0
        if now is None or self.state.now is None:
            return self.world.period
        if now < self.state.now:
            raise InputError("now", f"must not be before the last step's {self.state.now:.6g} s", now)
        latest = self.state.now + MOST_PERIODS * self.world.period
        if now > latest:
            rule = f"must be within {MOST_PERIODS} sampling periods of the last step's, by {latest:.6g} s"
            raise InputError("now", rule, now)
        return now - self.state.now

    def _readings(self, measurements: list[Measurement]) -> dict[int, Reading]:
        readings: dict[int, Reading] = {}
        n, m = self.scenario.n_robots, self.scenario.n_targets
        for k, measurement in enumerate(measurements):
            if not isinstance(measurement, Measurement):
                raise InputError(f"measurements[{k}]", "must be a Measurement", type(measurement).__name__)
            i = check_integer(f"measurements[{k}].robot", measurement.robot, low=0, high=n - 1)
            j = check_integer(f"measurements[{k}].target", measurement.target, low=0, high=m - 1)
            size = self.world.sensors[i].size
            values = check_finite(f"measurements[{k}].values", measurement.values, ndim=1)
            if len(values) != size:
                raise InputError(f"measurements[{k}].values", f"must have {size} numbers", len(values))
            if i not in readings:
                readings[i] = Reading(np.zeros((m, size)), np.zeros(m, dtype=np.bool_))
            if readings[i].seen[j]:
                raise InputError(f"measurements[{k}]", f"must not repeat robot {i} and target {j}", f"({i}, {j})")
            readings[i].values[j], readings[i].seen[j] = values, True
        return readings

    def _problem(self, state: TrackerState, offered: Sequences) -> Problem:
        """Of all sequences: none is dropped, so that elements mean the same to the caller in every step."""
        objective = self.world.criterion(state.belief, offered, state.time)
        budgets = Threatened(Attack(), self.scenario.alpha_s, self.scenario.alpha_c)
        return self.world.problem(objective, offered.owner, state.poses, budgets)

    def _elements(self, problem: Problem, rest: IntArray, began: float) -> tuple[IntArray, bool]:
        """The planner's elements, or RATT's where they are late, and whether they are.

        A search starts from the last plan's ``rest``.
        """
        plan = self._plan
        if isinstance(plan, MaxMinPlanner):
            plan = partial(plan, start=rest)
        if self.time_limit is None:
            return elements_of(plan(problem), problem), False
        left = max(self.time_limit - (monotonic() - began), 0.0)
        in_time = ratt(problem, budget=Budget(FALLBACK_SHARE * left)).elements
        if self._running is not None and not self._running.done():
            return in_time, True  # a thread is still busy with a plan that nobody waits for
        left = max(self.time_limit - (monotonic() - began), 0.0)
        if isinstance(self._plan, MaxMinPlanner):
            plan = partial(replace(self._plan, time_limit=SEARCH_SHARE * left, max_nodes=None), start=rest)
        self._running = _in_thread(lambda: elements_of(plan(problem), problem))
        try:
            return self._running.result(timeout=left), False
        except LateError:
            return in_time, True


def _within_reach(state: TrackerState) -> TrackerState:
    """Return the state after checking that what is computed with it stays finite.

    Raises ``InputError`` : a robot or target is where no scenario could place it, as after a range of 1e300 m.
    """
    for name, numbers in (("poses", state.poses), ("estimates", state.belief.mean)):
        if not np.abs(numbers).max() <= LARGEST:
            raise InputError(name, f"must stay within {LARGEST:g}", float(np.abs(numbers).max()))
    return state


def _in_thread(work: Callable[[], IntArray]) -> Future[IntArray]:
    """The result to come of work in a thread that does not keep the program from ending."""
    future: Future[IntArray] = Future()

    def run() -> None:
        try:
            future.set_result(work())
        except BaseException as error:  # noqa: BLE001  (it is raised where the result is asked for)
            future.set_exception(error)

    Thread(target=run, name="planner", daemon=True).start()
    return future


def _parts(passed: float, period: float) -> list[float]:
    """Whole periods, and what is left: the motion noise is that of periods."""
    whole = int(passed / period * (1 + ON_TIME))
    rest = passed - whole * period
    return [period] * whole + ([rest] if rest > ON_TIME * period else [])


def _nearest(offered: Sequences, wanted: FloatArray) -> IntArray:
    """(N,) elements whose controls are those wanted (N, H, 2), or nearest to them where they are not offered."""
    apart = np.abs(offered.controls - wanted[offered.owner]).sum(axis=(1, 2))
    return np.array([(own := np.flatnonzero(offered.owner == i))[np.argmin(apart[own])] for i in range(len(wanted))])
