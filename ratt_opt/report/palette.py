"""One look for each planner and each thing on a map, in every figure.

Colours alone stay apart (``tests/report/test_palette.py``): by 20 (CIE 1976) at least under normal vision, protanopia
and deuteranopia, and by 10 steps of lightness in grey; markers, hatches and line styles say the same again.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Sequence

__all__ = [
    "BLINDED",
    "CUT",
    "INK",
    "LOST",
    "PLANNERS",
    "SURVIVING",
    "TARGET",
    "VERDICTS",
    "Look",
    "look_of",
    "looks_of",
    "rgb",
]


@dataclass(frozen=True, slots=True)
class Look:
    """Look of a planner: colour, marker of points and curves, hatch of bars."""

    colour: str
    marker: str
    hatch: str


PLANNERS = {
    "ratt": Look("#0b5394", "o", ""),
    "maxmin": Look("#4a0d1f", "D", "///"),
    "greedy": Look("#30a574", "s", "..."),
    "myopic": Look("#86648a", "v", "xxx"),
    "random": Look("#f3c6dd", "X", "\\\\\\"),
    "nonrobust_optimum": Look("#e69f00", "^", "++"),
}
"""RATT blue and Greedy green as in the paper; the lightness of each is its own."""
VERDICTS = {
    "proved": Look("#0b5394", "o", ""),
    "refuted": Look("#e0451b", "X", "///"),
    "no violation found": Look("#f3c6dd", "s", "..."),
    "not decidable here": Look("#1c1c1c", "P", "oo"),
}
"""Looks of the audit's verdicts."""
SURVIVING, LOST, BLINDED, TARGET = "#0b5394", "#b4b9be", "#e0451b", "#33200a"
CUT = BLINDED
INK = "#222222"


OWN = (Look("#6c757d", "P", "oo"), Look("#c9d55b", "*", "--"), Look("#1c1c1c", "h", "||"), Look("#e0451b", "<", "**"))
"""Looks of planners that are not the library's, one after the other."""


def look_of(planner: str) -> Look:
    """Return a planner's look; that of others than the library's own is plain grey."""
    return PLANNERS.get(planner, OWN[0])


def looks_of(planners: Sequence[str]) -> dict[str, Look]:
    """Return the looks of planners in one figure: those that are not the library's differ as long as looks last."""
    own = [name for name in planners if name not in PLANNERS]
    return {name: PLANNERS[name] if name in PLANNERS else OWN[own.index(name) % len(OWN)] for name in planners}


def rgb(code: str) -> list[int]:
    """Red, green and blue of a colour ``#rrggbb``, 0 to 255."""
    return [int(code[k : k + 2], 16) for k in (1, 3, 5)]
