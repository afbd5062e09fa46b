"""The position as a measurement, and which robot has which sensor."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import TYPE_CHECKING, ClassVar

import numpy as np

from ratt_opt._validation import readonly
from ratt_opt._values import ByValue
from ratt_opt.errors import InputError
from ratt_opt.missions.models.range_bearing import BearingOnly, RangeBearing, RangeOnly
from ratt_opt.missions.models.sensor_model import SensorModel

if TYPE_CHECKING:
    from collections.abc import Sequence

    from ratt_opt._validation import BoolArray, FloatArray, IntArray
    from ratt_opt.scenario.model import Scenario

__all__ = ["COMPONENTS", "PositionSensor", "check_sensor", "robots_by_sensor", "sensors_of"]


@dataclass(frozen=True, eq=False, repr=False)
class PositionSensor(ByValue, SensorModel):
    """The position x, y [m] itself, with standard deviation ``std`` per axis [m]; ``max_range`` [m] or ``None``."""

    std: float = 1.0
    max_range: float | None = None
    size: ClassVar[int] = 2

    def __post_init__(self) -> None:
        if not self.std > 0:
            raise InputError("std", "must be positive", self.std)

    def measure(self, poses: FloatArray, points: FloatArray) -> FloatArray:
        """(..., 2)."""
        return np.asarray(points + 0.0 * poses[..., :2])

    def jacobian(self, poses: FloatArray, points: FloatArray) -> FloatArray:
        """(..., 2, 2) identities."""
        return np.broadcast_to(np.eye(2), (*np.broadcast_shapes(poses.shape[:-1], points.shape[:-1]), 2, 2))

    def hessian(self, poses: FloatArray, points: FloatArray) -> FloatArray:
        """(..., 2, 2, 2) zeros."""
        return np.zeros((*np.broadcast_shapes(poses.shape[:-1], points.shape[:-1]), 2, 2, 2))

    def noise(self, poses: FloatArray, points: FloatArray) -> FloatArray:
        """(..., 2) [m^2]."""
        return np.full((*np.broadcast_shapes(poses.shape[:-1], points.shape[:-1]), 2), self.std**2)

    def pointed_at(self, poses: FloatArray, measured: FloatArray) -> FloatArray:  # noqa: ARG002
        """(..., 2) what was measured."""
        return measured

    def sees(self, poses: FloatArray, points: FloatArray) -> BoolArray:
        """Within the range."""
        apart = np.linalg.norm(points - poses[..., :2], axis=-1)
        return np.asarray(apart <= (np.inf if self.max_range is None else self.max_range))


COMPONENTS: dict[str, type[RangeBearing]] = {
    "range and bearing": RangeBearing,
    "range": RangeOnly,
    "bearing": BearingOnly,
}
"""What of a scenario's sensors is measured, by name."""


def check_sensor(sensor: object) -> None:
    """InputError : it is neither ``None``, nor a name, nor a SensorModel, nor several of these."""
    several = tuple(sensor) if isinstance(sensor, Iterable) and not isinstance(sensor, str) else (sensor,)
    if sensor is None or (isinstance(sensor, str) and sensor in COMPONENTS):
        return
    if not several or not all(isinstance(one, SensorModel) for one in several):
        shown = sensor if isinstance(sensor, str) else type(sensor).__name__
        raise InputError("sensor", f"must be {', '.join(COMPONENTS)}, a SensorModel, or one for each robot", shown)


def sensors_of(
    scenario: Scenario, sensor: str | SensorModel | Sequence[SensorModel] | None = None
) -> tuple[SensorModel, ...]:
    """Every robot's sensor: the given one, the given ones robot by robot, or the scenario's, by what it measures.

    ``sensor`` : also ``"range and bearing"`` (the default), ``"range"`` or ``"bearing"``

    Raises
    ------
    InputError : ``sensor`` is none of these.
    """
    check_sensor(sensor)
    if sensor is None or isinstance(sensor, str):
        kind = COMPONENTS["range and bearing" if sensor is None else sensor]
        return tuple(kind(robot.sensor or scenario.sensor) for robot in scenario.robots)
    several = tuple(sensor) if isinstance(sensor, Iterable) else ()
    given = (sensor,) * scenario.n_robots if isinstance(sensor, SensorModel) else several
    if len(given) != scenario.n_robots:
        rule = f"must be a SensorModel, or one for each of {scenario.n_robots} robots"
        raise InputError("sensor", rule, type(sensor).__name__)
    return given


def robots_by_sensor(sensors: Sequence[SensorModel]) -> tuple[tuple[SensorModel, IntArray], ...]:
    """Every different sensor with the robots that have one equal to it, both in the order of the robots."""
    different: list[tuple[SensorModel, list[int]]] = []
    for i, sensor in enumerate(sensors):
        robots = next((robots for known, robots in different if known == sensor), None)
        if robots is None:
            different.append((sensor, [i]))
        else:
            robots.append(i)
    return tuple((sensor, readonly(np.array(robots))) for sensor, robots in different)
