"""Figures of results: performance profiles, and gaps over time, one panel for each track."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.benchmark.runs.measures import profile, time_to
from ratt_opt.report.lettering import choose_fonts, literal
from ratt_opt.report.palette import looks_of
from ratt_opt.studies.plots import new_figure

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from ratt_opt.benchmark.runs.runner import SolverRows

__all__ = ["CLOSE", "gap_figure", "profile_figure", "steps_of"]

CLOSE = 1e-2
"""Gap to the best known value at which a profile calls an instance solved."""
TRACKS = {"P": "plans", "A": "attacks", "C": "cuts"}


def steps_of(row: Mapping[str, str]) -> list[tuple[float, float]]:
    """Times at which the answers of a row came [s], and their gaps."""
    return [(float(at), float(gap)) for at, gap in json.loads(row["steps"])]


def profile_figure(rows: Mapping[str, SolverRows], most: float = 1e3) -> Figure:
    """Draw the shares of instances solved within a factor, up to ``most``, of the best solver's time."""

    def draw(axes: Axes, group: dict[str, SolverRows], track: str) -> None:
        shared = sorted(set.intersection(*({row["instance"] for row in some} for some in group.values())))
        looks, times = looks_of(list(rows)), dict[str, list[float]]()
        for solver, some in group.items():
            by = {row["instance"]: row for row in some}
            times[solver] = [time_to(steps_of(by[name]), CLOSE) for name in shared]
        for solver, curve in (profile(times) if shared else {}).items():
            end = curve.shares[-1:] if len(curve.shares) else np.zeros(1)
            x = np.concatenate([[1.0], curve.factors, [most]])
            y = np.concatenate([[0.0], curve.shares, end])
            axes.step(x, y, where="post", color=looks[solver].colour, label=literal(solver))
        axes.set(xscale="log", xlim=(1, most), ylim=(0, 1.02), ylabel=f"share of {len(shared)} {track}")
        axes.set_xlabel("time to within 1 % of the best known value, over the best solver's [1]")

    return _panels(rows, draw)


def gap_figure(rows: Mapping[str, SolverRows]) -> Figure:
    """Draw the mean gap over time of each solver."""

    def draw(axes: Axes, group: dict[str, SolverRows], track: str) -> None:
        looks = looks_of(list(rows))
        for solver, some in group.items():
            limit = float(some[0]["limit"])
            grid = np.geomspace(limit / 100, limit, 200)
            curves = [[min([1.0, *(gap for at, gap in steps_of(row) if at <= t)]) for t in grid] for row in some]
            axes.plot(grid, 100 * np.mean(curves, axis=0), color=looks[solver].colour, label=literal(solver))
        axes.set(xscale="log", xlabel="time [s]", ylabel=f"mean gap of {track} [%]", ylim=(0, 102))

    return _panels(rows, draw)


def _panels(rows: Mapping[str, SolverRows], draw: Callable[[Axes, dict[str, SolverRows], str], None]) -> Figure:
    """One panel for each track, with the solvers that have rows of it."""
    found = {track: _of_track(rows, letter) for letter, track in TRACKS.items()}
    found = {track: group for track, group in found.items() if group}
    figure = new_figure(6.8, 3.2 * len(found))
    for axes, (track, group) in zip(figure.subplots(len(found), 1, squeeze=False)[:, 0], found.items(), strict=True):
        draw(axes, group, track)
        axes.legend(loc="center left", bbox_to_anchor=(1.01, 0.5), fontsize=8, frameon=False)
    choose_fonts(figure)
    return figure


def _of_track(rows: Mapping[str, SolverRows], letter: str) -> dict[str, SolverRows]:
    own = {solver: [row for row in some if row["class"].startswith(letter)] for solver, some in rows.items()}
    return {solver: some for solver, some in own.items() if some}
