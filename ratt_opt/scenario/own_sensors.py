"""Sensors whose class replaces what a :class:`Sensor` does: no file can name their behaviour."""

from __future__ import annotations

from inspect import isfunction

from ratt_opt.scenario.sensor import Sensor

__all__ = ["replaced_methods", "states_information"]


def replaced_methods(sensor: Sensor) -> tuple[str, ...]:
    """Names of the public methods of :class:`Sensor` that the sensor's own class replaces."""
    known = {name: method for name, method in vars(Sensor).items() if isfunction(method) and not name.startswith("_")}
    return tuple(name for name, method in known.items() if getattr(type(sensor), name) is not method)


def states_information(sensor: Sensor) -> bool:
    """Tell whether the sensor states its information itself, whatever its noise fields say."""
    return "information" in replaced_methods(sensor)
