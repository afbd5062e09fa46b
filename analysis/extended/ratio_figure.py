"""Worst cases of planners as shares of the certified optimum."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ratt_opt.studies.plots import new_figure, points, save
from ratt_opt.studies.statistics import column, estimate, players, select

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence
    from pathlib import Path

    from ratt_opt.studies.cases import Case

__all__ = ["draw_ratios"]


def draw_ratios(
    rows: Sequence[Mapping[str, str]],
    folder: Path,
    *,
    name: str,
    panels: Mapping[str, Mapping[str, Case]],
    one_scale: bool = True,
) -> None:
    """Draw one panel per entry of ``panels`` with one group of points per case, labelled by the inner key.

    A point is the mean of proved worst case over upper bound of the optimum: what is certified trial by trial. The
    optimum's own point is its lower bound over its upper bound: what is missing to 100 % is not decided.
    ``one_scale`` : all panels have the same vertical axis.
    """
    planners = players(rows, "proved")["worst"]
    groups = max(map(len, panels.values()))
    figure = new_figure(1.6 + max(3.2, 0.85 * groups) * len(panels), 3.9)
    axes = figure.subplots(1, len(panels), squeeze=False, sharey=one_scale)[0]
    for panel, (title, cases) in zip(axes, panels.items(), strict=True):
        kept = [select(rows, case=case.name) for case in cases.values()]
        proved = {"maxmin": "optimum/lower", **{planner: f"{planner}/worst/proved" for planner in planners}}
        ratios = {
            planner: [estimate(100 * column(k, name) / column(k, "optimum/upper")) for k in kept]
            for planner, name in proved.items()
        }
        points(panel, list(cases), ratios)
        panel.axhline(100, color="black", linewidth=0.8, zorder=0)
        panel.set_title(title)
    axes[0].set_ylabel("certified share of the optimum [%]")
    handles, labels = axes[0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside upper center", ncols=min(len(labels), 5), frameon=False)
    figure.supxlabel(f"exact attack; mean of {len(kept[0])} paired trials with 95 % interval", fontsize="small")
    save(figure, folder, name)
