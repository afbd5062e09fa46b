"""Records that hold arrays and still compare, hash and print as values."""

from __future__ import annotations

import math
from dataclasses import fields, is_dataclass
from enum import Enum
from html import escape
from typing import Any

import numpy as np

from ratt_opt._rounding import named_text
from ratt_opt._validation import readonly

__all__ = ["ByValue", "ReprMixin", "counted", "plain", "shown"]


class ByValue:
    """Base of frozen dataclasses (``eq=False, repr=False``) with array fields: equal when all they hold is.

    Arrays count by shape and entries, and NaN equals NaN, so that a copy equals its original. Fields with
    ``compare=False`` or ``repr=False`` are left out of that. What it is given to hold is copied, unless it cannot be
    written to: nobody changes a value afterwards.
    """

    __slots__ = ()

    def __post_init__(self) -> None:
        assert is_dataclass(self)
        for f in fields(self):
            value = getattr(self, f.name)
            if isinstance(value, np.ndarray) and value.flags.writeable:
                object.__setattr__(self, f.name, readonly(value))

    def __eq__(self, other: object) -> bool:
        if type(other) is not type(self):
            return NotImplemented
        return bool(_key(self) == _key(other))

    def __hash__(self) -> int:
        return hash(_key(self))

    def __repr__(self) -> str:
        assert is_dataclass(self)
        named = ", ".join(f"{f.name}={shown(getattr(self, f.name))}" for f in fields(self) if f.repr)
        return f"{type(self).__name__}({named})"


def _key(value: Any) -> Any:
    """Return the key by which a value is compared: nested tuples, hashable and free of NaN."""
    if isinstance(value, ByValue):
        assert is_dataclass(value)
        return type(value), tuple(_key(getattr(value, f.name)) for f in fields(value) if f.compare)
    if isinstance(value, np.ndarray):
        return value.shape, tuple(_key(x) for x in value.ravel().tolist())
    if isinstance(value, (tuple, list)):
        return tuple(_key(x) for x in value)
    return None if isinstance(value, float) and value != value else value  # noqa: PLR0124  (NaN)


def counted(number: int, noun: str) -> str:
    """Return a number of things: "1 robot", "2 robots"."""
    return f"{number} {noun}" if number == 1 else f"{number} {noun}s"


def _shortened(texts: list[str], most: int = 12) -> str:
    """Join at most ``most`` texts; the rest is counted."""
    more = f", ... {len(texts) - most} more" if len(texts) > most else ""
    return ", ".join(texts[:most]) + more


def shown(value: Any) -> str:
    """A short ``repr``: arrays as lists, shortened."""
    if not isinstance(value, np.ndarray):
        return repr(value)
    if value.ndim != 1:
        return f"array of shape {value.shape}"
    return f"[{_shortened(list(map(repr, value.tolist())))}]"


class ReprMixin:
    """Base of records that notebooks show as a table of their fields, and that become plain data."""

    __slots__ = ()

    def to_dict(self) -> dict[str, Any]:
        """The fields as plain data: lists, numbers and text; unknown numbers are ``None``."""
        assert is_dataclass(self)
        return {f.name: plain(getattr(self, f.name)) for f in fields(self) if f.repr}

    def _repr_html_(self) -> str:
        rows = "".join(
            f"<tr><th style='text-align:left'>{escape(name.replace('_', ' '))}</th>"
            f"<td style='text-align:left'>{escape(_brief(value, name))}</td></tr>"
            for name, value in self.to_dict().items()
        )
        return f"<table><caption>{escape(type(self).__name__)}</caption>{rows}</table>"


def plain(value: Any) -> Any:
    """Return a field's value as plain data, sets in order and infinities or NaN as ``None``."""
    if isinstance(value, ReprMixin):
        return value.to_dict()
    if isinstance(value, Enum):
        return value.value
    if isinstance(value, np.ndarray):
        return plain(value.tolist())
    if isinstance(value, (frozenset, set)):
        return plain(sorted(value))
    if isinstance(value, (tuple, list)):
        return [plain(item) for item in value]
    return None if isinstance(value, float) and not math.isfinite(value) else value


def _brief(value: Any, name: str) -> str:
    """Plain data as text for people: numbers to ten digits, ends of brackets outward by their names, long lists cut."""
    if isinstance(value, dict):
        return "; ".join(f"{key}: {_brief(item, key)}" for key, item in value.items())
    if isinstance(value, list):
        return _shortened(["-".join(map(str, x)) if isinstance(x, list) else str(x) for x in value])
    if not isinstance(value, float):
        return "none" if value is None else str(value)
    return named_text(name, value, 10)
