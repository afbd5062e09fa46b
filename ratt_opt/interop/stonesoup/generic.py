"""Information of any other sensor, by Stone Soup's own objects: slower, one pose and one target at a time."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from stonesoup.functions import jacobian as numerical_jacobian
from stonesoup.models.base import LinearModel, Model
from stonesoup.types.groundtruth import GroundTruthState
from stonesoup.types.state import State
from stonesoup.updater.kalman import ExtendedKalmanUpdater, KalmanUpdater

from ratt_opt.errors import InputError

if TYPE_CHECKING:
    from ratt_opt._validation import FloatArray
    from ratt_opt.interop.stonesoup.forecast import Forecast

__all__ = ["information", "linearises_by_jacobian", "note_of"]


def linearises_by_jacobian(updater: Any) -> bool:
    """Tell whether this updater uses Jacobians (or there is none); others linearise by their own points."""
    by_points = isinstance(updater, KalmanUpdater) and not isinstance(updater, ExtendedKalmanUpdater)
    return not by_points or type(updater) is KalmanUpdater


def note_of(sensor: Any, updater: Any) -> str | None:
    """Say so if the sensor's model states no Jacobian, and is differentiated numerically."""
    model = sensor.measurement_model
    own = getattr(type(model), "jacobian", None)
    if isinstance(model, LinearModel) or own not in (None, Model.jacobian) or not linearises_by_jacobian(updater):
        return None
    return f"{type(model).__name__} of {type(sensor).__name__} states no Jacobian: differentiated numerically"


def information(sensor: Any, forecast: Forecast, updater: Any) -> FloatArray:
    """(M, D, D) information of the sensor as it stands; 0 for what it does not detect.

    Raises
    ------
    InputError : it has no measurement model, or its model does not fit the states.
    """
    found = np.zeros_like(forecast.covariances)
    try:
        model = sensor.measurement_model
    except NotImplementedError:
        rule = "must have a measurement model (of a suite, give the sensors one by one)"
        raise InputError("sensors", rule, type(sensor).__name__) from None
    for j, (prediction, n) in enumerate(zip(forecast.predictions, forecast.sizes, strict=True)):
        mean = prediction.mean
        if not _detects(sensor, model, GroundTruthState(mean, timestamp=prediction.timestamp)):
            continue
        matrix, noise = _linearised(model, prediction, forecast.covariances[j, :n, :n], updater)
        if matrix.shape[1] != n:
            rule = f"must measure states of {n} dimensions, as the tracks have"
            raise InputError(f"measurement model of {type(sensor).__name__}", rule, matrix.shape[1])
        found[j, :n, :n] = matrix.T @ np.linalg.solve(noise, matrix)
    return (found + np.swapaxes(found, -1, -2)) / 2


def _detects(sensor: Any, model: Any, truth: Any) -> bool:
    if hasattr(sensor, "is_detectable"):
        return bool(np.all(sensor.is_detectable(truth, model)))
    if hasattr(sensor, "gen_probability"):  # an AESA radar: what it detects more often than not
        return bool(sensor.gen_probability(truth)[0] >= 0.5)
    return bool(sensor.measure({truth}, noise=False))


def _linearised(model: Any, prediction: Any, covariance: FloatArray, updater: Any) -> tuple[FloatArray, FloatArray]:
    """A matrix ``H`` and a noise ``R`` with which the linear update is this updater's.

    If the updater works with points (unscented, cubature), its predicted measurement of covariance ``S`` and cross
    covariance ``C`` says ``H = C' P^{-1}`` and ``R = S - H P H'``: then
    ``(P^{-1} + H' R^{-1} H)^{-1} = P - C S^{-1} C'``.
    """
    if not linearises_by_jacobian(updater):
        predicted = updater.predict_measurement(prediction, measurement_model=model)
        matrix = np.linalg.solve(covariance, np.asarray(predicted.cross_covar, dtype=float)).T
        noise = np.asarray(predicted.covar, dtype=float) - matrix @ covariance @ matrix.T
        return matrix, (noise + noise.T) / 2
    state = State(prediction.mean, timestamp=prediction.timestamp)
    if isinstance(model, LinearModel):
        matrix = model.matrix()
    elif hasattr(model, "jacobian"):
        matrix = model.jacobian(state)
    else:
        matrix = numerical_jacobian(model.function, state)
    return np.asarray(matrix, dtype=float), np.asarray(model.covar(), dtype=float)
