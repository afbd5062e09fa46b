"""Sensors by the names that files give them: the library's, those of a program, those of installed packages.

A package offers its sensor classes under the entry-point group ``ratt_opt.sensors``; a class is imported when a file
names it, not before. ``register_sensor`` does the same for the program that calls it.
"""

from __future__ import annotations

import sys
from collections.abc import Mapping
from dataclasses import fields, is_dataclass
from functools import lru_cache
from importlib.metadata import EntryPoint, entry_points
from typing import Any, TypeVar

import numpy as np
from pydantic_core import core_schema

from ratt_opt.errors import InputError
from ratt_opt.scenario.record import Record
from ratt_opt.scenario.sensor import Sensor
from ratt_opt.scenario.sensors.doppler import DopplerRadar
from ratt_opt.scenario.sensors.model import SensorModel
from ratt_opt.scenario.sensors.position import PositionSensor
from ratt_opt.scenario.sensors.range_bearing import BearingOnly, RangeBearing, RangeOnly
from ratt_opt.scenario.sensors.spatial import SphericalSensor, TiltedCamera

__all__ = ["GROUP", "KIND", "AnySensor", "kind_of", "made", "register_sensor", "sensor_kinds"]

GROUP = "ratt_opt.sensors"
"""The entry-point group."""
KIND = "kind"
"""The field of a file that names a sensor's class; a sensor without it is a :class:`Sensor`."""
LIBRARY: dict[str, type[SensorModel]] = {
    "range": RangeOnly,
    "bearing": BearingOnly,
    "position": PositionSensor,
    "doppler": DopplerRadar,
    "tilted camera": TiltedCamera,
    "spherical": SphericalSensor,
}
_registered: dict[str, type] = {}

SensorClass = TypeVar("SensorClass", bound=type)


def register_sensor(kind: str, sensor: SensorClass) -> SensorClass:
    """Let files of this program name a sensor class of yours; returns the class.

    A file then holds ``"sensor": {"kind": kind, ...}`` with the sensor's fields. To make files of that kind readable by
    the command line and by everybody who installs your package, declare it there instead::

        [project.entry-points."ratt_opt.sensors"]
        sonar = "my_package:Sonar"

    Parameters
    ----------
    kind : the name in files
    sensor : a subclass of :class:`Sensor`, or a dataclass that subclasses :class:`SensorModel`

    Raises
    ------
    InputError : the name is the library's or another class's, or the class is no sensor whose fields a file can hold.
    """
    if not (isinstance(kind, str) and kind.isprintable() and kind):
        raise InputError("kind", "must be one line of printable text", kind)
    if kind in LIBRARY or _registered.get(kind, sensor) is not sensor:
        raise InputError("kind", "must not be another sensor's", kind)
    _registered[kind] = _checked(kind, sensor)
    return sensor


def sensor_kinds() -> tuple[str, ...]:
    """Return the kinds of sensors that files can name: the library's, registered ones, those of installed packages."""
    return tuple(dict.fromkeys([*LIBRARY, *_registered, *(entry.name for entry in _offered())]))


def kind_of(sensor: Sensor | SensorModel) -> str | None:
    """The name of a sensor's class in files, or ``None`` if files cannot name it."""
    kind = type(sensor)
    if kind is Sensor:
        return None
    if isinstance(sensor, RangeBearing) and type(sensor.sensor) is not Sensor:
        return None  # a file would hold the fields of its sensor and lose what that sensor's class replaces
    for known in (LIBRARY, _registered):
        if found := next((name for name, one in known.items() if one is kind), None):
            return found
    path = f"{kind.__module__}:{kind.__qualname__}"
    return next((entry.name for entry in _offered() if entry.value == path), None)


def made(kind: str, given: Mapping[str, Any]) -> Sensor | SensorModel:
    """The sensor of that kind with these fields.

    Raises
    ------
    InputError : there is no such kind, its package does not load, or a field breaks its rule.
    """
    found = _class_of(kind)
    try:
        if issubclass(found, RangeBearing):
            return found(Sensor(**given))
        sensor = found(**given)
    except InputError:
        raise
    except (TypeError, ValueError) as error:
        raise InputError("", f"must have the fields of {found.__name__}", error) from None
    assert isinstance(sensor, (Sensor, SensorModel))
    return sensor


