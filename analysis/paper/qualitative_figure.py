"""One scene as the paper draws it: dots and arrows for robots, pentagrams, squares and ellipses for targets."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.lines import Line2D

__all__ = ["common_limits", "draw_scene", "legend", "squared_error"]

TARGET_COLOURS = ("#c1121f", "#1f4e9c", "#b5179e")
ROBOT_COLOURS = ("#c1121f", "#1f4e9c", "#b5179e")
SIGMAS = 2.0
"""Ellipses hold two standard deviations."""


def draw_scene(axes: Axes, picture: dict[str, Any]) -> None:
    """Draw one picture of the results of :mod:`analysis.paper.qualitative` [m]."""
    now, after = np.array(picture["now"]), np.array(picture["next"])
    _draw_links(axes, after, picture)
    for target, (true, guess, covariance) in enumerate(
        zip(*(np.array(picture[name]) for name in ("truth", "estimate", "covariance")), strict=True)
    ):
        colour = TARGET_COLOURS[target]
        for robot in picture["seeing"]:
            arrow = {
                "arrowstyle": "-|>",
                "color": "#3a9d5d",
                "linewidth": 0.8,
                "alpha": 0.7,
                "shrinkA": 8,
                "shrinkB": 8,
            }
            axes.annotate("", xy=tuple(guess), xytext=tuple(after[robot, :2]), arrowprops=arrow)
        axes.plot(*_ellipse(guess, covariance), color=colour, linewidth=1.3)
        axes.plot(*true, marker="*", markersize=13, color=colour, markeredgecolor="black", markeredgewidth=0.6)
        axes.plot(*guess, marker="s", markersize=7, markerfacecolor="none", color=colour, markeredgewidth=1.6)
    for robot, colour in zip(range(len(now)), ROBOT_COLOURS, strict=False):
        axes.plot(*now[robot, :2], "o", markersize=11, color=colour, alpha=0.3, markeredgewidth=0)
        axes.plot(*after[robot, :2], "o", markersize=11, color=colour)
        heading = 5 * np.array([np.cos(after[robot, 2]), np.sin(after[robot, 2])])
        axes.arrow(*after[robot, :2], *heading, width=0.25, head_width=1.6, color=colour, length_includes_head=True)
        number: dict[str, Any] = {
            "color": "white",
            "fontsize": 7,
            "fontweight": "bold",
            "ha": "center",
            "va": "center",
            "zorder": 6,
        }
        axes.text(after[robot, 0], after[robot, 1], str(robot), **number)
        if robot in picture["blinded"]:
            axes.plot(*after[robot, :2], "x", markersize=19, color="#d00000", markeredgewidth=3)
    axes.set_aspect("equal")
    axes.grid(alpha=0.25)
    axes.set(xlabel="x [m]", ylabel="y [m]")


def common_limits(pictures: Sequence[dict[str, Any]]) -> dict[str, tuple[float, float]]:
    """Return one window [m] that holds every picture, so that they can be compared; at most twice as wide as high."""
    points = [np.array(p[name])[:, :2] for p in pictures for name in ("now", "next", "truth", "estimate")]
    shapes = [pair for p in pictures for pair in zip(p["estimate"], p["covariance"], strict=True)]
    ellipses = [_ellipse(np.array(centre), np.array(covariance)).T for centre, covariance in shapes]
    low, high = (f(np.concatenate([*points, *ellipses]), axis=0) for f in (np.min, np.max))
    middle, half = (low + high) / 2, (high - low) / 2 + 4
    half = np.maximum(half, half.max() / 2)
    return {name: (m - h, m + h) for name, m, h in zip(("xlim", "ylim"), middle, half, strict=True)}


def squared_error(picture: dict[str, Any]) -> float:
    """Return the mean squared distance of estimate and truth in one picture [m^2]."""
    return float(((np.array(picture["truth"]) - np.array(picture["estimate"])) ** 2).sum(axis=1).mean())


def legend() -> list[Line2D]:
    """Return what the signs mean."""
    from matplotlib.lines import Line2D

    signs: list[tuple[str, dict[str, Any]]] = [
        ("robot now", {"marker": "o", "markersize": 10, "alpha": 0.3}),
        ("robot next, with number and heading", {"marker": "o", "markersize": 10}),
        ("true position", {"marker": "*", "markersize": 12, "markeredgecolor": "black"}),
        ("estimate", {"marker": "s", "markersize": 7, "markerfacecolor": "none"}),
        ("covariance, 2 standard deviations", {"linestyle": "-"}),
        ("measurement used", {"linestyle": "-", "marker": ">", "color": "#3a9d5d", "linewidth": 0.8}),
        ("communication link", {"linestyle": "--", "color": "black"}),
        ("attacked robot or link", {"marker": "x", "markersize": 12, "color": "#d00000"}),
    ]
    plain = {"color": "#555555", "linestyle": "none"}
    return [Line2D([], [], label=label, **(plain | sign)) for label, sign in signs]


def _draw_links(axes: Axes, after: np.ndarray[Any, Any], picture: dict[str, Any]) -> None:
    for i, j in picture["links"]:
        axes.plot(*after[[i, j], :2].T, "--", color="black", linewidth=1, zorder=0)
        if [i, j] in picture["cut"]:
            axes.plot(*after[[i, j], :2].mean(axis=0), "x", markersize=14, color="#d00000", markeredgewidth=2.5)


def _ellipse(centre: np.ndarray[Any, Any], covariance: np.ndarray[Any, Any]) -> np.ndarray[Any, Any]:
    """(2, K) outline of the points ``SIGMAS`` standard deviations from ``centre``."""
    angle = np.linspace(0, 2 * np.pi, 121)
    circle = np.stack([np.cos(angle), np.sin(angle)])
    return np.asarray(centre[:, None] + SIGMAS * np.linalg.cholesky(covariance) @ circle)
