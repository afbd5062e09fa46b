"""Placement of words on a map: each beside its place, in the spot where it covers least of what is there already."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

__all__ = ["SPOTS", "Box", "best_spot", "overlap"]

Box = tuple[float, float, float, float]
"""Left, top, right and bottom of a rectangle, in any unit."""

SPOTS = tuple(
    (x * out, y * out, side)
    for out in (1.0, 1.8, 2.8)
    for x, y, side in (
        *((x, y, side) for x, side in ((8, "left"), (-8, "right")) for y in (-9, 9, -3)),
        (0, 15, "center"),
        (0, -17, "center"),
    )
)
"""Offsets of a word's middle line from its place, upwards, the nearest first, and which end of the word is there."""


def best_spot(boxes: Sequence[Box], taken: Iterable[Box], inside: Box) -> tuple[int, float]:
    """The first of ``boxes`` that covers least of ``taken`` and sticks out least of ``inside``, and that area."""
    known = list(taken)
    costs = [_area(box) - overlap(box, inside) + sum(overlap(box, other) for other in known) for box in boxes]
    least = min(costs)
    return costs.index(least), least


def overlap(a: Box, b: Box) -> float:
    """The area that two boxes share."""
    width, height = min(a[2], b[2]) - max(a[0], b[0]), min(a[3], b[3]) - max(a[1], b[1])
    return width * height if width > 0 and height > 0 else 0.0


def _area(box: Box) -> float:
    return (box[2] - box[0]) * (box[3] - box[1])
