"""A range-and-bearing sensor's noise law and outlier gate, estimated from residuals.

Errors are taken for a mixture: Gaussian with probability ``1 - outliers``, of standard deviations or variances that
grow linearly (range with range, bearing with ``|bearing|``), else anywhere in the box of all errors seen. Expectation
and maximisation in turn (Dempster, Laird, Rubin 1977) estimate both; of the two laws the likelier one is kept.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Literal

import numpy as np

from ratt_opt._validation import FloatArray, check_finite
from ratt_opt.errors import InputError
from ratt_opt.scenario.mrclam import LONGEST_GAP
from ratt_opt.scenario.mrclam_labels import pose_at
from ratt_opt.scenario.mrclam_reader import MrclamData, opened_mrclam
from ratt_opt.scenario.record import Positive, Text
from ratt_opt.scenario.sensor import Sensor, measure, wrap_angle

if TYPE_CHECKING:
    from collections.abc import Mapping

    from numpy.typing import ArrayLike

__all__ = ["FitParams", "FittedSensor", "Residuals", "fit_sensor", "mrclam_residuals"]


@dataclass(frozen=True, slots=True, kw_only=True)
class FitParams:
    """Parameters of an estimate of a sensor's noise.

    ``rounds`` : of expectation and maximisation; after some ten the fourth digit of the noise no longer moves
    ``smallest`` : standard deviation or variance, at least, so that a perfect sensor has a likelihood
    ``fewest`` : residuals that are enough for an estimate
    ``outliers`` : share of measurements that the first guess takes for outliers
    """

    rounds: int = 30
    smallest: float = 1e-9
    fewest: int = 20
    outliers: float = 0.05

    def __post_init__(self) -> None:
        """Check what no estimate could be made with. ``InputError`` : a number is out of its range."""
        for name in ("rounds", "fewest"):
            if not (value := getattr(self, name)) >= 1:
                raise InputError(f"params.{name}", "must be at least 1", value)
        if not self.smallest > 0:
            raise InputError("params.smallest", "must be positive", self.smallest)
        if not 0 < self.outliers < 1:
            raise InputError("params.outliers", "must be between 0 and 1", self.outliers)


DEFAULT = FitParams()


class FittedSensor(Sensor):
    """A sensor fitted to data, with the outliers of the data.

    ``outliers`` : share of measurements that the Gaussian does not explain; ``gate`` : normalised squared error of
    range and bearing together, above which a measurement is more likely an outlier. ``labels`` : which labelling of a
    dataset's landmarks it was fitted with, and who decided that.
    """

    outliers: float = 0.0
    gate: Positive = 1e12
    labels: Text = ""


@dataclass(frozen=True, slots=True, eq=False)
class Residuals:
    """(L,) measured ranges [m] and bearings [rad] as expected, and the measurements' errors."""

    distance: FloatArray
    bearing: FloatArray
    range_error: FloatArray
    bearing_error: FloatArray


def mrclam_residuals(data: MrclamData, *, until: float | None = None, since: float | None = None) -> Residuals:
    """Errors of all sightings of landmarks, against positions surveyed and poses interpolated.

    ``since``, ``until`` : Unix times [s] between which sightings count; all by default.
    """
    low, high = -np.inf if since is None else since, np.inf if until is None else until
    expected, errors = [], []
    for poses, rows in zip(data.poses, data.measurements, strict=True):
        subjects = np.array([data.subject_of.get(int(code), -1) for code in rows[:, 1]])
        usable = np.isin(subjects, list(data.landmarks)) & (rows[:, 0] >= low) & (rows[:, 0] < high)
        usable &= (rows[:, 0] >= poses[0, 0]) & (rows[:, 0] <= poses[-1, 0])
        after = np.clip(np.searchsorted(poses[:, 0], rows[:, 0]), 1, len(poses) - 1)
        usable &= poses[after, 0] - poses[after - 1, 0] <= LONGEST_GAP
        if not usable.any():
            continue
        places = np.array([data.landmarks[int(subject)] for subject in subjects[usable]])
        ideal = measure(pose_at(poses, rows[usable, 0]), places)
        expected.append(ideal)
        errors.append(np.stack([rows[usable, 2] - ideal[:, 0], wrap_angle(rows[usable, 3] - ideal[:, 1])], axis=-1))
    if not expected:
        raise InputError("data", "must hold sightings of landmarks at known poses", "none")
    ideal, error = np.concatenate(expected), np.concatenate(errors)
    return Residuals(ideal[:, 0], ideal[:, 1], error[:, 0], error[:, 1])


