"""The two quantitative figures of the paper have one form: panels of budgets, bars of planners, two metrics."""

from __future__ import annotations

from typing import TYPE_CHECKING

from analysis.studies.plots import bars, new_figure, save
from analysis.studies.statistics import column, estimate, select

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence
    from pathlib import Path

    from analysis.studies.study import Case

__all__ = ["draw_comparison"]

METRICS = {"trace": "trace of covariance\nper target [m²]", "mse": "mean squared error\nper target [m²]"}


def draw_comparison(
    rows: Sequence[Mapping[str, str]],
    folder: Path,
    *,
    name: str,
    panels: Sequence[Sequence[Case]],
    planners: Sequence[str],
    attacker: str,
) -> None:
    """Draw mean and 95 % interval of every planner: one column of axes per panel, one row per metric."""
    figure = new_figure(3.2 * len(panels) + 0.6, 5.4)
    axes = figure.subplots(2, len(panels), squeeze=False, sharey="row")
    trials = len(select(rows, case=panels[0][0].name))
    for across, cases in enumerate(panels):
        groups = [f"$\\alpha_s$={case.alpha_s}\n$\\alpha_c$={case.alpha_c}" for case in cases]
        for down, (metric, label) in enumerate(METRICS.items()):
            series = {
                planner: [
                    estimate(column(select(rows, case=case.name), f"{planner}/{attacker}/{metric}")) for case in cases
                ]
                for planner in planners
            }
            bars(axes[down, across], groups, series)
            if across == 0:
                axes[down, across].set_ylabel(label)
        axes[0, across].set_title(f"N={cases[0].n_robots}, M={cases[0].n_targets}")
    handles, labels = axes[0, 0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside upper center", ncols=len(planners), frameon=False)
    figure.supxlabel(
        f"{attacker.replace('_', '-')} attack; mean of {trials} trials with 95 % interval", fontsize="small"
    )
    save(figure, folder, name)
