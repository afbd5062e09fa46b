"""Nodes that take part, in a fixed order, and their options.

Stone Soup keeps platforms, sensors, generators of actions and tracks in sets, whose order changes from run to run;
platforms' names are random. So everything is ordered by its attributes.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from itertools import product
from typing import TYPE_CHECKING, Any

import numpy as np
from ordered_set import OrderedSet
from stonesoup.sensormanager.base import SensorManager

from ratt_opt.errors import InputError

if TYPE_CHECKING:
    from datetime import datetime

    from stonesoup.platform import Platform
    from stonesoup.sensor.sensor import Sensor
    from stonesoup.sensormanager.action import Action

__all__ = ["Node", "Option", "TeamManager", "default_option", "in_order", "nodes_of", "options", "title"]

Option = tuple["Action", ...]
"""Choice of one platform or sensor: an action for each of its actionable properties."""


@dataclass(frozen=True, slots=True, eq=False)
class Node:
    """A platform with the sensors it carries, or a sensor of its own: blinded as one, linked as one."""

    platform: Platform | None
    sensors: tuple[Sensor, ...]

    @property
    def actionables(self) -> tuple[Any, ...]:
        """The platform, if there is one, and the sensors."""
        return self.sensors if self.platform is None else (self.platform, *self.sensors)

    @property
    def name(self) -> Any:
        """The object that stands for the node: the platform, or the sensor."""
        return self.actionables[0]


def title(actionable: object) -> str:
    """Name of a platform or sensor in errors: its class and where it is."""
    position = getattr(actionable, "position", None)
    place = "" if position is None else f" at {np.round(np.asarray(position, dtype=float).ravel(), 3).tolist()}"
    return f"{type(actionable).__name__}{place}"


def in_order(actionables: Iterable[Any]) -> list[Any]:
    """A list or ordered set as it is; a set by class, position and then every other number or text of its members."""
    if isinstance(actionables, (Sequence, OrderedSet)):
        return list(actionables)
    return sorted(actionables, key=_description)


def nodes_of(platforms: Iterable[Any], sensors: Iterable[Any]) -> tuple[Node, ...]:
    """Platforms with those of the sensors that they carry, then the sensors that stand alone.

    Raises
    ------
    InputError : there are none, or a sensor has no position.
    """
    platforms, sensors = in_order(platforms), in_order(sensors)
    for sensor in sensors:
        if sensor.movement_controller is None:
            rule = "must have a position: add the sensor to a platform, or give it position="
            raise InputError("sensors", rule, type(sensor).__name__)
    managed = {id(sensor) for sensor in sensors}
    carried = [tuple(sensor for sensor in platform.sensors if id(sensor) in managed) for platform in platforms]
    mounted = {id(sensor) for group in carried for sensor in group}
    alone = [Node(None, (sensor,)) for sensor in sensors if id(sensor) not in mounted]
    nodes = (*map(Node, platforms, carried), *alone)
    if not any(node.sensors for node in nodes):
        raise InputError("platforms and sensors", "must hold a sensor", f"{len(nodes)} platforms without any")
    return nodes


class TeamManager(SensorManager):
    """A manager whose platforms and sensors keep their order: a list's, or, for a set, that of their attributes."""

    def __init__(self, *args: Any, **kwargs: Any) -> None:
        super().__init__(*args, **kwargs)
        self.platforms: Any = OrderedSet(in_order(self.platforms))
        self._property_sensors: Any = OrderedSet(in_order(self._property_sensors))

    @property
    def nodes(self) -> tuple[Node, ...]:
        """Nodes that can be blinded, in order: platforms with their sensors, then sensors that stand alone."""
        return nodes_of(self.platforms, self.sensors)


def options(actionable: Any, timestamp: datetime) -> list[Option]:
    """Every combination of the actions that end at ``timestamp``; one empty option if it has no actionable property.

    Raises
    ------
    InputError : a generator offers no action.
    """
    generators = [(generator.attribute, list(generator)) for generator in _generators(actionable, timestamp)]
    for attribute, actions in generators:
        if not actions:
            raise InputError(title(actionable), f"must have an action for its {attribute}", "none")
    return list(product(*(actions for _, actions in generators)))


def default_option(actionable: Any, timestamp: datetime) -> Option:
    """Default action, or the first one of generators that have no default."""
    generators = _generators(actionable, timestamp)
    return tuple(getattr(generator, "default_action", None) or next(iter(generator)) for generator in generators)


def _generators(actionable: Any, timestamp: datetime) -> list[Any]:
    return sorted(actionable.actions(timestamp), key=lambda generator: str(generator.attribute))


def _description(actionable: Any) -> tuple[Any, ...]:
    controller = getattr(actionable, "movement_controller", None)
    place = [] if controller is None else np.asarray(controller.state_vector, dtype=float).ravel().tolist()
    carried = tuple(map(_description, getattr(actionable, "sensors", ())))
    return type(actionable).__qualname__, place, _numbers(actionable), _numbers(controller), carried


def _numbers(owner: Any) -> str:
    """Write the owner's attributes that are numbers, arrays or text, without its random name."""
    names = [name for name in getattr(type(owner), "properties", ()) if name not in ("id", "states")]
    values = [(name, getattr(owner, f"_property_{name}", None)) for name in sorted(names)]
    return repr([(name, np.asarray(v).tolist()) for name, v in values if isinstance(v, (int, float, str, np.ndarray))])
