"""Draw a team, its targets and one attack on a plane."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from ratt_opt._validation import FloatArray
    from ratt_opt.problem import Attack

__all__ = ["Picture", "draw_map"]

SURVIVING = "#0b6e99"
LOST = "#9a9a9a"
BLINDED = "#c1121f"
TARGET = "#7a4b00"
CUT = "#c1121f"
SIGMAS = 2.4477
"""Half-axes of an ellipse that holds 95 % of a two-dimensional Gaussian."""
MANY_LINKS = 60
"""Above this many links of a kind they are drawn fainter."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Picture:
    """What the map shows; lengths in metres, angles in radians.

    ``before`` and ``after`` : (N, 3) poses x, y, heading now and after the chosen controls.
    ``targets`` : (M, 2) predicted means; ``prior``, ``posterior`` : (M, 2, 2) covariances, the
    latter with the best surviving group's measurements.
    ``groups`` : connected groups left by the attack; ``best`` : the one that performs best.
    """

    before: FloatArray
    after: FloatArray
    targets: FloatArray
    prior: FloatArray
    posterior: FloatArray
    links: frozenset[tuple[int, int]]
    attack: Attack
    groups: tuple[frozenset[int], ...]
    best: frozenset[int]


def draw_map(axes: Axes, picture: Picture) -> None:
    """Draw the picture into ``axes`` with its own legend below."""
    _draw_links(axes, picture)
    _draw_targets(axes, picture)
    _draw_robots(axes, picture)
    axes.set_aspect("equal", adjustable="datalim")
    axes.autoscale_view()
    axes.margins(0.06)
    axes.set_xlabel("x [m]")
    axes.set_ylabel("y [m]")
    axes.grid(visible=True, color="#eeeeee", linewidth=0.8)
    axes.set_axisbelow(True)
    axes.legend(loc="upper center", bbox_to_anchor=(0.5, -0.1), ncols=3, frameon=False, fontsize=8.5)


def _draw_links(axes: Axes, picture: Picture) -> None:
    from matplotlib.collections import LineCollection

    home = {i: group for group in picture.groups for i in group}
    kept = sorted(picture.links - picture.attack.links)
    best = [link for link in kept if home[link[0]] == picture.best]
    other = [link for link in kept if home[link[0]] != picture.best]
    for links, colour, style, label in (
        (other, LOST, "solid", "link of another group"),
        (best, SURVIVING, "solid", "link of the best group"),
        (sorted(picture.attack.links), CUT, (0, (4, 3)), "cut link"),
    ):
        if links:
            segments = [picture.after[list(link), :2] for link in links]
            alpha = 0.55 if len(links) <= MANY_LINKS else 0.55 * (MANY_LINKS / len(links)) ** 0.7
            look: dict[str, Any] = {"colors": colour, "linestyles": [style], "linewidths": 1.1, "alpha": alpha}
            axes.add_collection(LineCollection(segments, **look))
            axes.plot([], [], color=colour, linestyle=style, linewidth=1.3, label=label)


def _draw_targets(axes: Axes, picture: Picture) -> None:
    from matplotlib.patches import Ellipse

    for mean, prior, posterior in zip(picture.targets, picture.prior, picture.posterior, strict=True):
        before: dict[str, Any] = {"fill": False, "linestyle": ":"}
        after: dict[str, Any] = {"alpha": 0.35}
        for covariance, style in ((prior, before), (posterior, after)):
            variances, axes_of = np.linalg.eigh(covariance)
            width, height = 2 * SIGMAS * np.sqrt(variances)
            angle = float(np.degrees(np.arctan2(axes_of[1, 0], axes_of[0, 0])))
            axes.add_patch(Ellipse(mean, width, height, angle=angle, color=TARGET, linewidth=1.0, **style))
    axes.scatter(
        picture.targets[:, 0],
        picture.targets[:, 1],
        marker="*",
        s=70,
        color=TARGET,
        zorder=4,
        label="target (predicted)",
    )
    axes.plot([], [], color=TARGET, linestyle=":", label="95 % before measuring")
    axes.scatter([], [], marker="o", s=90, color=TARGET, alpha=0.35, label="95 % after, best group")


def _draw_robots(axes: Axes, picture: Picture) -> None:
    _draw_moves(axes, picture)
    sensing = picture.attack.sensing
    kinds = (
        (sorted(picture.best - sensing), SURVIVING, "robot after its move, best group"),
        (sorted(set(range(len(picture.after))) - picture.best - sensing), LOST, "robot after its move, cut off"),
    )
    for robots, colour, label in kinds:
        if robots:
            x, y, _ = picture.after[robots].T
            axes.scatter(x, y, s=110, color=colour, zorder=5, edgecolors="white", label=label)
    if sensing:
        x, y, _ = picture.after[sorted(sensing)].T
        axes.scatter(x, y, s=110, color="#e9c9cb", zorder=5, edgecolors="white")
        cross: dict[str, Any] = {"marker": "x", "s": 130, "linewidths": 2.4, "color": BLINDED, "zorder": 7}
        axes.scatter(x, y, label="blinded robot", **cross)
    _draw_headings(axes, picture)
    for i, pose in enumerate(picture.after):
        beside = i in sensing  # the cross would cover a number inside the disc
        style: dict[str, Any] = {"fontsize": 7, "weight": "bold", "zorder": 8, "color": BLINDED if beside else "white"}
        shift = (-11, 5) if beside else (0, 0)
        axes.annotate(str(i), pose[:2], shift, textcoords="offset points", ha="center", va="center", **style)


def _draw_moves(axes: Axes, picture: Picture) -> None:
    """A ring where each robot is now, and an arrow to where its control takes it."""
    x, y, _ = picture.before.T
    ring: dict[str, Any] = {"s": 26, "facecolors": "none", "edgecolors": "#555555", "zorder": 3}
    axes.scatter(x, y, label="robot now", **ring)
    moves = picture.after[:, :2] - picture.before[:, :2]
    scale: dict[str, Any] = {"angles": "xy", "scale_units": "xy", "scale": 1}
    axes.quiver(x, y, *moves.T, **scale, width=0.003, color="#555555", zorder=3)


def _draw_headings(axes: Axes, picture: Picture) -> None:
    """A short arrow from each robot along its heading, of the same length on paper for any map."""
    x, y, heading = picture.after.T
    length: dict[str, Any] = {"units": "inches", "scale_units": "inches", "scale": 1 / 0.2, "width": 0.014}
    look: dict[str, Any] = {"color": "#222222", "zorder": 4, "headlength": 4, "headaxislength": 4}
    axes.quiver(x, y, np.cos(heading), np.sin(heading), **length, **look)
