"""Records that hold arrays and still compare, hash and print as values."""

from __future__ import annotations

from dataclasses import fields, is_dataclass
from typing import Any

import numpy as np

__all__ = ["ByValue", "shown"]

MOST_SHOWN = 12
"""Entries of an array that a ``repr`` shows; the rest is counted."""


class ByValue:
    """Base of frozen dataclasses (``eq=False, repr=False``) with array fields: equal when all they hold is.

    Arrays count by shape and entries, and NaN equals NaN, so that a copy equals its original. Fields with
    ``compare=False`` or ``repr=False`` are left out of that.
    """

    __slots__ = ()

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
    """What a value is compared by: nested tuples that are hashable and free of NaN."""
    if isinstance(value, ByValue):
        assert is_dataclass(value)
        return type(value), tuple(_key(getattr(value, f.name)) for f in fields(value) if f.compare)
    if isinstance(value, np.ndarray):
        return value.shape, tuple(_key(x) for x in value.ravel().tolist())
    if isinstance(value, (tuple, list)):
        return tuple(_key(x) for x in value)
    return None if isinstance(value, float) and value != value else value  # noqa: PLR0124  (NaN)


def shown(value: Any) -> str:
    """A short ``repr``: arrays as lists of at most ``MOST_SHOWN`` entries."""
    if not isinstance(value, np.ndarray):
        return repr(value)
    if value.ndim != 1:
        return f"array of shape {value.shape}"
    first = ", ".join(map(repr, value[:MOST_SHOWN].tolist()))
    more = f", ... {value.size - MOST_SHOWN} more" if value.size > MOST_SHOWN else ""
    return f"[{first}{more}]"
