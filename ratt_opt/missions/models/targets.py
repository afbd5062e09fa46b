"""Motions of targets: a known velocity (the paper's), a constant velocity or a coordinated turn, both estimated."""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import TYPE_CHECKING, ClassVar, Self

import numpy as np

from ratt_opt._validation import FloatArray, readonly
from ratt_opt._values import ByValue
from ratt_opt.errors import InputError
from ratt_opt.missions.belief import Belief
from ratt_opt.scenario.motion import white_acceleration

if TYPE_CHECKING:
    from ratt_opt.scenario.model import Scenario

__all__ = [
    "TARGET_MOTIONS",
    "ConstantVelocity",
    "ConstantVelocity3D",
    "CoordinatedTurn",
    "KnownVelocity",
    "TargetMotion",
    "check_motion",
    "target_motion",
]


class TargetMotion(ABC):
    """All targets' motion over one period; states (..., M, d) begin with the position x, y [m].

    A motion of your own subclasses this. ``time`` is that of the state given [s], 0 at the mission's start.
    """

    dimension: ClassVar[int]

    @abstractmethod
    def predict(self, states: FloatArray, period: float, time: float) -> FloatArray:
        """(..., M, d) states one period later, without noise."""

    @abstractmethod
    def transition(self, states: FloatArray, period: float) -> FloatArray:
        """(..., M, d, d) derivative of :meth:`predict` by the state."""

    @abstractmethod
    def noise(self, period: float) -> FloatArray:
        """(M, d, d) covariance of the motion noise of one period, symmetric positive semidefinite."""

    @abstractmethod
    def initial(self, scenario: Scenario) -> Belief:
        """Return a scenario's initial belief about its targets, as states."""


@dataclass(frozen=True, eq=False, repr=False)
class KnownVelocity(ByValue, TargetMotion):
    """The paper's targets: the position is the state, speed and turning are known.

    ``motions`` : (M, 3) speed [m/s], turn rate [rad/s], heading at time 0 [rad]; ``process_std`` : (M,) standard
    deviation per axis of the noise of one ``sampling_period`` [m], [s]. The heading advances with the turn rate, so
    that a target circles; the first period is the one of :attr:`Scenario.predicted_targets`.

    Within a period, counted from time 0, a target moves straight along the heading of that period. So its place does
    not depend on how often it is predicted.
    """

    motions: FloatArray
    process_std: FloatArray
    sampling_period: float = 1.0
    dimension: ClassVar[int] = 2

    @classmethod
    def of(cls, scenario: Scenario) -> KnownVelocity:
        """The scenario's targets."""
        targets = scenario.targets
        motions = np.array([(target.speed, target.turn_rate, target.heading) for target in targets])
        return cls(readonly(motions), scenario.step_noise_std, scenario.sampling_period)

    def predict(self, states: FloatArray, period: float, time: float) -> FloatArray:
        """(..., M, 2) positions ``period`` later, which need not be a whole sampling period."""
        speed, turn, heading = self.motions.T
        cells, spans = _cells(time, period, self.sampling_period)
        angles = heading + (cells[:, None] + 1) * self.sampling_period * turn
        steps = (spans[:, None] * speed)[..., None] * np.stack([np.cos(angles), np.sin(angles)], axis=-1)
        return np.asarray(states + steps.sum(axis=0))

    def transition(self, states: FloatArray, period: float) -> FloatArray:  # noqa: ARG002  (known motion)
        """Identities: the step does not depend on where a target is."""
        return np.broadcast_to(np.eye(2), (*states.shape, 2))

    def noise(self, period: float) -> FloatArray:
        """(M, 2, 2) isotropic, in proportion to the time."""
        return np.asarray((self.process_std**2)[:, None, None] * np.eye(2) * (period / self.sampling_period))

    def initial(self, scenario: Scenario) -> Belief:
        """The scenario's estimates."""
        return _positions(scenario)


@dataclass(frozen=True, eq=False, repr=False)
class _EstimatedVelocity(ByValue, TargetMotion):
    """Targets whose velocity is part of the state, under white acceleration.

    ``process_std`` : (M,) standard deviation per axis by which that noise moves a target in a ``sampling_period`` [m].
    ``velocity_std`` : standard deviation of the first estimate of the velocity [m/s].
    """

    process_std: FloatArray
    sampling_period: float = 1.0
    velocity_std: float = 1.0

    @classmethod
    def of(cls, scenario: Scenario) -> Self:
        """The scenario's targets, what moves them now to be estimated."""
        return cls(_process_std(scenario), scenario.sampling_period)

    def _planar_noise(self, period: float) -> FloatArray:
        """(M, 4, 4); its density is such that one sampling period moves a position by ``process_std``."""
        return white_acceleration(3 * self.process_std**2 / self.sampling_period**3, period)


