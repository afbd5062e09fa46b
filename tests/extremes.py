"""Extreme values of every field of a class of parameters, for tests of what holds whatever they are."""

from collections.abc import Container, Iterator
from dataclasses import fields, is_dataclass, replace
from typing import Any

from ratt_opt import InputError


def places(params: Any, prefix: str = "") -> list[str]:
    """Names of all numbers, those of inner classes as ``"family.name"``."""
    found = []
    for one in fields(params):
        value = getattr(params, one.name)
        inner = is_dataclass(value) and not isinstance(value, type)
        found += places(value, f"{prefix}{one.name}.") if inner else [f"{prefix}{one.name}"]
    return found


def with_one(params: Any, place: str, value: Any) -> Any:
    """The parameters with one number changed."""
    name, _, rest = place.partition(".")
    return replace(params, **{name: with_one(getattr(params, name), rest, value) if rest else value})


def value_at(params: Any, place: str) -> Any:
    """The number at a place."""
    for name in place.split("."):
        params = getattr(params, name)
    return params


def extreme(value: Any, *, least: bool) -> Any:
    """The smallest value that a parameter may have, or one that is huge for it; one or many values of a list."""
    if isinstance(value, tuple):
        return value[:1] if least else value * 3
    if isinstance(value, (bool, str)):
        return value
    return type(value)(0 if least else 20 * value + 1)


def at_extremes(params: Any, place: str, refused: Container[str] = ()) -> Iterator[tuple[bool, Any]]:
    """The parameters with one number at each end, and whether it is the least; some places may be refused."""
    for least in (True, False):
        try:
            changed = with_one(params, place, extreme(value_at(params, place), least=least))
        except InputError:
            assert place in refused
        else:
            yield least, changed


def undocumented(params: Any) -> list[str]:
    """Fields that the docstring of their class does not explain."""
    found = []
    for one in fields(params):
        value = getattr(params, one.name)
        if is_dataclass(value) and not isinstance(value, type):
            found += undocumented(value)
        elif f"``{one.name}``" not in (type(params).__doc__ or ""):
            found.append(f"{type(params).__name__}.{one.name}")
    return found
