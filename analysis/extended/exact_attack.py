"""The large-scale comparison of the paper against the exact attacker and the certified optimum.

``python -m analysis.extended.exact_attack --trials 200 --out DIR``
"""

from __future__ import annotations

import sys
from dataclasses import replace
from typing import TYPE_CHECKING

from analysis.paper.large_scale import SIZES
from analysis.paper.large_scale import STUDY as PAPER
from ratt_opt.studies.command import Entry, main
from ratt_opt.studies.plots import bars, new_figure, save
from ratt_opt.studies.statistics import column, estimate, players, select

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence
    from pathlib import Path

STUDY = replace(
    PAPER,
    name="exact_attack",
    planners=("maxmin", "ratt", "greedy", "random"),
    attackers=("worst", "bounded_rational"),
    metrics=("value", "proved", "trace"),
    quantities=("optimum", "trace_bound"),
)


def draw(rows: Sequence[Mapping[str, str]], folder: Path) -> None:
    """Draw the trace under the exact attack (above) and its largest excess over the best in per cent (below)."""
    figure = new_figure(11, 6.2)
    planners = players(rows, "trace")["worst"]
    axes = figure.subplots(2, len(SIZES), sharey="row")
    for across, (n, m) in enumerate(SIZES):
        cases = [case for case in STUDY.cases if case.n_robots == n]
        kept = [select(rows, case=case.name) for case in cases]
        groups = [f"$\\alpha_s$={case.alpha_s}\n$\\alpha_c$={case.alpha_c}" for case in cases]
        traces = {p: [column(k, f"{p}/worst/trace") for k in kept] for p in planners}
        bars(axes[0, across], groups, {p: [estimate(values) for values in traces[p]] for p in planners})
        bounds = [column(k, "optimum/trace_bound") for k in kept]
        excess = {
            p: [estimate(100 * (t / bound - 1)) for t, bound in zip(traces[p], bounds, strict=True)]
            for p in ("maxmin", "ratt", "greedy")
        }
        bars(axes[1, across], groups, excess)
        axes[0, across].set_title(f"N={n}, M={m}")
    axes[0, 0].set_ylabel("trace of covariance per target [m²]\nunder the exact attack")
    axes[1, 0].set_ylabel("trace above what is\nproved of every plan [%]")
    handles, labels = axes[0, 0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside upper center", ncols=4, frameon=False)
    figure.supxlabel(f"mean of {len(kept[0])} paired trials with 95 % interval", fontsize="small")
    save(figure, folder, STUDY.name)


ENTRY = Entry(STUDY, draw)

if __name__ == "__main__":
    sys.exit(main("Large teams against the exact attacker and the certified optimum.", [ENTRY], trials=200))
