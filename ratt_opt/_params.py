"""Parameters from TOML files: a table for each algorithm, a line for each parameter that is not as by default."""

from __future__ import annotations

import tomllib
from dataclasses import fields, is_dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar, get_type_hints

from pydantic import TypeAdapter, ValidationError

from ratt_opt.errors import InputError

if TYPE_CHECKING:
    from _typeshed import DataclassInstance

__all__ = ["changed", "check_at_least_one", "read_params"]

P = TypeVar("P", bound="DataclassInstance")


def read_params(path: str | Path | None, default: P, argument: str = "params") -> P:
    """Read the parameters that a file changes; all are as in ``default`` without a file.

    ``argument`` : named by errors

    Raises
    ------
    InputError : the file cannot be read or is no TOML, a parameter does not exist, or a value is none of its kind.
    """
    if path is None:
        return default
    try:
        document = tomllib.loads(Path(path).read_text(encoding="utf-8"))
    except (OSError, UnicodeDecodeError, tomllib.TOMLDecodeError) as error:
        raise InputError(argument, f"must be a file of TOML ({error})", str(path)) from None
    return _with(default, document, argument)


def changed(params: DataclassInstance) -> dict[str, Any]:
    """Return the parameters that are not as by default, by their places: ``"annealing.moves"``."""
    places: dict[str, Any] = {}
    default = type(params)()
    for one in fields(params):
        value, usual = getattr(params, one.name), getattr(default, one.name)
        if is_dataclass(value) and not isinstance(value, type):
            places |= {f"{one.name}.{name}": inner for name, inner in changed(value).items()}
        elif value != usual:
            places[one.name] = value
    return places


def check_at_least_one(params: DataclassInstance, places: tuple[str, ...]) -> None:
    """Check the parameters at these places (``"annealing.longer"``), without which nothing would go on, or end.

    Raises
    ------
    InputError : one is less than 1.
    """
    for place in places:
        family, name = place.split(".")
        if not (value := getattr(getattr(params, family), name)) >= 1:
            raise InputError(f"params.{place}", "must be at least 1", value)


def _with(default: P, document: dict[str, Any], place: str) -> P:
    names = [one.name for one in fields(default)]
    for name in document:
        if name not in names:
            raise InputError(place, f"must name some of {', '.join(names)}", name)
    kinds = get_type_hints(type(default))
    return replace(
        default,
        **{
            name: _value(getattr(default, name), given, f"{place}.{name}", kinds[name])
            for name, given in document.items()
        },
    )


def _value(default: Any, given: Any, place: str, kind: Any) -> Any:
    if is_dataclass(default) and not isinstance(default, type):
        if not isinstance(given, dict):
            raise InputError(place, "must be a table", given)
        return _with(default, given, place)
    try:
        value = TypeAdapter(kind).validate_python(given)
    except ValidationError as error:
        raise InputError(place, f"must be like {default!r} ({error.errors()[0]['msg']})", given) from None
    if not _is_sound(value):
        raise InputError(place, "must be at least 0 and finite", given)
    return value


def _is_sound(value: Any) -> bool:
    return all(map(_is_sound, value)) if isinstance(value, tuple) else 0 <= value < float("inf")
