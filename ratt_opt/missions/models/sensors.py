"""Sensors of the robots in a mission."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING

import numpy as np

from ratt_opt._validation import readonly
from ratt_opt.errors import InputError
from ratt_opt.scenario.sensor import Sensor
from ratt_opt.scenario.sensors.kinds import made, sensor_kinds
from ratt_opt.scenario.sensors.model import SensorModel
from ratt_opt.scenario.sensors.range_bearing import BearingOnly, RangeBearing, RangeOnly

if TYPE_CHECKING:
    from collections.abc import Sequence

    from ratt_opt._validation import IntArray
    from ratt_opt.scenario.model import Scenario

__all__ = ["COMPONENTS", "check_sensor", "robots_by_sensor", "sensors_of"]


COMPONENTS: dict[str, type[RangeBearing]] = {
    "range and bearing": RangeBearing,
    "range": RangeOnly,
    "bearing": BearingOnly,
}
"""Sensors that measure a part of a scenario's sensor, by name."""


def check_sensor(sensor: object) -> None:
    """InputError : it is neither ``None``, nor a name, nor a sensor, nor several of these."""
    several = tuple(sensor) if isinstance(sensor, Iterable) and not isinstance(sensor, str) else (sensor,)
    if sensor is None or (isinstance(sensor, str) and sensor in COMPONENTS):
        return
    if isinstance(sensor, str) and sensor in sensor_kinds():
        made(sensor, {})
        return
    if not several or not all(isinstance(one, (Sensor, SensorModel)) for one in several):
        shown = sensor if isinstance(sensor, str) else type(sensor).__name__
        known = ", ".join(dict.fromkeys([*COMPONENTS, *sensor_kinds()]))
        raise InputError("sensor", f"must be {known}, a SensorModel, or one for each robot", shown)


def sensors_of(
    scenario: Scenario, sensor: str | Sensor | SensorModel | Sequence[Sensor | SensorModel] | None = None
) -> tuple[SensorModel, ...]:
    """Every robot's sensor: the given one, the given ones robot by robot, or the scenario's, by what it measures.

    ``sensor`` : also ``"range and bearing"`` (the default), ``"range"`` or ``"bearing"``, parts of what the scenario's
    range-and-bearing sensors measure; or a registered kind, as it is without settings

    Raises
    ------
    InputError : ``sensor`` is none of these, or a part of what a sensor of another class measures.
    """
    check_sensor(sensor)
    if sensor is None or (isinstance(sensor, str) and sensor in COMPONENTS):
        return tuple(_part(robot.sensor or scenario.sensor, sensor, i) for i, robot in enumerate(scenario.robots))
    if isinstance(sensor, str):
        sensor = made(sensor, {})
    several = tuple(sensor) if isinstance(sensor, Iterable) and not isinstance(sensor, Sensor) else ()
    given = (sensor,) * scenario.n_robots if isinstance(sensor, (Sensor, SensorModel)) else several
    if len(given) != scenario.n_robots:
        rule = f"must be a SensorModel, or one for each of {scenario.n_robots} robots"
        raise InputError("sensor", rule, type(sensor).__name__)
    return tuple(RangeBearing(one) if isinstance(one, Sensor) else one for one in given)


def _part(own: Sensor | SensorModel, part: str | None, robot: int) -> SensorModel:
    """Select the measured part of a scenario's sensor."""
    if isinstance(own, SensorModel):
        if part is not None:
            rule = f"must be absent, or {type(own).__name__} of robots[{robot}] a range-and-bearing Sensor"
            raise InputError("sensor", rule, part)
        return own
    return COMPONENTS["range and bearing" if part is None else part](own)


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
