"""Put words on a map where they cover as little as possible: each beside its place, in the best of eight spots."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from ratt_opt.report.lettering import lettering

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from matplotlib.axes import Axes
    from matplotlib.transforms import Bbox

    from ratt_opt._validation import FloatArray

__all__ = ["Label", "halo", "place_labels"]

SPOTS = (
    *((x, y, side) for x, side in ((8, "left"), (-8, "right")) for y in (-9, 9, -3)),
    (0, 15, "center"),
    (0, -17, "center"),
)
"""Offsets [points] from the place, the first preferred, and which end of the word is there."""
MARK = 7.0
"""Half the width of a robot or target on paper [points]."""

HALO = 2.0
"""Width of the pale rim of a word [points]."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Label:
    """A word, what it belongs to (x, y in data units), and its colour."""

    text: str
    place: FloatArray
    colour: str


def place_labels(axes: Axes, labels: Sequence[Label], marks: Iterable[FloatArray]) -> None:
    """Write the labels in order; ``marks`` are the places that no word should cover."""
    figure: Any = axes.figure
    figure.draw_without_rendering()  # only now the scale of the axes is known
    points = figure.dpi / 72
    taken = [_square(axes.transData.transform(place), MARK * points) for place in marks]
    for label in labels:
        style: dict[str, Any] = {"va": "center", "fontsize": 7, "color": label.colour, "zorder": 8}
        text, style["family"] = lettering(label.text)
        style["path_effects"] = halo()
        word = axes.annotate(
            text, (float(label.place[0]), float(label.place[1])), (0, 0), textcoords="offset points", **style
        )
        costs = []
        for x, y, side in SPOTS:
            word.set(position=(x, y), ha=side)
            costs.append(_covered(word.get_window_extent(), taken, axes.bbox))
        x, y, side = SPOTS[costs.index(min(costs))]
        word.set(position=(x, y), ha=side)
        taken.append(word.get_window_extent())


def halo() -> list[Any]:
    """The path effects of words behind which lines may run."""
    from matplotlib.patheffects import withStroke

    return [withStroke(linewidth=HALO, foreground="white", alpha=0.8)]


def _square(centre: FloatArray, half: float) -> Bbox:
    from matplotlib.transforms import Bbox

    return Bbox.from_extents(*(centre - half), *(centre + half))


def _covered(box: Bbox, taken: Iterable[Bbox], inside: Bbox) -> float:
    """Area that a word would cover of others, and that would stick out of the map."""
    from matplotlib.transforms import Bbox

    shared = (Bbox.intersection(box, other) for other in taken)
    kept = Bbox.intersection(box, inside)
    out = box.width * box.height - (0.0 if kept is None else kept.width * kept.height)
    return out + sum(part.width * part.height for part in shared if part is not None)
