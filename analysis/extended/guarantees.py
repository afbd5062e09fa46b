"""A-priori guarantee, exact worst-case ratio and certified per-instance ratio, side by side.

``python -m analysis.extended.guarantees --trials 200 --out DIR``
"""

from __future__ import annotations

import sys
from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.report.palette import PLANNERS
from ratt_opt.studies.cases import Case
from ratt_opt.studies.command import Entry, main
from ratt_opt.studies.plots import new_figure, save
from ratt_opt.studies.statistics import column, select
from ratt_opt.studies.study import Study

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence
    from pathlib import Path

    from matplotlib.axes import Axes

    from ratt_opt._validation import FloatArray
    from ratt_opt.report.palette import Look

STUDY = Study(
    name="guarantees",
    cases=tuple(
        Case(n_robots=4, n_targets=4, alpha_s=s, alpha_c=c, objective=objective)
        for objective in ("logdet", "trace")
        for s, c in ((1, 3), (1, 4), (2, 3), (2, 4))
    ),
    planners=("ratt",),
    attackers=("worst",),
    metrics=("value", "proved"),
    quantities=("optimum", "guarantees"),
)
OBJECTIVES = {"logdet": "log-determinant (curvature k)", "trace": "trace (total curvature c)"}
SHOWN = {
    "theorem1": ("Theorem 1 of the paper", PLANNERS["myopic"]),
    "pattern_free": ("pattern-free bound", PLANNERS["nonrobust_optimum"]),
    "ratio": ("smallest ratio of all functions so curved", PLANNERS["greedy"]),
    "certified": ("certified on the instance", PLANNERS["ratt"]),
}


def shares(rows: Sequence[Mapping[str, str]]) -> dict[str, FloatArray]:
    """(T,) each kind of guarantee: RATT's least share of the optimum under any attack."""
    certified = column(rows, "ratt/worst/proved") / column(rows, "optimum/upper")
    return {name: certified if name == "certified" else column(rows, name) for name in SHOWN}


def draw(rows: Sequence[Mapping[str, str]], folder: Path) -> None:
    """One panel per objective: range, quartiles and median of each kind of guarantee, over budget pairs."""
    figure = new_figure(11, 4.6)
    for axes, (objective, title) in zip(figure.subplots(1, 2, sharey=True), OBJECTIVES.items(), strict=True):
        cases = [case for case in STUDY.cases if case.objective == objective]
        for at, case in enumerate(cases):
            for k, (name, values) in enumerate(shares(select(rows, case=case.name)).items()):
                _strip(axes, at + 0.2 * (k - 1.5), values, *SHOWN[name])
        axes.set_xticks(range(len(cases)), [f"$\\alpha_s$={c.alpha_s}\n$\\alpha_c$={c.alpha_c}" for c in cases])
        axes.set(yscale="log", title=title)
        axes.spines[["top", "right"]].set_visible(False)
        axes.grid(axis="y", alpha=0.3)
    figure.axes[0].set_ylabel("guaranteed share of the optimum")
    handles, labels = figure.axes[0].get_legend_handles_labels()
    figure.legend(handles[: len(SHOWN)], labels[: len(SHOWN)], loc="outside upper center", ncols=4, frameon=False)
    note = f"N=M=4, exact attack; range, quartiles and median of {len(rows) // len(STUDY.cases)} trials"
    figure.supxlabel(note, fontsize="small")
    save(figure, folder, STUDY.name)


def _strip(axes: Axes, at: float, values: FloatArray, label: str, look: Look) -> None:
    low, first, middle, third, high = np.quantile(values, [0, 0.25, 0.5, 0.75, 1])
    colour = look.colour
    axes.plot([at, at], [low, high], color=colour, linewidth=1.2)
    axes.plot([at, at], [first, third], color=colour, linewidth=9, solid_capstyle="butt", alpha=0.55)
    axes.plot(at, middle, look.marker, color=colour, markersize=5, markeredgecolor="white", label=label)


ENTRY = Entry(STUDY, draw)

if __name__ == "__main__":
    sys.exit(main("Three kinds of guarantees side by side.", [ENTRY], trials=200))
