"""One time step as it could really happen: true targets, noisy measurements, and the EKF update of a group."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from ratt_opt._validation import check_distinct, check_integer, readonly
from ratt_opt.errors import InputError
from ratt_opt.scenario.own_sensors import states_information
from ratt_opt.scenario.sensors.model import SensorModel
from ratt_opt.scenario.sensors.range_bearing import RangeBearing

if TYPE_CHECKING:
    from collections.abc import Iterable

    from numpy.typing import ArrayLike

    from ratt_opt._validation import FloatArray, IntArray
    from ratt_opt.scenario.model import Scenario
    from ratt_opt.scenario.sensor import Sensor

__all__ = ["Tracking", "simulate_tracking"]


@dataclass(frozen=True, slots=True, kw_only=True)
class Tracking:
    """Knowledge of a group of robots about the targets after one step, in each of ``D`` draws.

    ``truth`` : (D, M, 2) true positions [m], drawn from the predicted distribution.
    ``estimates`` : (D, M, 2) EKF estimates [m].
    ``covariances`` : (D, M, 2, 2) the EKF's own posterior covariances [m^2].
    """

    truth: FloatArray
    estimates: FloatArray
    covariances: FloatArray

    @property
    def mse(self) -> float:
        """Mean squared distance of estimate and truth, over draws and targets [m^2]."""
        return float(((self.estimates - self.truth) ** 2).sum(axis=-1).mean())

    @property
    def trace(self) -> float:
        """Mean trace of the posterior covariances, over draws and targets [m^2]."""
        return float(np.trace(self.covariances, axis1=-2, axis2=-1).mean())


def simulate_tracking(
    scenario: Scenario, elements: ArrayLike, robots: Iterable[int], *, seed: int, draws: int = 1
) -> Tracking:
    """Draw true target positions and measurements, and update the EKF with the measurements of ``robots``.

    The truth comes from the predicted distribution of every target. Robot ``i`` of ``robots`` moves by its chosen
    control and measures with the sensor's noise at the true geometry; the filter assumes the noise and the Jacobian at
    the predicted position, as the plan does. A measurement exists if the sensor sees the true position, even if the
    target was expected elsewhere. The random numbers of a robot depend on ``seed`` only: plans and groups are compared
    on the same luck.

    Parameters
    ----------
    scenario : N robots, M targets
    elements : (N,) element chosen for each robot
    robots : robots whose measurements are pooled, e.g. ``Problem.best_group``
    seed : integer >= 0
    draws : independent repetitions D >= 1

    Raises
    ------
    InputError : ``elements`` is not a plan, a robot does not exist, ``seed`` or ``draws`` is out of range, or a sensor
        states its own information, from which no measurement can be drawn here (:func:`run_mission` can).

    Source: ratt.tex, Section VI, sensor model and MSE; Joseph form of the covariance update.
    """
    rng = np.random.default_rng(check_integer("seed", seed, low=0))
    check_integer("draws", draws, low=1)
    group = sorted(
        check_distinct("robot", (check_integer("robot", i, low=0, high=scenario.n_robots - 1) for i in robots))
    )
    poses = scenario.predicted_poses[_check_plan(elements, scenario.robot, scenario.n_robots)]
    predicted, prior = scenario.predicted_states, scenario.prior
    truth = predicted + _correlated(rng.standard_normal((draws, *predicted.shape)), prior)
    sensors = [robot.sensor or scenario.sensor for robot in scenario.robots]
    numbers = max(2, *(getattr(sensor, "size", 2) for sensor in sensors))
    luck = rng.standard_normal((scenario.n_robots, *truth.shape[:-1], numbers))
    estimates, covariances = np.broadcast_to(predicted, truth.shape), np.broadcast_to(prior, (draws, *prior.shape))
    for i in group:
        sensor, pose = _model(sensors[i], i), poses[i]
        r = sensor.reads
        real, expected = truth[..., :r], predicted[..., :r]
        noisy = sensor.measure(pose, real) + np.sqrt(sensor.noise(pose, real)) * luck[i][..., : sensor.size]
        surprise = sensor.surprise(noisy, sensor.measure(pose, expected))
        # Every measurement is linearised at the prediction, as the plan does; the mean has moved since.
        slope = np.zeros((len(predicted), sensor.size, predicted.shape[1]))
        slope[..., :r] = sensor.jacobian(pose, expected)
        surprise -= np.einsum("mij,dmj->dmi", slope, estimates - predicted)
        noise = sensor.noise(pose, expected)[:, None, :] * np.eye(sensor.size)
        seen = sensor.sees(pose, real)
        gain = _gain(covariances, slope, noise) * seen[..., None, None]
        estimates = estimates + np.einsum("dmij,dmj->dmi", gain, surprise)
        covariances = _joseph(covariances, gain, slope, noise)
    return Tracking(
        truth=readonly(truth[..., :2]),
        estimates=readonly(estimates[..., :2]),
        covariances=readonly(covariances[..., :2, :2]),
    )


def _model(sensor: Sensor | SensorModel, robot: int) -> SensorModel:
    """A robot's sensor as a model. InputError : it states its own information."""
    if isinstance(sensor, SensorModel):
        return sensor
    if states_information(sensor):
        raise InputError(f"sensor of robots[{robot}]", "must not state its own information", type(sensor).__name__)
    return RangeBearing(sensor)


def _check_plan(elements: ArrayLike, robot: IntArray, n_robots: int) -> IntArray:
    plan = np.asarray(elements)
    if plan.shape != (n_robots,) or plan.dtype.kind not in "iu" or not set(plan.tolist()) <= set(range(len(robot))):
        raise InputError("elements", f"must hold one element for each of {n_robots} robots", plan.tolist())
    if not np.array_equal(robot[plan], np.arange(n_robots)):
        raise InputError("elements", "must hold an element of every robot, robot by robot", plan.tolist())
    return plan


def _correlated(standard: FloatArray, covariance: FloatArray) -> FloatArray:
    """Turn standard normal numbers (D, M, d) into numbers of the given covariances (M, d, d)."""
    return np.asarray(np.einsum("mij,dmj->dmi", np.linalg.cholesky(covariance), standard))


def _gain(covariances: FloatArray, jacobian: FloatArray, noise: FloatArray) -> FloatArray:
    """(D, M, d, z) Kalman gain."""
    transposed = np.swapaxes(jacobian, -1, -2)
    return np.asarray(covariances @ transposed @ np.linalg.inv(jacobian @ covariances @ transposed + noise))


def _joseph(covariances: FloatArray, gain: FloatArray, jacobian: FloatArray, noise: FloatArray) -> FloatArray:
    """(D, M, d, d) ``(I - K H) P (I - K H)' + K R K'``: positive definite under rounding, for any gain ``K``."""
    keep = np.eye(covariances.shape[-1]) - gain @ jacobian
    return np.asarray(keep @ covariances @ np.swapaxes(keep, -1, -2) + gain @ noise @ np.swapaxes(gain, -1, -2))