def fit_sensor(
    distance: ArrayLike | Residuals | MrclamData | str | Path,
    bearing: ArrayLike | None = None,
    range_error: ArrayLike | None = None,
    bearing_error: ArrayLike | None = None,
    *,
    corrections: Mapping[int, int] | None = None,
    params: FitParams = DEFAULT,
) -> FittedSensor:
    """Estimate the noise law, its coefficients, the share of outliers and the gate.

    Parameters
    ----------
    distance : (L,) true ranges [m]; or all four as :class:`Residuals`; or a dataset or its folder, whose residuals
        are taken
    bearing : (L,) true bearings [rad]
    range_error, bearing_error : (L,) measured minus true [m], [rad]
    corrections : of a folder's labels, see :func:`read_mrclam`; by default the sightings decide, and ``labels`` of the
        result says what
    params : rounds of the estimate, and the residuals that it needs

    The reach is not estimated: a target that was never seen may have been out of reach or absent.

    Raises
    ------
    InputError : fewer residuals than ``params.fewest``, lengths that differ, a number that is not finite, or
        corrections without a folder.
    FileFormatError : a file of the folder is missing or malformed.
    """
    data = None
    if isinstance(distance, (str, Path, MrclamData)):
        data = distance = opened_mrclam(distance, corrections)
    elif corrections is not None:
        raise InputError("corrections", "must come with a dataset's folder", dict(corrections))
    given = _residuals(distance, bearing, range_error, bearing_error, params.fewest)
    fits = [_Fit.of(given, law, params) for law in ("std", "variance")]
    best = max(fits, key=lambda fit: fit.likelihood)
    (a, b), (c, d) = best.of_range, best.of_bearing
    return FittedSensor(
        law=best.law,
        range_noise=a,
        range_noise_slope=b,
        bearing_noise=c,
        bearing_noise_slope=d,
        outliers=best.outliers,
        gate=best.gate(given),
        labels="" if data is None else data.labels,
    )


def _residuals(
    first: ArrayLike | Residuals | MrclamData, bearing: object, range_error: object, bearing_error: object, fewest: int
) -> Residuals:
    if isinstance(first, Residuals):
        found = first
    elif isinstance(first, MrclamData):
        found = mrclam_residuals(first)
    else:
        names = ("distance", "bearing", "range_error", "bearing_error")
        values = (first, bearing, range_error, bearing_error)
        found = Residuals(*(check_finite(n, v, ndim=1) for n, v in zip(names, values, strict=True)))
    lengths = {len(found.distance), len(found.bearing), len(found.range_error), len(found.bearing_error)}
    if len(lengths) > 1 or min(lengths) < fewest:
        raise InputError("residuals", f"must be of one length, at least {fewest}", sorted(lengths))
    return found


@dataclass(frozen=True, slots=True, eq=False)
class _Fit:
    law: Literal["std", "variance"]
    of_range: tuple[float, float]
    of_bearing: tuple[float, float]
    outliers: float
    likelihood: float
    box: float

    @classmethod
    def of(cls, r: Residuals, law: Literal["std", "variance"], params: FitParams) -> _Fit:
        """Expectation and maximisation, from robust first guesses."""
        smallest = params.smallest
        box = max(float(np.ptp(r.range_error) * np.ptp(r.bearing_error)), smallest)
        x, y = r.distance, np.abs(r.bearing)
        power = 1 if law == "std" else 2
        first = [max(1.4826 * float(np.median(np.abs(e))), smallest) ** power for e in (r.range_error, r.bearing_error)]
        of_range, of_bearing, outliers = (first[0], 0.0), (first[1], 0.0), params.outliers
        likelihood = -np.inf
        for _ in range(params.rounds):
            inside = (1 - outliers) * _density(r.range_error, _std(of_range, x, law))
            inside *= _density(r.bearing_error, _std(of_bearing, y, law))
            both = inside + outliers / box
            share = inside / both
            likelihood = float(np.log(both).sum())
            outliers = min(max(1 - float(share.mean()), 1e-6), 0.5)
            of_range = _maximised(r.range_error, x, share, of_range, law, smallest)
            of_bearing = _maximised(r.bearing_error, y, share, of_bearing, law, smallest)
        return cls(law, of_range, of_bearing, outliers, likelihood, box)

    def gate(self, r: Residuals) -> float:
        """The point at which both densities are equal, at the median geometry; at least the 95 % ellipse."""
        range_std = float(_std(self.of_range, np.median(r.distance, keepdims=True), self.law)[0])
        bearing_std = float(_std(self.of_bearing, np.median(np.abs(r.bearing), keepdims=True), self.law)[0])
        odds = (1 - self.outliers) * self.box / (2 * np.pi * range_std * bearing_std * self.outliers)
        return max(2 * float(np.log(max(odds, 1.0))), 5.99)


def _std(law_of: tuple[float, float], x: FloatArray, law: str) -> FloatArray:
    linear = law_of[0] + law_of[1] * x
    return np.asarray(linear if law == "std" else np.sqrt(linear))


def _density(error: FloatArray, std: FloatArray) -> FloatArray:
    return np.asarray(np.exp(-0.5 * (error / std) ** 2) / (np.sqrt(2 * np.pi) * std))


def _maximised(  # noqa: PLR0917
    error: FloatArray, x: FloatArray, share: FloatArray, start: tuple[float, float], law: str, smallest: float
) -> tuple[float, float]:
    """Constant and slope that maximise the weighted likelihood, neither negative."""
    from scipy.optimize import minimize

    scale = max(start[0], smallest)
    squared = error**2

    def loss(z: FloatArray) -> tuple[float, FloatArray]:
        linear = scale * (z[0] + z[1] * x)
        variance = linear**2 if law == "std" else linear
        slope = share * (1 / variance - squared / variance**2) / 2 * (2 * linear if law == "std" else 1.0)
        value = float((share * (np.log(variance) + squared / variance)).sum()) / 2
        return value, scale * np.array([slope.sum(), (slope * x).sum()])

    found = minimize(loss, [1.0, start[1] / scale], jac=True, method="L-BFGS-B", bounds=[(1e-3, None), (0, None)])
    return max(float(found.x[0]) * scale, smallest), float(found.x[1]) * scale
