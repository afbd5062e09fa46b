"""Fields of view: sectors on a map, and lines from robots to the targets that they measure."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from ratt_opt.report.palette import BLINDED, LOST, SURVIVING, TARGET

if TYPE_CHECKING:
    from collections.abc import Collection

    from matplotlib.axes import Axes
    from matplotlib.patches import Wedge

    from ratt_opt.report.picture import Picture

__all__ = [
    "FIELD_WORDS",
    "LOST_WORDS",
    "WATCH_WORDS",
    "draw_fields",
    "draw_watching",
    "field_of",
    "sector",
    "watched_pairs",
]

FIELD_WORDS = "field of view"
WATCH_WORDS, LOST_WORDS = "robot measures target", "measurement lost to the attack"


def field_of(picture: Picture, i: int) -> tuple[float, float, float]:
    """Return the sector of robot ``i``: heading [rad], full angle [rad], and the radius of the drawing [m].

    A field without a reach is drawn up to its farthest target.
    """
    assert picture.views is not None
    assert picture.headings is not None
    view = picture.views[i]
    angle = 2 * np.pi if view.angle is None else view.angle
    if view.reach is not None:
        return float(picture.headings[i]), float(angle), view.reach
    drawn = picture.style.nearest_edge * _width(picture)
    if picture.watched is not None and picture.targets is not None and picture.watched[i].any():
        apart = np.linalg.norm(picture.targets[picture.watched[i]] - picture.places[i], axis=1)
        drawn = max(drawn, 1.05 * float(apart.max()))
    return float(picture.headings[i]), float(angle), drawn


def _width(picture: Picture) -> float:
    """The diagonal of the rectangle around robots and targets [m]."""
    corners = picture.places if picture.targets is None else np.vstack([picture.places, picture.targets])
    return float(np.linalg.norm(np.ptp(corners, axis=0)))


def watched_pairs(picture: Picture, robots: Collection[int]) -> list[tuple[int, int]]:
    """The robots among these and the targets that each measures."""
    if picture.watched is None:
        return []
    return [(i, int(j)) for i in sorted(robots) for j in np.flatnonzero(picture.watched[i])]


def draw_fields(axes: Axes, picture: Picture, robots: Collection[int]) -> None:
    """Draw a pale sector for each robot, and only the rim of one wider than half a turn, which would flood the map.

    The map holds each whole, unless it reaches farther than the team and its targets are wide.
    """
    from matplotlib.path import Path

    if picture.views is None:
        return
    for i in sorted(robots):
        heading, angle, reach = field_of(picture, i)
        colour = BLINDED if i in picture.attack.sensing else SURVIVING if i in picture.best else LOST
        wedge = sector(tuple(picture.places[i]), reach, (heading, angle), colour)
        if reach <= _width(picture):
            axes.add_patch(wedge)
        else:
            axes.add_artist(wedge)
    icon = Path.wedge(-30, 30)
    axes.scatter([], [], marker=icon, s=200, color=SURVIVING, alpha=0.4, label=_words(picture))


def sector(centre: tuple[float, float], reach: float, looks: tuple[float, float], colour: str) -> Wedge:
    """A pale sector around a heading, of a full angle [rad]; only the rim of one wider than half a turn."""
    from matplotlib.patches import Wedge

    heading, angle = looks
    middle, half = float(np.degrees(heading)), float(np.degrees(angle)) / 2
    look: dict[str, Any] = {"facecolor": colour, "edgecolor": colour, "linewidth": 0.6, "zorder": 0.5}
    look |= {"fill": angle <= np.pi, "alpha": 0.13 if angle <= np.pi else 0.5}
    return Wedge(centre, reach, middle - half, middle + half, **look)


def draw_watching(axes: Axes, picture: Picture, robots: Collection[int]) -> None:
    """Draw a thin line from each robot to each target that it measures, dotted if the attack takes that away."""
    from matplotlib.collections import LineCollection

    if picture.targets is None:
        return
    heard = picture.seeing & set(robots)
    for some, style, label in ((heard, "solid", WATCH_WORDS), (set(robots) - heard, (0, (6, 2, 1, 2)), LOST_WORDS)):
        pairs = watched_pairs(picture, some)
        if pairs:
            segments = [np.array([picture.places[i], picture.targets[j]]) for i, j in pairs]
            look: dict[str, Any] = {"colors": TARGET, "linestyles": [style], "linewidths": 0.7, "zorder": 1.5}
            axes.add_collection(LineCollection(segments, alpha=0.7, **look))
            axes.plot([], [], color=TARGET, linestyle=style, linewidth=0.9, label=label)


def _words(picture: Picture) -> str:
    assert picture.views is not None
    endless = any(view.reach is None for view in picture.views)
    return f"{FIELD_WORDS} (no limit of range)" if endless else f"{FIELD_WORDS}, as far as it reaches"
