"""Draw a team, its targets and one attack on a plane."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from ratt_opt.report.ellipses import ellipse_of
from ratt_opt.report.fields import draw_fields, draw_watching
from ratt_opt.report.labels import Label, halo, place_labels
from ratt_opt.report.palette import BLINDED, CUT, INK, LOST, SURVIVING, TARGET

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from ratt_opt.report.picture import Picture

__all__ = ["draw_map", "label_places", "name_things"]


def draw_map(axes: Axes, picture: Picture) -> None:
    """Draw the picture into ``axes`` with its own legend below."""
    _draw_links(axes, picture)
    draw_fields(axes, picture, _drawn_robots(picture))
    draw_watching(axes, picture, _drawn_robots(picture))
    if picture.targets is not None:
        _draw_targets(axes, picture)
    _draw_robots(axes, picture)
    axes.autoscale_view()
    axes.margins(0.06)
    if not picture.is_layout:
        axes.grid(visible=True, color="#eeeeee", linewidth=0.8)
    axes.set_axisbelow(True)
    label_places(axes, is_layout=picture.is_layout)


def label_places(axes: Axes, *, is_layout: bool) -> None:
    """Label a map whose places are in metres, or of a layout; the legend stands below."""
    axes.set_aspect("equal", adjustable="datalim")
    if is_layout:
        axes.set_xticks([])
        axes.set_yticks([])
        axes.set_xlabel("no places are known: a layout of the communication graph")
    else:
        axes.set_xlabel("x [m]")
        axes.set_ylabel("y [m]")
    axes.legend(loc="upper center", bbox_to_anchor=(0.5, -0.1), ncols=3, frameon=False, fontsize=8.5)


def name_things(axes: Axes, picture: Picture) -> None:
    """Write the names of robots and targets, once everything else of the figure is there."""
    drawn = sorted(_drawn_robots(picture))
    names = [Label(text=picture.names[i], place=picture.places[i], colour=INK) for i in drawn if picture.names[i]]
    targets = () if picture.targets is None else picture.targets
    names += [Label(text=picture.target_label(j), place=place, colour=TARGET) for j, place in enumerate(targets)]
    place_labels(axes, names, [*picture.places[drawn], *targets], picture.style)


def _is_crowded(picture: Picture) -> bool:
    n_robots, style = len(picture.places), picture.style
    is_network = n_robots <= style.drawn_networks and len(picture.links) <= style.links_each * n_robots
    return n_robots >= style.many_robots and not is_network


def _draw_links(axes: Axes, picture: Picture) -> None:
    home = {i: group for group in picture.groups for i in group}
    kept = sorted(picture.links - picture.attack.links)
    best = [link for link in kept if home[link[0]] == picture.best]
    other = [] if _is_crowded(picture) else [link for link in kept if home[link[0]] != picture.best]
    for links, colour, style, width, label in (
        (sorted(picture.protected_links), INK, "solid", 4.0, "protected link"),
        (other, LOST, "solid", 1.1, "link of another group"),
        (best, SURVIVING, "solid", 1.1, "link of the best group"),
        (sorted(picture.attack.links), CUT, (0, (4, 3)), 1.1, "cut link"),
    ):
        if links:
            _draw_segments(axes, picture, links, colour, style=style, width=width, label=label)


def _draw_segments(
    axes: Axes, picture: Picture, links: list[tuple[int, int]], colour: str, *, style: Any, width: float, label: str
) -> None:
    from matplotlib.collections import LineCollection

    segments = [picture.places[list(link)] for link in links]
    alpha = 0.55 * min(picture.style.many_links / len(links), 1.0) ** 0.7
    look: dict[str, Any] = {"colors": colour, "linestyles": [style], "linewidths": width, "alpha": alpha}
    axes.add_collection(LineCollection(segments, **look))
    axes.plot([], [], color=colour, linestyle=style, linewidth=width, label=label)


def _draw_targets(axes: Axes, picture: Picture) -> None:
    from matplotlib.patches import Ellipse

    assert picture.targets is not None
    if picture.prior is not None and picture.posterior is not None:
        for mean, prior, posterior in zip(picture.targets, picture.prior, picture.posterior, strict=True):
            before: dict[str, Any] = {"fill": False, "linestyle": ":"}
            after: dict[str, Any] = {"alpha": 0.3}
            for covariance, style in ((prior, before), (posterior, after)):
                long, short, angle = ellipse_of(covariance)
                axes.add_patch(
                    Ellipse(
                        mean, 2 * long, 2 * short, angle=float(np.degrees(angle)), color=TARGET, linewidth=1.0, **style
                    )
                )
        axes.plot([], [], color=TARGET, linestyle=":", label="95 % before measuring")
        axes.scatter([], [], marker="o", s=90, color=TARGET, alpha=0.3, label="95 % after, best group")
    label = "target (predicted), T: its number" + (", ×: its weight" if picture.is_weighted else "")
    seen = [j for j in range(len(picture.targets)) if j not in picture.unseen]
    x, y = picture.targets[seen].T
    axes.scatter(x, y, marker="*", s=70, color=TARGET, zorder=4, label=label)
    if picture.unseen:
        x, y = picture.targets[sorted(picture.unseen)].T
        hollow: dict[str, Any] = {"facecolors": "white", "edgecolors": TARGET}
        axes.scatter(x, y, marker="*", s=70, zorder=4, label="target left unseen", **hollow)


def _draw_robots(axes: Axes, picture: Picture) -> None:
    robots, sensing = frozenset(range(len(picture.places))), picture.attack.sensing
    drawn = _drawn_robots(picture)
    if _is_crowded(picture):
        _draw_density(axes, picture, sorted(robots - drawn))
    _draw_moves(axes, picture, sorted(drawn))
    where = "robot" if picture.before is None else "robot after its move"
    for some, colour, marker, label in (
        (sorted(picture.best - sensing), SURVIVING, "o", f"{where}, best group"),
        (sorted(drawn - picture.best - sensing), LOST, "s", f"{where}, cut off"),
    ):
        if some:
            x, y = picture.places[some].T
            axes.scatter(x, y, s=110, color=colour, marker=marker, zorder=5, edgecolors="white", label=label)
    if sensing:
        x, y = picture.places[sorted(sensing)].T
        axes.scatter(x, y, s=110, color="#f6d5cb", zorder=5, edgecolors="white")
        cross: dict[str, Any] = {"marker": "x", "s": 130, "linewidths": 2.4, "color": BLINDED, "zorder": 7}
        axes.scatter(x, y, label="blinded robot", **cross)
    if picture.protected_robots:
        ring: dict[str, Any] = {"s": 210, "facecolors": "none", "edgecolors": INK, "linewidths": 1.6, "zorder": 6}
        axes.scatter(*picture.places[sorted(picture.protected_robots)].T, label="protected robot", **ring)
    _draw_headings(axes, picture, sorted(drawn))
    for i in sorted(drawn):
        _number(axes, picture, i)


def _drawn_robots(picture: Picture) -> frozenset[int]:
    """Robots that are drawn one by one: of many only the best group and what is attacked."""
    robots, sensing = frozenset(range(len(picture.places))), picture.attack.sensing
    if not _is_crowded(picture):
        return robots
    hit = sensing | {i for link in picture.attack.links for i in link}
    return (picture.best | sensing) if picture.attack.links and len(hit) == len(robots) else picture.best | hit


def _number(axes: Axes, picture: Picture, i: int) -> None:
    """Write a robot's number into its disc (beside it under a cross, which would cover it)."""
    hit = i in picture.attack.sensing
    colour = BLINDED if hit else "white" if i in picture.best else INK
    style: dict[str, Any] = {"fontsize": 7, "weight": "bold", "zorder": 8, "color": colour}
    from_left = picture.before is not None and picture.before[i, 0] < picture.places[i, 0]
    shift = (11 if from_left else -11, 5) if hit else (0, 0)
    style["path_effects"] = halo() if hit else []
    axes.annotate(str(i), picture.places[i], shift, textcoords="offset points", ha="center", va="center", **style)


