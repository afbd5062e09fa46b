"""The two quantitative figures of the paper have one form: panels of budgets, bars of planners, two metrics."""

from collections.abc import Mapping, Sequence
from functools import partial
from pathlib import Path

from ratt_opt.studies.cases import Case
from ratt_opt.studies.plots import bars, new_figure, save
from ratt_opt.studies.statistics import Estimate, column, estimate, players, select

__all__ = ["draw_comparison"]

METRICS = {"trace": "trace of covariance", "mse": "mean squared error"}


def draw_comparison(
    rows: Sequence[Mapping[str, str]],
    folder: Path,
    *,
    name: str,
    panels: Sequence[Sequence[Case]],
) -> None:
    """Draw the planners of the rows under each of their attackers; the first one's files are called ``name`` alone.

    Two figures each: the means as in the paper, and ``..._paired``, what each planner has in excess of RATT.

    One column of axes per panel, one row per metric; bars are means with 95 % intervals. The second figure
    shows what the first hides: scenarios differ far more than planners do on the same scenario.
    """
    for k, (attacker, planners) in enumerate(players(rows, "trace").items()):
        of = name if k == 0 else f"{name}_{attacker}"
        columns = {planner: f"{planner}/{attacker}" for planner in planners}
        note = f"{attacker.replace('_', '-')} attack; mean of {len(select(rows, case=panels[0][0].name))} trials"
        draw = partial(_draw, rows, folder, panels=panels, note=note)
        draw(of, "per target [m²]", columns, paired=False)
        draw(f"{of}_paired", "minus RATT's [m²]", {p: c for p, c in columns.items() if p != "ratt"}, paired=True)


def _draw(
    rows: Sequence[Mapping[str, str]],
    folder: Path,
    name: str,
    label: str,
    shown: Mapping[str, str],
    *,
    panels: Sequence[Sequence[Case]],
    note: str,
    paired: bool,
) -> None:
    figure = new_figure(sum(max(3.2, 1.7 * len(cases)) for cases in panels) + 0.6, 5.4)
    axes = figure.subplots(2, len(panels), squeeze=False, sharey="row")
    for across, cases in enumerate(panels):
        groups = [f"$\\alpha_s$={case.alpha_s}\n$\\alpha_c$={case.alpha_c}" for case in cases]
        kept = [select(rows, case=case.name) for case in cases]
        for down, (metric, text) in enumerate(METRICS.items()):
            bars(axes[down, across], groups, _estimates(kept, shown, metric, paired=paired))
            axes[down, 0].set_ylabel(f"{text}\n{label}")
        axes[0, across].set_title(f"N={cases[0].n_robots}, M={cases[0].n_targets}")
    handles, labels = axes[0, 0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside upper center", ncols=min(len(labels), 6), frameon=False)
    figure.supxlabel(f"{note} with 95 % interval", fontsize="small")
    save(figure, folder, name)


def _estimates(
    kept: Sequence[Sequence[Mapping[str, str]]], columns: Mapping[str, str], metric: str, *, paired: bool
) -> dict[str, list[Estimate]]:
    """Mean of a metric per planner and case; with ``paired`` of its difference to RATT, trial by trial."""
    estimates = {}
    for planner, name in columns.items():
        values = [column(rows, f"{name}/{metric}") for rows in kept]
        if paired:
            base = [column(rows, f"ratt/{name.split('/')[1]}/{metric}") for rows in kept]
            values = [value - own for value, own in zip(values, base, strict=True)]
        estimates[planner] = [estimate(value) if paired else estimate(value).at_least(0.0) for value in values]
    return estimates
