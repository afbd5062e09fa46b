"""The mission as a GIF: robots, groups, cut links, targets and ellipses, step by step. No system codec is needed."""

from __future__ import annotations

from io import BytesIO
from typing import TYPE_CHECKING, Any

import numpy as np

from ratt_opt.missions.drawing.frames import frames_of, limits
from ratt_opt.report.fields import sector
from ratt_opt.report.palette import BLINDED, CUT, INK, LOST, SURVIVING, TARGET
from ratt_opt.running.interrupts import imported_whole

if TYPE_CHECKING:
    from pathlib import Path

    from matplotlib.axes import Axes

    from ratt_opt.missions.result import FlownMission

__all__ = ["save_gif"]

ROLES = {"best group": (SURVIVING, "o"), "cut off": (LOST, "s"), "blinded": (BLINDED, "X")}


def save_gif(mission: FlownMission, path: Path, width: float = 6.4, duration: int = 250) -> None:
    """Write the animation, whose pictures are ``width`` inches wide and shown for a ``duration`` [ms] each."""
    from PIL import Image

    frames = frames_of(mission)
    view = limits(frames)
    height = min(max(width * (view[3] - view[2]) / (view[1] - view[0]), 2.0), 2 * width) + 1.2
    pictures, kind = [], imported_whole("matplotlib.figure").Figure
    for frame, rmse in zip(frames, mission.rmse, strict=True):
        figure = kind(figsize=(width, height), layout="constrained")
        axes = figure.subplots()
        _draw(axes, frame)
        axes.set_xlim(view[0], view[1])
        axes.set_ylim(view[2], view[3])
        axes.set_aspect("equal")
        axes.set_xlabel("x [m]")
        axes.set_ylabel("y [m]")
        figure.legend(loc="outside lower center", ncols=5, frameon=False, fontsize=8)
        axes.set_title(f"step {frame['step']}: RMSE {rmse:.3g} m", fontsize=10)
        buffer = BytesIO()
        figure.savefig(buffer, dpi=80, format="png")
        pictures.append(Image.open(buffer).convert("P", palette=Image.Palette.ADAPTIVE, colors=64))
    first, *rest = pictures
    first.save(path, format="GIF", save_all=True, append_images=rest, duration=duration, loop=0)


def _draw(axes: Axes, frame: dict[str, Any]) -> None:
    from matplotlib.collections import LineCollection
    from matplotlib.patches import Ellipse

    robots = np.array(frame["robots"])
    for links, colour, style in ((frame["links"], LOST, "solid"), (frame["cut"], CUT, (0, (4, 3)))):
        segments = [(robots[i, :2], robots[j, :2]) for i, j in links]
        axes.add_collection(LineCollection(segments, colors=colour, linestyles=[style], linewidths=0.9, alpha=0.7))
    for (x, y, heading), role, (angle, radius) in zip(frame["robots"], frame["roles"], frame["fields"], strict=False):
        axes.add_patch(sector((x, y), radius, (heading, angle), ROLES[role][0]))
    for place, (long, short, angle) in zip(frame["estimates"], frame["ellipses"], strict=True):
        look: dict[str, Any] = {"angle": float(np.degrees(angle)), "color": TARGET, "alpha": 0.25}
        axes.add_patch(Ellipse(place, 2 * long, 2 * short, **look))
    for places, marker, label in ((frame["targets"], "*", "target"), (frame["estimates"], "+", "estimate, 95 %")):
        x, y = np.array(places).T
        axes.scatter(x, y, marker=marker, s=50, color=TARGET, label=label, zorder=3)
    for role, (colour, marker) in ROLES.items():
        chosen = robots[[r == role for r in frame["roles"]]]
        axes.scatter(chosen[:, 0], chosen[:, 1], s=70, color=colour, marker=marker, label=role, zorder=4)
    beside: dict[str, Any] = {"textcoords": "offset points", "fontsize": 7, "color": INK, "zorder": 6}
    for letter, places in (("", robots[:, :2]), ("T", np.array(frame["targets"]))):
        for number, place in enumerate(places):
            axes.annotate(f"{letter}{number}", place, xytext=(6, 5), **beside)
    turn: dict[str, Any] = {"units": "inches", "scale_units": "inches", "scale": 1 / 0.18, "width": 0.014, "zorder": 5}
    axes.quiver(robots[:, 0], robots[:, 1], np.cos(robots[:, 2]), np.sin(robots[:, 2]), **turn)