@dataclass(frozen=True, eq=False, repr=False)
class ConstantVelocity(_EstimatedVelocity):
    """States x, y [m], velocity [m/s]; white acceleration.

    ``process_std`` : (M,) standard deviation per axis by which that noise moves a target in a ``sampling_period`` [m].
    ``velocity_std`` : standard deviation of the first estimate of the velocity [m/s].

    Source: Bar-Shalom, Li, Kirubarajan, Estimation with Applications (2001), section 6.2.2.
    """

    dimension: ClassVar[int] = 4

    def predict(self, states: FloatArray, period: float, time: float) -> FloatArray:  # noqa: ARG002
        """(..., M, 4) states one period later."""
        return np.concatenate([states[..., :2] + period * states[..., 2:], states[..., 2:]], axis=-1)

    def transition(self, states: FloatArray, period: float) -> FloatArray:
        """(..., M, 4, 4), the same for all."""
        step = np.kron(np.array([[1.0, period], [0.0, 1.0]]), np.eye(2))
        return np.broadcast_to(step, (*states.shape, 4))

    def noise(self, period: float) -> FloatArray:
        """(M, 4, 4) of white acceleration."""
        return self._planar_noise(period)

    def initial(self, scenario: Scenario) -> Belief:
        """The scenario's estimates, with its speeds and headings as velocities."""
        return _with_velocities(scenario, self.velocity_std)


@dataclass(frozen=True, eq=False, repr=False)
class CoordinatedTurn(_EstimatedVelocity):
    """States x, y [m], velocity [m/s], turn rate [rad/s]; white acceleration and a drifting turn rate.

    ``process_std``, ``velocity_std`` : as for :class:`ConstantVelocity`; ``turn_std`` : standard deviation of the
    first estimate of the turn rate [rad/s]; ``turn_noise`` : of its drift in one second [rad/s].

    Source: Bar-Shalom, Li, Kirubarajan, Estimation with Applications (2001), section 11.7.
    """

    turn_std: float = 0.05
    turn_noise: float = 0.01
    dimension: ClassVar[int] = 5

    def predict(self, states: FloatArray, period: float, time: float) -> FloatArray:  # noqa: ARG002
        """(..., M, 5) states one period later."""
        along, across, *_ = _turn(states[..., 4], period)
        vx, vy = states[..., 2], states[..., 3]
        angle = period * states[..., 4]
        cosine, sine = np.cos(angle), np.sin(angle)
        moved = (
            states[..., 0] + along * vx - across * vy,
            states[..., 1] + across * vx + along * vy,
            cosine * vx - sine * vy,
            sine * vx + cosine * vy,
            states[..., 4],
        )
        return np.stack(moved, axis=-1)

    def transition(self, states: FloatArray, period: float) -> FloatArray:
        """(..., M, 5, 5)."""
        along, across, d_along, d_across = _turn(states[..., 4], period)
        vx, vy = states[..., 2], states[..., 3]
        angle = period * states[..., 4]
        cosine, sine = np.cos(angle), np.sin(angle)
        step = np.zeros((*states.shape, 5))
        step[..., range(5), range(5)] = 1.0
        step[..., 0, 2], step[..., 0, 3] = along, -across
        step[..., 1, 2], step[..., 1, 3] = across, along
        step[..., 0, 4] = d_along * vx - d_across * vy
        step[..., 1, 4] = d_across * vx + d_along * vy
        step[..., 2, 2], step[..., 2, 3] = cosine, -sine
        step[..., 3, 2], step[..., 3, 3] = sine, cosine
        step[..., 2, 4] = period * (-sine * vx - cosine * vy)
        step[..., 3, 4] = period * (cosine * vx - sine * vy)
        return step

    def noise(self, period: float) -> FloatArray:
        """(M, 5, 5)."""
        noise = np.zeros((len(self.process_std), 5, 5))
        noise[:, :4, :4] = self._planar_noise(period)
        noise[:, 4, 4] = period * self.turn_noise**2
        return noise

    def initial(self, scenario: Scenario) -> Belief:
        """The scenario's estimates, with its speeds, headings and turn rates."""
        moving = _with_velocities(scenario, self.velocity_std)
        rates = np.array([[target.turn_rate] for target in scenario.targets])
        covariance = np.zeros((len(rates), 5, 5))
        covariance[:, :4, :4] = moving.covariance
        covariance[:, 4, 4] = self.turn_std**2
        return Belief.of(np.concatenate([moving.mean, rates], axis=1), covariance)