def _draw_density(axes: Axes, picture: Picture, rest: list[int]) -> None:
    """Draw the density of the robots that are not drawn one by one."""
    if rest:
        low, high = picture.places.min(axis=0), picture.places.max(axis=0)
        extent = (low[0], high[0] + 1e-9, low[1], high[1] + 1e-9)
        style: dict[str, Any] = {"gridsize": 9, "extent": extent, "mincnt": 1, "cmap": "Greys", "alpha": 0.5}
        axes.hexbin(*picture.places[rest].T, vmin=0, vmax=6, zorder=0, linewidths=0.2, **style)
        axes.scatter([], [], marker="h", s=110, color=LOST, label=f"density of the other {len(rest)} robots")


def _draw_moves(axes: Axes, picture: Picture, robots: list[int]) -> None:
    """A ring at the robot's place now, and an arrow to its place after the control."""
    if picture.before is None:
        return
    now = picture.before[robots]
    ring: dict[str, Any] = {"s": 26, "facecolors": "none", "edgecolors": "#555555", "zorder": 3}
    axes.scatter(*now.T, label="robot now", **ring)
    moves = picture.places[robots] - now
    scale: dict[str, Any] = {"angles": "xy", "scale_units": "xy", "scale": 1}
    axes.quiver(*now.T, *moves.T, **scale, width=0.003, color="#555555", zorder=3)


def _draw_headings(axes: Axes, picture: Picture, robots: list[int]) -> None:
    """A short arrow from each robot along its heading, of the same length on paper for any map.

    A field of view says the same.
    """
    robots = [i for i in robots if picture.views is None or picture.views[i].angle is None]
    if picture.headings is None or not robots:
        return
    heading = picture.headings[robots]
    length: dict[str, Any] = {"units": "inches", "scale_units": "inches", "scale": 1 / 0.2, "width": 0.014}
    look: dict[str, Any] = {"color": INK, "zorder": 4, "headlength": 4, "headaxislength": 4}
    axes.quiver(*picture.places[robots].T, np.cos(heading), np.sin(heading), **length, **look)
    axes.plot([], [], color=INK, marker=r"$\rightarrow$", markersize=11, linestyle="none", label="heading")
