"""Put words on a map where they cover as little as possible: each beside its place, in the best of some spots."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from ratt_opt.report.lettering import choose_fonts, literal
from ratt_opt.report.spots import BESIDE, SPOTS, best_spot

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from matplotlib.axes import Axes
    from matplotlib.transforms import BboxBase

    from ratt_opt._validation import FloatArray
    from ratt_opt.report.map_style import MapStyle
    from ratt_opt.report.spots import Box

__all__ = ["Label", "halo", "place_labels"]

SIDES = {"left": 0.0, "center": 0.5, "right": 1.0}
"""Share of a word's width that lies left of where it is put."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Label:
    """A word, what it belongs to (x, y in data units), and its colour."""

    text: str
    place: FloatArray
    colour: str


def place_labels(axes: Axes, labels: Sequence[Label], marks: Iterable[FloatArray], style: MapStyle) -> None:
    """Write the labels in order; ``marks`` are the places that no word should cover."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg

    figure: Any = axes.figure
    canvas: Any = FigureCanvasAgg(figure)
    renderer = canvas.get_renderer()  # asked for once: matplotlib would make one for each word
    figure.draw_without_rendering()  # only now the scale of the axes is known
    # Files are drawn in the layout in which words are placed; finding it anew for each took longer than the words.
    figure.set_layout_engine("none")
    points = figure.dpi / 72
    taken = [_square(axes.transData.transform(place), style.mark * points) for place in marks]
    for label in labels:
        look: dict[str, Any] = {"va": "center", "fontsize": 7, "color": label.colour, "zorder": 8}
        look["path_effects"] = halo()
        place = float(label.place[0]), float(label.place[1])
        word = axes.annotate(literal(label.text), place, (0, 0), textcoords="offset points", **look)
        choose_fonts(word)
        at_place = _box(word.get_window_extent(renderer))  # to the right of the place: asked for once, as it takes long
        boxes = [_moved(at_place, x * points, y * points, side) for x, y, side in SPOTS]
        chosen, _ = best_spot(boxes, taken, _box(axes.bbox))
        x, y, side = SPOTS[chosen]
        word.set(position=(x, y), ha=side)
        if chosen >= BESIDE:
            line = {"arrowstyle": "-", "color": label.colour, "linewidth": style.pointer, "shrinkA": 0, "shrinkB": 0}
            axes.annotate("", place, (x, y), textcoords="offset points", arrowprops=line, zorder=7)
        taken.append(boxes[chosen])


def halo(width: float = 2.0) -> list[Any]:
    """The path effects of words behind which lines may run: a pale rim of that width [points]."""
    from matplotlib.patheffects import withStroke

    return [withStroke(linewidth=width, foreground="white", alpha=0.8)]


def _square(centre: FloatArray, half: float) -> Box:
    x, y = (float(c) for c in centre)
    return x - half, y - half, x + half, y + half


def _moved(box: Box, x: float, y: float, side: str) -> Box:
    """The box of a word once its ``side`` is that far from the place where its left end was."""
    left = x - SIDES[side] * (box[2] - box[0])
    return box[0] + left, box[1] + y, box[2] + left, box[3] + y


def _box(given: BboxBase) -> Box:
    return float(given.x0), float(given.y0), float(given.x1), float(given.y1)
