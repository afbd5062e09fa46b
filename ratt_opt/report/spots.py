"""Placement of words on a map: each beside its place, in the spot where it covers least of what is there already."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from ratt_opt._validation import FloatArray

__all__ = ["BESIDE", "SPOTS", "Box", "best_spot"]

Box = tuple[float, float, float, float]
"""Left, top, right and bottom of a rectangle, in any unit."""

_AROUND = (
    *((x, y, side) for x, side in ((8, "left"), (-8, "right")) for y in (-9, 9, -3)),
    (0, 15, "center"),
    (0, -17, "center"),
)
SPOTS = tuple((x * out, y * out, side) for out in (1.0, 1.8, 2.8) for x, y, side in _AROUND)
"""Offsets of a word's middle line from its place, upwards, the nearest first, and which end of the word is there."""
BESIDE = len(_AROUND)
"""Number of spots that touch the place; a word in a later one needs a line to it."""


def best_spot(boxes: Sequence[Box], taken: Iterable[Box], inside: Box) -> tuple[int, float]:
    """The first of ``boxes`` that covers least of ``taken`` and sticks out least of ``inside``, and that area."""
    known, own = list(taken), np.array(boxes, dtype=np.float64)
    areas = (own[:, 2] - own[:, 0]) * (own[:, 3] - own[:, 1])
    costs = areas - _overlaps(own, np.array([inside]))[:, 0]
    if known:
        costs += _overlaps(own, np.array(known)).sum(axis=1)
    chosen = int(np.argmin(costs))
    return chosen, float(costs[chosen])


def _overlaps(boxes: FloatArray, others: FloatArray) -> FloatArray:
    """(B, O) areas that boxes (B, 4) share with others (O, 4)."""
    low = np.maximum(boxes[:, None, :2], others[None, :, :2])
    high = np.minimum(boxes[:, None, 2:], others[None, :, 2:])
    return np.asarray(np.maximum(high - low, 0.0).prod(axis=2))
