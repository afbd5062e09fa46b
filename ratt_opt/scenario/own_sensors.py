"""Sensors whose class replaces what a :class:`Sensor` does: no file can name their behaviour."""

from __future__ import annotations

from inspect import isfunction
from typing import TYPE_CHECKING

from ratt_opt.scenario.sensor import Sensor

if TYPE_CHECKING:
    from ratt_opt.scenario.model import Scenario

__all__ = ["own_sensors", "replaced_methods", "tells_itself"]


def replaced_methods(sensor: Sensor) -> tuple[str, ...]:
    """Names of the public methods of :class:`Sensor` that the sensor's own class replaces."""
    known = {name: method for name, method in vars(Sensor).items() if isfunction(method) and not name.startswith("_")}
    return tuple(name for name, method in known.items() if getattr(type(sensor), name) is not method)


def tells_itself(sensor: Sensor) -> bool:
    """Whether the sensor states its information itself, whatever its noise fields say."""
    return "information" in replaced_methods(sensor)


def own_sensors(scenario: Scenario) -> dict[str, str]:
    """Fields of a scenario that hold a sensor with behaviour of its own, and in words which."""
    fields = {"sensor": scenario.sensor}
    fields |= {f"robots[{i}].sensor": own for i, robot in enumerate(scenario.robots) if (own := robot.sensor)}
    found = {name: (type(sensor).__name__, replaced_methods(sensor)) for name, sensor in fields.items()}
    return {name: f"{kind} with its own {', '.join(own)}" for name, (kind, own) in found.items() if own}
