"""Random teams of Stone Soup's platforms, sensors and tracks, in the plane and in space."""

import datetime
from dataclasses import dataclass
from typing import Any

import numpy as np
from stonesoup.base import Property
from stonesoup.models.measurement.linear import LinearGaussian
from stonesoup.models.transition.linear import (
    CombinedLinearGaussianTransitionModel,
    ConstantAcceleration,
    ConstantVelocity,
    KnownTurnRate,
    RandomWalk,
)
from stonesoup.movable.grid import NStepDirectionalGridMovable
from stonesoup.movable.max_speed import MaxSpeedActionableMovable
from stonesoup.platform import FixedPlatform, MovingPlatform
from stonesoup.predictor.kalman import KalmanPredictor
from stonesoup.sensor.passive import PassiveElevationBearing
from stonesoup.sensor.radar.radar import (
    RadarBearing,
    RadarBearingRange,
    RadarBearingRangeRate2D,
    RadarElevationBearingRange,
    RadarRasterScanBearingRange,
    RadarRotatingBearing,
    RadarRotatingBearingRange,
    RadarRotatingElevationBearingRange,
)
from stonesoup.sensor.sensor import SimpleSensor
from stonesoup.types.state import GaussianState, State, StateVector
from stonesoup.types.track import Track

START = datetime.datetime(2024, 1, 1)
NEXT = START + datetime.timedelta(seconds=1)


class PositionSensor(SimpleSensor):
    """A sensor of somebody's own: positions within a radius, by a linear model."""

    ndim_state: int = Property()
    mapping: Any = Property()
    noise_covar: Any = Property()
    radius: float = Property(default=40.0)

    @property
    def measurement_model(self) -> Any:
        return LinearGaussian(self.ndim_state, self.mapping, self.noise_covar)

    def is_detectable(self, state: Any, measurement_model: Any = None) -> bool:  # noqa: ARG002
        apart = state.state_vector[self.mapping, :] - self.position[: len(self.mapping)]
        return bool(np.linalg.norm(np.asarray(apart, dtype=float)) <= self.radius)

    def is_clutter_detectable(self, state: Any) -> bool:  # noqa: ARG002
        return True


class OwnRadar(RadarRotatingBearingRange):
    """A subclass may see otherwise, so it is asked itself."""


@dataclass
class ByLength:
    """One predictor for each kind of track."""

    predictors: dict[int, Any]

    def predict(self, track: Any, timestamp: Any) -> Any:
        return self.predictors[len(track.state_vector)].predict(track, timestamp=timestamp)


PLANAR = {
    "velocity": ([ConstantVelocity(0.1)] * 2, (0, 2)),
    "acceleration": ([ConstantAcceleration(0.1)] * 2, (0, 3)),
    "walk": ([RandomWalk(0.5)] * 2, (0, 1)),
}
SPATIAL = {"velocity": ([ConstantVelocity(0.1)] * 3, (0, 2, 4)), "walk": ([RandomWalk(0.5)] * 3, (0, 1, 2))}


def predictor_of(models: Any) -> Any:
    return KalmanPredictor(CombinedLinearGaussianTransitionModel(list(models)))


def random_track(rng: np.random.Generator, ndim: int, mapping: tuple[int, ...], side: float = 60.0) -> Track:
    mean = rng.normal(0, 1, ndim)
    mean[list(mapping)] = rng.uniform(0, side, len(mapping))
    if len(mapping) == 3:
        mean[mapping[2]] = rng.uniform(0, side / 3)
    root = rng.normal(0, 1, (ndim, ndim)) + 2 * np.eye(ndim)
    return Track([GaussianState(mean, root @ root.T, timestamp=START)])


def radar(rng: np.random.Generator, mapping: Any, ndim: int, *, fov: float = 90.0, dwells: int = 6, **more: Any) -> Any:
    sensor = more.pop("kind", RadarRotatingBearingRange)(
        position_mapping=mapping,
        ndim_state=ndim,
        noise_covar=np.diag([np.radians(rng.uniform(0.5, 2)) ** 2, rng.uniform(0.3, 2)]),
        dwell_centre=StateVector([rng.uniform(-3, 3)]),
        rpm=30,
        resolution=2 * np.pi / dwells,
        max_range=rng.uniform(30, 80),
        fov_angle=np.radians(fov),
        **more,
    )
    sensor.timestamp = START
    return sensor


def _planar_sensor(rng: np.random.Generator, kind: type, mapping: Any, ndim: int) -> Any:
    if kind in (RadarRotatingBearingRange, OwnRadar):
        offset = StateVector([0.0, 0.0, rng.uniform(-3, 3)]) if rng.random() < 0.5 else None
        return radar(
            rng, mapping, ndim, kind=kind, rotation_offset=offset, mounting_offset=StateVector(rng.normal(0, 1, 2))
        )
    noise = np.diag([np.radians(rng.uniform(0.5, 2)) ** 2, rng.uniform(0.3, 2), 0.1])
    common = {"position_mapping": mapping, "ndim_state": ndim, "max_range": rng.uniform(30, 80)}
    turning = {"dwell_centre": StateVector([rng.uniform(-3, 3)]), "rpm": 30, "fov_angle": 2.0, "resolution": 1.0}
    match kind.__name__:
        case "RadarBearing":
            sensor = kind(noise_covar=noise[:1, :1], **common)
        case "RadarRotatingBearing":
            sensor = kind(noise_covar=noise[:1, :1], **common, **turning)
        case "RadarBearingRange":
            sensor = kind(noise_covar=np.array([[3e-4, 1e-3], [1e-3, 1.0]]), **common)
        case "RadarRasterScanBearingRange":
            sensor = kind(noise_covar=noise[:2, :2], for_angle=4.0, **common, **turning)
        case "RadarBearingRangeRate2D":
            sensor = kind(noise_covar=noise, velocity_mapping=tuple(m + 1 for m in mapping), **common)
        case _:
            sensor = kind(ndim_state=ndim, mapping=mapping, noise_covar=np.array([[1.0, 0.3], [0.3, 2.0]]))
    sensor.timestamp = START
    return sensor


