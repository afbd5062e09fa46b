"""Players by their name in a table, or the user's own."""

from __future__ import annotations

from typing import TYPE_CHECKING, TypeVar

from ratt_opt.errors import InputError

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

__all__ = ["player_called"]

Player = TypeVar("Player")
Own = TypeVar("Own", bound="Callable[..., object]")


def player_called(role: str, given: str | Own, known: Mapping[str, Player]) -> Player | Own:
    """The player of that name in ``known``, or the given one. InputError : there is none, or it cannot be called."""
    if isinstance(given, str) and given in known:
        return known[given]
    if isinstance(given, str) or not callable(given):
        raise InputError(role, f"must be {', '.join(known)} or a callable", given)
    return given