def _offered() -> tuple[EntryPoint, ...]:
    """Return the sensors that installed packages offer; looked up once for each search path."""
    return _offered_on(tuple(sys.path))


@lru_cache(maxsize=1)
def _offered_on(_path: tuple[str, ...]) -> tuple[EntryPoint, ...]:
    return tuple(entry_points(group=GROUP))


def _class_of(kind: str) -> type:
    if known := LIBRARY.get(kind) or _registered.get(kind):
        return known
    entry = next((one for one in _offered() if one.name == kind), None)
    if entry is None:
        rule = f"must be {', '.join(sensor_kinds())}, or offered by an installed package ({GROUP})"
        raise InputError(KIND, rule, kind)
    try:
        return _checked(kind, entry.load())
    except (ImportError, AttributeError) as error:
        raise InputError(KIND, "must be offered by a package that can be imported", f"{kind} ({error})") from None


def _checked(kind: str, found: object) -> type:
    """InputError : it is no class of sensors, or one whose fields a file could not hold."""
    if not (isinstance(found, type) and issubclass(found, (Sensor, SensorModel))):
        raise InputError(KIND, "must name a subclass of Sensor or SensorModel", kind)
    names = list(found.model_fields) if issubclass(found, Sensor) else _names(found)
    if KIND in names:
        raise InputError(KIND, f"must name a class without a field '{KIND}' of its own", found.__name__)
    return found


def _names(found: type[SensorModel]) -> list[str]:
    if not is_dataclass(found):
        raise InputError(KIND, "must name a dataclass, whose fields a file can hold", found.__name__)
    return [field.name for field in fields(found) if field.init]


def _document(sensor: Sensor | SensorModel) -> dict[str, Any]:
    """Return the entry of a sensor in a file."""
    kind = kind_of(sensor)
    if isinstance(sensor, Sensor):
        own = type(sensor).model_fields if kind else Sensor.model_fields  # a subclass without a name is saved as these
        return ({KIND: kind} if kind else {}) | sensor.model_dump(mode="json", include=set(own))
    if isinstance(sensor, RangeBearing) and kind:
        return {KIND: kind, **sensor.sensor.model_dump(mode="json")}
    if kind is None:  # written to no file (see ``Scenario.own_sensors``): it only tells scenarios apart
        return {KIND: repr(sensor)}
    return {KIND: kind, **{name: _plain(name, getattr(sensor, name)) for name in _names(type(sensor))}}


def _plain(name: str, value: object) -> object:
    """A field's value as JSON has it."""
    if isinstance(value, Record):
        return value.model_dump(mode="json")
    if isinstance(value, (np.ndarray, np.generic)):
        return value.tolist()
    if isinstance(value, (list, tuple)):
        return [_plain(name, one) for one in value]
    if value is None or isinstance(value, (bool, int, float, str)):
        return value
    raise InputError(name, "must be numbers or text to be saved", type(value).__name__)


def _read(value: object) -> Sensor | SensorModel:
    """A sensor, or what a file holds of one."""
    if isinstance(value, (Sensor, SensorModel)):
        return value
    if not isinstance(value, Mapping):
        raise InputError(
            "", "must be an object", value if isinstance(value, (str, int, float)) else type(value).__name__
        )
    given = dict(value)
    kind = given.pop(KIND, None)
    if kind is None:
        return Sensor(**given)
    if not isinstance(kind, str):
        raise InputError(KIND, "must be text", type(kind).__name__)
    return made(kind, given)


class AnySensor:
    """Field of a record that holds a sensor of any class: its reading, writing and schema."""

    @classmethod
    def __get_pydantic_core_schema__(cls, source: object, handler: object) -> core_schema.CoreSchema:
        """Sensors as they are; of files by their kind."""
        written = core_schema.plain_serializer_function_ser_schema(_document, when_used="json")
        return core_schema.no_info_plain_validator_function(_read, serialization=written)

    @classmethod
    def __get_pydantic_json_schema__(cls, schema: object, handler: Any) -> dict[str, Any]:
        """The library's sensor, or an object that names its kind."""
        named = {"type": "object", "required": [KIND], "properties": {KIND: {"type": "string"}}}
        return {"anyOf": [handler(Sensor.__pydantic_core_schema__), named]}
