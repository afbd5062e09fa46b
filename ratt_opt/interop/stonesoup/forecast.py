"""Predictions of the tracks at one time, in an order that does not depend on the run."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from ratt_opt.errors import InputError

if TYPE_CHECKING:
    from datetime import datetime

    from ratt_opt._validation import FloatArray

__all__ = ["Forecast"]


@dataclass(frozen=True, slots=True, eq=False)
class Forecast:
    """``predictions`` of the ``tracks``, with ``means`` (M, D) and ``covariances`` (M, D, D).

    Tracks may have states of different sizes ``sizes`` (M,); the rest of their rows is 0.
    """

    tracks: tuple[Any, ...]
    predictions: tuple[Any, ...]
    sizes: tuple[int, ...]
    means: FloatArray
    covariances: FloatArray

    @classmethod
    def of(cls, tracks: Iterable[Any], predictor: Any, timestamp: datetime) -> Forecast:
        """Predict every track; without a predictor their states count as they are.

        A list keeps its order; a set is ordered by the states.

        Raises
        ------
        InputError : a prediction has no mean or covariance, or one that is not finite.
        """
        ordered = list(tracks) if isinstance(tracks, Sequence) else sorted(tracks, key=_place)
        states = [
            track[-1] if predictor is None else predictor.predict(track, timestamp=timestamp) for track in ordered
        ]
        moments = [_moments(state) for state in states]
        sizes = tuple(len(mean) for mean, _ in moments)
        largest = max(sizes, default=0)
        means, covariances = np.zeros((len(sizes), largest)), np.zeros((len(sizes), largest, largest))
        for j, (mean, covariance) in enumerate(moments):
            means[j, : sizes[j]], covariances[j, : sizes[j], : sizes[j]] = mean, covariance
        return cls(tuple(ordered), tuple(states), sizes, means, covariances)


def _place(track: Any) -> list[float]:
    mean, covariance = _moments(track[-1])
    return [*mean.tolist(), *covariance.ravel().tolist()]


def _moments(state: Any) -> tuple[FloatArray, FloatArray]:
    mean, covariance = getattr(state, "mean", None), getattr(state, "covar", None)
    if mean is None or covariance is None:
        rule = "must have states with a mean and a covariance (covar), as GaussianState"
        raise InputError("tracks", rule, type(state).__name__)
    moments = np.asarray(mean, dtype=float).ravel(), np.asarray(covariance, dtype=float)
    if not all(np.isfinite(part).all() for part in moments):
        raise InputError("tracks", "must have finite means and covariances", type(state).__name__)
    return moments
