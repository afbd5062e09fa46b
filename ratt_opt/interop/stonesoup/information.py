"""Information of every combination of a node's actions about every track."""

from __future__ import annotations

from copy import copy, deepcopy
from math import prod
from typing import TYPE_CHECKING, Any

import numpy as np
from stonesoup.movable import FixedMovable

from ratt_opt.errors import InputError
from ratt_opt.interop.stonesoup import closed_forms, generic
from ratt_opt.interop.stonesoup.nodes import title

if TYPE_CHECKING:
    from collections.abc import Sequence
    from datetime import datetime

    from ratt_opt._validation import FloatArray
    from ratt_opt.interop.stonesoup.forecast import Forecast
    from ratt_opt.interop.stonesoup.nodes import Node, Option

__all__ = ["mapped_by", "node_information", "notes_of"]

Choices = tuple["Sequence[Option | None]", ...]
"""Choices of each platform or sensor of a node; ``None`` leaves it as it stands now."""


def node_information(
    node: Node, choices: Choices, timestamp: datetime, forecast: Forecast, updater: Any = None, *, most: int = 100_000
) -> FloatArray:
    """(K, M, D, D) information of the K combinations of ``choices``, the last of them changing fastest.

    ``most`` : combinations that are accepted; every one holds a matrix for each target.

    Nothing of Stone Soup's objects is moved: actions are carried out by copies.

    Raises
    ------
    InputError : there are too many combinations, or a sensor does not fit the tracks.
    """
    count = prod(map(len, choices))
    if count > most:
        rule = f"must have at most {most} combinations of actions: make their resolution coarser"
        raise InputError(title(node.name), rule, count)
    if node.platform is None:
        controllers, choices = [node.sensors[0].movement_controller], (_HERE, *choices)
    else:
        controllers = _moved(node.platform.movement_controller, choices[0], timestamp)
    shape, size = tuple(map(len, choices)), forecast.covariances.shape
    total = np.zeros((*shape, *size))
    for axis, (sensor, options) in enumerate(zip(node.sensors, choices[1:], strict=True), start=1):
        told = _sensor_information(sensor, controllers, options, timestamp, forecast, updater)
        places = [1] * len(shape)
        places[0], places[axis] = shape[0], shape[axis]
        total += told.reshape(*places, *size)
    return total.reshape(-1, *size)


def mapped_by(nodes: tuple[Node, ...]) -> set[int]:
    """The coordinates of a state that the sensors' models name, whatever they detect."""
    found: set[int] = set()
    for sensor in (sensor for node in nodes for sensor in node.sensors):
        if closed_forms.is_recognised(sensor):
            found.update(closed_forms.mapping_of(sensor))
        else:
            model = sensor.measurement_model
            found.update(*(getattr(model, name, None) or () for name in ("mapping", "velocity_mapping")))
    return {int(axis) for axis in found}


def notes_of(nodes: tuple[Node, ...], updater: Any) -> tuple[str, ...]:
    """Notes for the user on how the sensors are linearised, each once."""
    asked = [sensor for node in nodes for sensor in node.sensors if not closed_forms.is_recognised(sensor)]
    return tuple(dict.fromkeys(note for sensor in asked if (note := generic.note_of(sensor, updater))))


_HERE: tuple[None, ...] = (None,)


def _sensor_information(  # noqa: PLR0917
    sensor: Any,
    controllers: list[Any],
    options: Sequence[Option | None],
    timestamp: datetime,
    forecast: Forecast,
    updater: Any,
) -> FloatArray:
    """(places of the platform, options of the sensor, M, D, D)."""
    if closed_forms.is_recognised(sensor) and generic.linearises_by_jacobian(updater):
        return _in_closed_form(sensor, controllers, options, timestamp, forecast)
    rows = [
        [
            generic.information(_acted(sensor, option, controller, timestamp, deepcopy), forecast, updater)
            for option in options
        ]
        for controller in controllers
    ]
    return np.array(rows)


def _in_closed_form(
    sensor: Any, controllers: list[Any], options: Sequence[Option | None], timestamp: datetime, forecast: Forecast
) -> FloatArray:
    """The poses are those of a sensor on every moved platform, turned by every option."""
    mapping = closed_forms.mapping_of(sensor)
    if min(forecast.sizes) <= max(mapping):
        rule = f"must have more than {max(mapping)} dimensions, as the mapping of {title(sensor)} asks"
        raise InputError("tracks", rule, min(forecast.sizes))
    carried = [_acted(sensor, None, controller, timestamp, copy) for controller in controllers]
    places = np.array([np.asarray(each.position, dtype=float).ravel() for each in carried])
    turns = np.array([np.asarray(each.orientation, dtype=float).ravel() for each in _differently_turned(carried)])
    acted = [_acted(sensor, option, sensor.movement_controller, timestamp, copy) for option in options]
    heads = np.array([[0.0, _angle(each, "tilt_centre"), _angle(each, "dwell_centre")] for each in acted])
    angles = turns[:, None, :] + heads[None, :, :]
    angles = np.broadcast_to(angles, (len(controllers), *angles.shape[1:]))
    return closed_forms.information(sensor, places[:, None, :], angles, forecast.means)


def _differently_turned(carried: list[Any]) -> list[Any]:
    """One is enough if moving does not turn the platform."""
    return carried[:1] if all(isinstance(each.movement_controller, FixedMovable) for each in carried) else carried


def _angle(sensor: Any, name: str) -> float:
    value = getattr(sensor, name, None)
    return 0.0 if value is None else float(np.asarray(value, dtype=float).ravel()[0])


def _moved(controller: Any, options: Sequence[Option | None], timestamp: datetime) -> list[Any]:
    """The platform's controller after each option; itself if nothing moves it."""
    return [controller if not option else _moved_by(controller, option, timestamp) for option in options]


def _moved_by(controller: Any, option: Option, timestamp: datetime) -> Any:
    moved = copy(controller)
    moved.states = [_own(state) for state in controller.states[-2:]]  # orientation may look at the last two
    moved.scheduled_actions = dict(controller.scheduled_actions)
    moved.add_actions(option)
    moved.act(timestamp)
    return moved


def _own(state: Any) -> Any:
    own = copy(state)
    own.state_vector = state.state_vector.copy()
    return own


def _acted(sensor: Any, option: Option | None, controller: Any, timestamp: datetime, copied: Any) -> Any:
    """A copy of the sensor on another controller after its actions; itself if neither is given."""
    if option is None and controller is sensor.movement_controller:
        return sensor
    if copied is deepcopy:
        replica = deepcopy(sensor, {id(sensor.movement_controller): controller})
    else:
        replica = copy(sensor)
        replica.scheduled_actions = dict(sensor.scheduled_actions)
        if controller is not sensor.movement_controller:
            replica.movement_controller = controller
    if option is not None:
        replica.add_actions(option)
        replica.act(timestamp)
    return replica