def _spatial_sensor(rng: np.random.Generator, kind: type, mapping: Any, ndim: int) -> Any:
    noise = np.diag([3e-4, 5e-4, rng.uniform(0.3, 2)])
    common = {"ndim_state": ndim, "mounting_offset": StateVector(rng.normal(0, 1, 3))}
    common["rotation_offset"] = StateVector(rng.uniform(-0.4, 0.4, 3))
    turning = {"dwell_centre": StateVector([rng.uniform(-3, 3)]), "rpm": 20, "resolution": 1.0}
    match kind.__name__:
        case "PassiveElevationBearing":
            sensor = kind(mapping=np.array(mapping), noise_covar=noise[:2, :2], **common)
        case "RadarElevationBearingRange":
            sensor = kind(position_mapping=mapping, noise_covar=noise, max_range=50, **common)
        case "RadarRotatingElevationBearingRange":
            tilt = {"tilt_centre": StateVector([0.1]), "fov_angle": 2.0, "vertical_extent": 1.5}
            sensor = kind(position_mapping=mapping, noise_covar=noise, max_range=60, **common, **turning, **tilt)
        case _:
            common.pop("rotation_offset")
            sensor = kind(position_mapping=mapping, noise_covar=noise[1:, 1:], fov_angle=2.0, **common, **turning)
    sensor.timestamp = START
    return sensor


PLANAR_SENSORS: list[type] = [
    RadarBearing,
    RadarBearingRange,
    RadarRotatingBearing,
    RadarRotatingBearingRange,
    OwnRadar,
    PositionSensor,
    RadarRasterScanBearingRange,
]
SPATIAL_SENSORS: list[type] = [
    PassiveElevationBearing,
    RadarElevationBearingRange,
    RadarRotatingElevationBearingRange,
    RadarRotatingBearingRange,
]


def _platform(rng: np.random.Generator, dim: int, sensors: list[Any]) -> Any:
    place = rng.uniform(0, 60, dim)
    if dim == 3:
        place[2] = rng.uniform(0, 5)
    kind = rng.integers(4)
    if kind == 0:
        return FixedPlatform(states=[State(place, timestamp=START)], position_mapping=range(dim), sensors=sensors)
    if kind == 1:
        state = np.column_stack([place, rng.normal(0, 2, dim)]).ravel()
        where = tuple(range(0, 2 * dim, 2))
        return MovingPlatform(
            states=[State(state, timestamp=START)], position_mapping=where, transition_model=None, sensors=sensors
        )
    controller: Any = NStepDirectionalGridMovable
    more: dict[str, Any] = {"n_steps": 1, "step_size": 2, "resolution": 1.5}
    if kind == 3:
        controller, more = MaxSpeedActionableMovable, {"max_speed": 3.0, "resolution": 1.5}
    movable = controller(states=[State(place, timestamp=START)], position_mapping=range(dim), **more)
    return FixedPlatform(movement_controller=movable, sensors=sensors)


def grid_platform(
    rng: np.random.Generator, sensors: list[Any], n_steps: int = 1, place: tuple[float, float] | None = None
) -> FixedPlatform:
    """It moves on a grid of two metres by at most ``n_steps``, and stays if that is 0."""
    where = rng.uniform(0, 60, 2) if place is None else np.array(place)
    states = [State(StateVector(where), timestamp=START)]
    if n_steps == 0:
        return FixedPlatform(states=states, position_mapping=(0, 1), sensors=sensors)
    movable = NStepDirectionalGridMovable(states=states, position_mapping=(0, 1), resolution=2.0, n_steps=n_steps)
    return FixedPlatform(movement_controller=movable, sensors=sensors)


def random_team(rng: np.random.Generator, n: int, n_tracks: int) -> tuple[list[Any], list[Any], list[Track], Any]:
    """Platforms, sensors that stand alone, tracks and their predictor."""
    if rng.random() < 0.3:
        models, mapping = SPATIAL[str(rng.choice(list(SPATIAL)))]
        draw, kinds = _spatial_sensor, SPATIAL_SENSORS
    else:
        models, mapping = PLANAR[str(rng.choice(list(PLANAR)))]
        draw, kinds = _planar_sensor, PLANAR_SENSORS
        if mapping == (0, 2):
            kinds = [*kinds, RadarBearingRangeRate2D]
    predictor, mixed = predictor_of(models), models == PLANAR["velocity"][0] and rng.random() < 0.5
    if mixed:  # a linear model has states of one length
        kinds = [kind for kind in kinds if kind is not PositionSensor]
    ndim, dim = predictor.transition_model.ndim, len(mapping)
    platforms = []
    for _ in range(n):
        chosen = [kinds[k] for k in rng.integers(len(kinds), size=rng.integers(1, 3))]
        platforms.append(_platform(rng, dim, [draw(rng, kind, mapping, ndim) for kind in chosen]))
    tracks = [random_track(rng, ndim, mapping) for _ in range(n_tracks)]
    if mixed:  # several models: turns with a fifth coordinate too
        turning = KalmanPredictor(
            CombinedLinearGaussianTransitionModel([KnownTurnRate([0.1, 0.1], 0.2), RandomWalk(0.01)])
        )
        tracks[0] = random_track(rng, 5, mapping)
        predictor = ByLength({4: predictor, 5: turning})
    return platforms, [], tracks, predictor
