"""Worth of robust planning, in a figure and three sentences, from the rows of the studies.

Error under the worst attack against that of greedy plans: in the main cell, and with one factor varied at a time.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from analysis.limited_views.flights import COMPLETE, PLANNERS, STEPS, UNLIMITED, case_of
from analysis.limited_views.verdicts import Outcome, outcome, relative_change
from ratt_opt.studies.plots import new_figure, points
from ratt_opt.studies.statistics import Estimate, column, select

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from matplotlib.figure import Figure

    from ratt_opt.studies.cases import Case

    Rows = Sequence[Mapping[str, str]]

__all__ = ["COMPARED", "FACTORS", "change_of", "figure_of", "sentences", "worth_page"]

COMPARED = ("ratt", "refined", "maxmin")
FACTORS: dict[str, dict[str, Case]] = {
    "field of view [degrees]": {str(view): case_of(view=view) for view in (30, 60, 120, 360)},
    "reach of a camera [m]": {"30": case_of(reach=30), "40": case_of(), "any": case_of(reach=UNLIMITED)},
    "range of a link [m]": {"30": case_of(links=30), "45": case_of(), "any": case_of(links=COMPLETE)},
    "targets": {str(count): case_of(n_targets=count) for count in (3, 6, 10)},
    "sensor's noise": {noise: case_of(noise=noise) for noise in ("camera", "radar", "coarse")},
    "attacks": {kind: case_of(attacks=kind) for kind in ("renewed", "persistent")},
}
"""Panels of the figure: the factor, and its values with their cells; the main cell is in each."""
MAIN = case_of()


def change_of(rows: Rows, case: Case, planner: str) -> Estimate:
    """Change of the error of a planner's missions against greedy ones [%], paired."""
    kept = select(rows, case=case.name)
    ours, theirs = (column(kept, f"{name}/worst/rmse") for name in (planner, PLANNERS[0]))
    found = relative_change(ours, theirs)
    return Estimate(100 * found.mean, 100 * found.low, 100 * found.high, found.n)


def figure_of(rows: Rows) -> Figure:
    """A panel for each factor: the change of the error, with 95 % intervals; the main cell has a grey ground."""
    figure = new_figure(10.5, 6.4)
    every = figure.subplots(2, len(FACTORS) // 2, sharey=True)
    for axes, (factor, cells) in zip(every.flat, FACTORS.items(), strict=True):
        points(axes, list(cells), {p: [change_of(rows, case, p) for case in cells.values()] for p in COMPARED})
        at = list(cells.values()).index(MAIN)
        axes.axvspan(at - 0.5, at + 0.5, color="#e8e8e8", zorder=0)
        axes.axhline(0, color="#222222", linewidth=1.2, linestyle="--")
        axes.set_xlabel(factor)
    for axes in every[:, 0]:
        axes.set_ylabel("error (RMSE) against\ngreedy plans [%]")
    handles, labels = every[0, 0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside upper center", ncols=len(labels), frameon=False)
    main, others = _missions(rows)
    note = f"missions of {STEPS} steps under the worst attack, paired, 95 % intervals; lower is better\n"
    note += f"grey: the main cell, {main} missions; the other cells have {others}"
    figure.supxlabel(note, fontsize="small")
    return figure


def _missions(rows: Rows) -> tuple[int, int]:
    """Missions of the main cell, and of each other one."""
    counts = [len(select(rows, case=case.name)) for cells in FACTORS.values() for case in cells.values()]
    return max(counts), min(counts)


def sentences(rows: Rows) -> tuple[str, str, str]:
    """Three verdicts: on the main cell, on the best of its planners elsewhere, and on RATT alone."""
    main = {planner: change_of(rows, MAIN, planner) for planner in COMPARED}
    best = min(COMPARED, key=lambda planner: main[planner].mean)
    told = ", ".join(f"`{planner}` {change.show()} %" for planner, change in main.items())
    first = f"Main cell, change of the tracking error under the worst attack against greedy plans: {told}."
    verdicts = f"{_verdicts(rows, best)}."
    return first, f"With one factor varied, plans by `{best}` {verdicts}", f"RATT alone {_verdicts(rows, 'ratt')}."


def _verdicts(rows: Rows, planner: str) -> str:
    """The varied cells in which a planner pays, costs, and makes no visible difference."""
    found: dict[Outcome, list[str]] = {kind: [] for kind in Outcome}
    for factor, cells in FACTORS.items():
        for kind in Outcome:
            values = [
                v for v, case in cells.items() if case != MAIN and outcome(change_of(rows, case, planner)) is kind
            ]
            found[kind] += [f"{factor} {' and '.join(values)}"] if values else []
    words = {
        Outcome.PAYS: "pays",
        Outcome.COSTS: "costs accuracy",
        Outcome.UNSEEN: "makes no difference beyond chance",
    }
    if planner != "ratt":
        words = {
            Outcome.PAYS: "pay",
            Outcome.COSTS: "cost accuracy",
            Outcome.UNSEEN: "make no difference beyond chance",
        }
    parts = [f"{words[kind]} at {', '.join(cells)}" for kind, cells in found.items() if cells]
    return "; ".join(parts)


PAGE = """# Is it worth it?

![Change of the tracking error against greedy plans, with one factor varied in each panel](limited_views.png)

{sentences}

Six robots with cameras that must choose what to look at; the adversary blinds two robots and cuts four links in every
step (`limited_view_scenario`). A greedy plan ignores the adversary. Below the dashed line robust plans are better; an
interval that meets the line shows no difference. One interval in twenty misses by chance. The main cell is the demo's
kind of team, chosen by a rule: [the tables](limited_views_tables.md) state it, with all numbers and the commands that
made this page.
"""


def worth_page(rows: Rows) -> str:
    """The page of the figure and the sentences."""
    return PAGE.format(sentences="\n".join(f"- {one}" for one in sentences(rows)))
