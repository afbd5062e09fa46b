"""Inputs of a step, checked: the clock, the poses, and every measurement with the time it was made."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from ratt_opt._validation import FloatArray, check_finite, check_integer, check_number, readonly
from ratt_opt.errors import InputError
from ratt_opt.missions.live.history import StampedMeasurement
from ratt_opt.missions.live.packets import PacketError
from ratt_opt.missions.live.state import Measurement
from ratt_opt.scenario.record import LARGEST

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from ratt_opt.missions.live.state import TrackerState
    from ratt_opt.missions.world import World

__all__ = ["Arrivals"]


@dataclass(frozen=True, slots=True, eq=False)
class Arrivals:
    """Checks of what a tracker in this state is given; every error is an ``InputError``.

    ``skew`` : seconds by which a stamp may be ahead of the step's clock; it then counts as the step's.
    """

    world: World
    state: TrackerState
    skew: float

    def passed(self, now: float | None) -> tuple[float, float | None]:
        """Seconds since the last step, none before the first, and the caller's clock."""
        before, period = self.state.now, self.world.period
        if now is not None:
            now = check_number("now", now)
        if self.state.steps == 0:
            return 0.0, now
        if now is None or before is None:
            return period, now if before is None else before + period
        if now < before:
            raise InputError("now", f"must not be before the last step's {before:.6g} s", now)
        most = self.world.model.params.most_periods
        latest = before + most * period
        if now > latest:
            rule = f"must be within {most} sampling periods of the last step's, by {latest:.6g} s"
            raise InputError("now", rule, now)
        return now - before, now

    def poses(self, poses: ArrayLike | None, covariances: ArrayLike | None) -> tuple[FloatArray, FloatArray]:
        """(N, p) poses (default: those that the last plan led to), and (N, p, p) their covariances, zero by default."""
        shape = self.state.poses.shape
        places = self.state.poses if poses is None else check_finite("poses", poses, ndim=2)
        if places.shape != shape:
            raise InputError("poses", f"must have shape {shape}", f"shape {places.shape}")
        square = (*shape, shape[1])
        if covariances is None:
            return readonly(places), readonly(np.zeros(square))
        unsure = check_finite("pose_covariances", covariances, ndim=3)
        if unsure.shape != square:
            raise InputError("pose_covariances", f"must have shape {square}", f"shape {unsure.shape}")
        for i, matrix in enumerate(unsure):
            allowed = self.world.model.params.pose_rounding * np.abs(matrix).max()
            if np.abs(matrix - matrix.T).max() > allowed or np.linalg.eigvalsh(matrix)[0] < -allowed:
                rule = "must be symmetric positive semidefinite"
                raise InputError(f"pose_covariances[{i}]", rule, matrix.tolist())
        return readonly(places), readonly((unsure + np.swapaxes(unsure, -1, -2)) / 2)

    def made(
        self, measurements: list[Measurement], time: float, now: float | None
    ) -> list[StampedMeasurement | PacketError]:
        """Every measurement with its time since the start, or why it cannot be taken in.

        ``time`` and ``now`` are those of this step. InputError : one is no measurement, or not of its sensor's length.
        """
        return [self._made(f"measurements[{k}]", one, time, now) for k, one in enumerate(measurements)]

    def _made(self, name: str, given: Measurement, time: float, now: float | None) -> StampedMeasurement | PacketError:
        if not isinstance(given, Measurement):
            raise InputError(name, "must be a Measurement", type(given).__name__)
        try:
            return self._checked(name, given, time, now)
        except PacketError as fault:
            return fault

    def _checked(self, name: str, given: Measurement, time: float, now: float | None) -> StampedMeasurement:
        robot = check_integer(f"{name}.robot", given.robot, low=0)
        target = check_integer(f"{name}.target", given.target, low=0)
        values = check_finite(f"{name}.values", given.values, ndim=1)
        n_robots, targets = self.world.scenario.n_robots, self.state.targets
        if robot >= n_robots:
            rule = f"must be an integer in [0, {n_robots - 1}]"
            raise PacketError("unknown robot", f"{name}.robot", rule, robot)
        sensor = self.world.sensors[robot]
        if len(values) != sensor.size:
            raise InputError(f"{name}.values", f"must have {sensor.size} numbers", len(values))
        if target not in targets:
            rule = f"must be one of the targets {list(targets)}"
            raise PacketError("unknown target", f"{name}.target", rule, target)
        when = self._time(name, given.time, time, now)
        self._check_known(name, robot, target, when)
        if np.abs(values).max() > LARGEST:
            raise PacketError("impossible", f"{name}.values", f"must stay within {LARGEST:g}", values.tolist())
        fault = sensor.fault(values)
        if fault is not None:
            raise PacketError("impossible", f"{name}.values", fault, values.tolist())
        ahead = when if when > time else None
        stored = Measurement(robot, target, tuple(values.tolist()), ahead)
        return StampedMeasurement(name, min(when, time), stored, stamped=given.time is not None)

    def _time(self, name: str, stamp: float | None, time: float, now: float | None) -> float:
        """Return when a measurement was made [s since the start]; a stamp is on the caller's clock."""
        if stamp is None:
            return time
        clock = time if now is None else now
        made = check_number(f"{name}.time", stamp) - clock + time
        near, oldest = self.world.on_time, self.state.moments[0].time
        if made > time + max(near, self.skew):
            rule = f"must not be after this step's {clock:.6g} s (by more than the skew, {self.skew:.3g} s)"
            raise PacketError("future", f"{name}.time", rule, stamp)
        if made < oldest - near:
            rule = f"must not be before {oldest - time + clock:.6g} s, the oldest time that is kept (lag)"
            raise PacketError("too late", f"{name}.time", rule, stamp)
        return max(made, oldest) if made > time + near else min(max(made, oldest), time)

    def _check_known(self, name: str, robot: int, target: int, made: float) -> None:
        near = self.world.on_time
        if made > dict(self.state.lost).get(robot, np.inf) + near:
            raise PacketError("lost robot", f"{name}.robot", "must not be lost when it measured", robot)
        if made > dict(self.state.blinded).get(robot, np.inf) + near:
            raise PacketError("blinded robot", f"{name}.robot", "must not be blinded when it measured", robot)
        born = self.state.born[self.state.targets.index(target)]
        if made < born - near:
            rule = f"must not be before target {target} was added, {born:.6g} s"
            raise PacketError("before its target", f"{name}.time", rule, made)