@dataclass(frozen=True, eq=False, repr=False)
class ConstantVelocity3D(_EstimatedVelocity):
    """States x, y [m], velocity in x and y [m/s], height z [m], climb rate [m/s]; white acceleration on all axes.

    ``process_std``, ``velocity_std`` : as for :class:`ConstantVelocity`.
    """

    dimension: ClassVar[int] = 6

    def predict(self, states: FloatArray, period: float, time: float) -> FloatArray:  # noqa: ARG002
        """(..., M, 6) states one period later."""
        return np.asarray(states @ _step_3d(period).T)

    def transition(self, states: FloatArray, period: float) -> FloatArray:
        """(..., M, 6, 6), the same for all."""
        return np.broadcast_to(_step_3d(period), (*states.shape, 6))

    def noise(self, period: float) -> FloatArray:
        """(M, 6, 6) of white acceleration."""
        noise = np.zeros((len(self.process_std), 6, 6))
        noise[:, :4, :4] = planar = self._planar_noise(period)
        noise[:, 4:, 4:] = planar[:, ::2, ::2]
        return noise

    def initial(self, scenario: Scenario) -> Belief:
        """The scenario's estimates, with its speeds and headings, heights and climb rates."""
        moving = _with_velocities(scenario, self.velocity_std)
        upward = np.array([(target.z, target.climb) for target in scenario.targets])
        covariance = np.array([target.state_covariance(6, self.velocity_std) for target in scenario.targets])
        return Belief.of(np.concatenate([moving.mean, upward], axis=1), covariance)


def _step_3d(period: float) -> FloatArray:
    step = np.eye(6)
    step[[0, 1, 4], [2, 3, 5]] = period
    return step


TARGET_MOTIONS: dict[
    str, type[KnownVelocity] | type[ConstantVelocity] | type[ConstantVelocity3D] | type[CoordinatedTurn]
] = {
    "known velocity": KnownVelocity,
    "constant velocity": ConstantVelocity,
    "constant velocity 3d": ConstantVelocity3D,
    "coordinated turn": CoordinatedTurn,
}


def check_motion(motion: str) -> None:
    """InputError : there is no motion of that name."""
    if motion not in TARGET_MOTIONS:
        raise InputError("motion", f"must be {', '.join(TARGET_MOTIONS)} or a TargetMotion", motion)


def target_motion(motion: str | TargetMotion, scenario: Scenario) -> TargetMotion:
    """The motion of that name for a scenario's targets. InputError : there is none."""
    if isinstance(motion, TargetMotion):
        return motion
    check_motion(motion)
    return TARGET_MOTIONS[motion].of(scenario)


def _turn(rate: FloatArray, period: float) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
    """``sin(wT)/w`` and ``(1 - cos(wT))/w`` with their derivatives by ``w``, by series if ``wT`` is small."""
    small = np.abs(rate * period) < 1e-4  # the error of the series is then below 1e-13
    w = np.where(small, 1.0, rate)
    sine, cosine = np.sin(w * period), np.cos(w * period)
    square = (rate * period) ** 2
    along = np.where(small, period * (1 - square / 6), sine / w)
    across = np.where(small, period * (rate * period / 2), (1 - cosine) / w)
    d_along = np.where(small, -(period**2) * (rate * period / 3), (period * cosine - sine / w) / w)
    d_across = np.where(small, period**2 / 2 * (1 - square / 4), (period * sine - (1 - cosine) / w) / w)
    return along, across, d_along, d_across


def _cells(time: float, period: float, cell: float) -> tuple[FloatArray, FloatArray]:
    """Numbers (C,) of the sampling periods that ``[time, time + period]`` touches, and seconds (C,) spent in each."""
    on_grid = 1e-9  # times within this share of a period count as its end
    first = int(np.floor(time / cell + on_grid))
    last = max(int(np.ceil((time + period) / cell - on_grid)), first + 1)
    cells = np.arange(first, last, dtype=np.float64)
    if len(cells) == 1:
        return cells, np.array([period])
    spans = np.full(len(cells), cell)
    spans[0] = (first + 1) * cell - time
    spans[-1] = period - spans[:-1].sum()
    return cells, spans


def _process_std(scenario: Scenario) -> FloatArray:
    """(M,) by how much white acceleration moves a target's position in a sampling period [m]."""
    return readonly(np.sqrt(scenario.acceleration_density * scenario.sampling_period**3 / 3))


def _positions(scenario: Scenario) -> Belief:
    means = np.array([(target.x, target.y) for target in scenario.targets])
    return Belief.of(means, np.array([target.state_covariance(2) for target in scenario.targets]))


def _with_velocities(scenario: Scenario, velocity_std: float) -> Belief:
    known = _positions(scenario)
    speed, heading = np.array([(target.speed, target.heading) for target in scenario.targets]).T
    velocity = speed[:, None] * np.stack([np.cos(heading), np.sin(heading)], axis=-1)
    covariance = np.array([target.state_covariance(4, velocity_std) for target in scenario.targets])
    return Belief.of(np.concatenate([known.mean, velocity], axis=1), covariance)
