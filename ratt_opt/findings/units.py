"""In which unit a value is, by the coordinates of the state that it sums."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Sequence

    from ratt_opt.setfunctions.base import SetFunction

__all__ = ["value_unit"]

PLANE = 2
"""Coordinates of a state that is a position unless its source says otherwise."""


def value_unit(f: SetFunction, units: Sequence[str] | None = None) -> str:
    """The unit of a set function's values, empty if it states none.

    Traces and largest eigenvalues are squares of what they sum: m\N{SUPERSCRIPT TWO} of positions. Of a state that
    mixes units, or that nobody gave units, no unit is claimed.

    ``units`` : (d,) of the state's coordinates, if they are known
    """
    stated: str = getattr(f, "unit", "")
    if stated != "m\N{SUPERSCRIPT TWO}":
        return stated
    if units is None:
        return stated if getattr(f, "dimension", PLANE) == PLANE else "units of the state, squared"
    output = getattr(f, "output", None)
    counts = range(len(units)) if output is None else np.unique(np.nonzero(output)[-1]).tolist()
    squares = list(dict.fromkeys(_square(units[k]) for k in counts))
    return squares[0] if len(squares) == 1 else f"mixed: {', '.join(squares)}"


def _square(unit: str) -> str:
    return f"{unit}\N{SUPERSCRIPT TWO}" if unit.isalpha() else f"({unit})\N{SUPERSCRIPT TWO}"
