"""Players by their name in a table, or the user's own, and what tables and titles call these."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING, TypeVar

from ratt_opt.errors import InputError
from ratt_opt.vocabulary import current_name

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence

__all__ = ["get_player", "name_of", "table_of"]

Player = TypeVar("Player")
Own = TypeVar("Own", bound="Callable[..., object]")


def table_of(names: Sequence[str], players: Mapping[str, Player]) -> dict[str, Player]:
    """Return the players in the order of the names, of which each must have one."""
    assert set(names) == set(players), set(names) ^ set(players)
    return {name: players[name] for name in names}


def get_player(role: str, given: str | Own, known: Mapping[str, Player]) -> Player | Own:
    """The player of that name in ``known``, or the given one. InputError : there is none, or it cannot be called."""
    given = current_name(role, given, stacklevel=5)
    if isinstance(given, str) and given in known:
        return known[given]
    if isinstance(given, str) or not callable(given):
        raise InputError(role, f"must be {', '.join(known)} or a callable", given)
    return given


def name_of(player: object) -> str:
    """Name of a planner, an attacker or another argument: a function's own, with the arguments of a ``partial``."""
    if isinstance(player, partial):
        given = [*map(repr, player.args), *(f"{name}={value!r}" for name, value in player.keywords.items())]
        return f"{name_of(player.func)}({', '.join(given)})"
    return player if isinstance(player, str) else str(getattr(player, "__name__", None) or repr(player))
