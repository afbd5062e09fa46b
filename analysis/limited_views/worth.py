"""Worth of robust planning, in a figure and three sentences: ``python -m analysis.limited_views.worth --out DIR``.

Error under the worst attack against that of greedy plans, over the field of view and the network. The command writes
``limited_views.md`` and ``limited_views.png`` into the folder of the results; every number comes from the rows.
"""

from __future__ import annotations

import sys
from typing import TYPE_CHECKING

import numpy as np

from analysis.limited_views.flights import COMPLETE, SEARCHED, case_of, scenario_of
from analysis.limited_views.verdicts import Outcome, outcome, relative_change
from ratt_opt._files import write_atomically
from ratt_opt.missions.run import run_mission
from ratt_opt.studies.command import Entry, main
from ratt_opt.studies.plots import new_figure, points
from ratt_opt.studies.statistics import Estimate, column, select
from ratt_opt.studies.store import read_table
from ratt_opt.studies.study import Study

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence
    from pathlib import Path

    from matplotlib.figure import Figure

    from ratt_opt.studies.cases import Case, Cell, Seeds

    Rows = Sequence[Mapping[str, str]]
    Changes = dict[str, dict[tuple[str, str], Estimate]]

__all__ = ["STUDY", "changes_of", "figure_of", "sentences", "write_page"]

STEPS = 10
"""Length of a mission."""
BASE, COMPARED = "greedy", ("ratt", "refined", "maxmin")
VIEWS, NETWORKS = (30, 60, 120, 360), (COMPLETE, 45)


def measured(study: Study, case: Case, seeds: Seeds) -> dict[str, Cell]:
    """Error of one mission for each planner [m], under the worst attacks."""
    scenario = scenario_of(case, seeds)
    row: dict[str, Cell] = {}
    for planner, chosen in study.named_planners.items():
        how = SEARCHED.get(planner, chosen)
        mission = run_mission(scenario, steps=STEPS, planner=how, attacker="worst", seed=seeds.simulation)
        row[f"{planner}/worst/rmse"] = float(np.sqrt(mission.squared_errors.mean()))
    return row


STUDY = Study(
    name="worth",
    cases=tuple(case_of(view=view, links=links) for links in NETWORKS for view in VIEWS),
    planners=(BASE, *COMPARED),
    attackers=("worst",),
    metrics=("rmse",),
    measure=measured,
)


def changes_of(rows: Rows) -> Changes:
    """Change of the error against greedy plans [%], paired, by planner and by (network, view)."""
    cells = [(str(links), str(view)) for links in NETWORKS for view in VIEWS]
    kept = {cell: select(rows, links=cell[0], view=cell[1]) for cell in cells}
    return {planner: {cell: _change(kept[cell], planner) for cell in cells} for planner in COMPARED}


def _change(rows: Rows, planner: str) -> Estimate:
    ours, theirs = (column(rows, f"{name}/worst/rmse") for name in (planner, BASE))
    found = relative_change(ours, theirs)
    return Estimate(100 * found.mean, 100 * found.low, 100 * found.high, found.n)


def figure_of(rows: Rows) -> Figure:
    """A panel for each network: the change of the error over the view, with 95 % intervals."""
    changes = changes_of(rows)
    figure = new_figure(9, 4.2)
    every = figure.subplots(1, len(NETWORKS), sharey=True)
    for axes, links in zip(every, NETWORKS, strict=True):
        series = {planner: [cells[str(links), str(view)] for view in VIEWS] for planner, cells in changes.items()}
        points(axes, [f"{view}°" for view in VIEWS], series)
        axes.axhline(0, color="#222222", linewidth=1.2, linestyle="--")
        axes.set_title("every robot reaches every other" if links == COMPLETE else f"links within {links} m")
        axes.set_xlabel("field of view of a camera")
    every[0].set_ylabel("tracking error against greedy plans [%]\nunder the worst attack (lower is better)")
    handles, labels = every[0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside upper center", ncols=len(labels), frameon=False)
    trials = len({row["trial"] for row in rows})
    figure.supxlabel(f"{trials} teams and missions of {STEPS} steps a point, paired; 95 % intervals", fontsize="small")
    return figure


def sentences(rows: Rows) -> tuple[str, str, str]:
    """Three verdicts: the cases in which the best planner pays, those in which it does not, and RATT alone."""
    changes = changes_of(rows)
    best = min(COMPARED, key=lambda planner: np.mean([change.mean for change in changes[planner].values()]))
    gains = [-change.mean for change in changes[best].values() if outcome(change) is Outcome.PAYS]
    most = f"by {min(gains):.0f} to {max(gains):.0f} %" if gains else "nowhere beyond chance"
    first = (
        f"Plans by `{best}` lower the tracking error under the worst attack {most}{_at(changes[best], Outcome.PAYS)}."
    )
    unseen, costs = (_at(changes[best], kind) for kind in (Outcome.UNSEEN, Outcome.COSTS))
    second = f"No difference is seen{unseen}" if unseen else "In no case is the difference within chance"
    second += f"; they cost accuracy{costs}." if costs else "; nowhere do they cost accuracy beyond chance."
    pays, harms = (_at(changes["ratt"], kind) for kind in (Outcome.PAYS, Outcome.COSTS))
    third = f"RATT alone, which needs no search, pays{pays or ' nowhere beyond chance'}"
    return first, second, f"{third}, and costs{harms}." if harms else f"{third}."


def _at(cells: Mapping[tuple[str, str], Estimate], kind: Outcome) -> str:
    """The views with that outcome, network by network."""
    parts = []
    for links in NETWORKS:
        views = [f"{view}°" for view in VIEWS if outcome(cells[str(links), str(view)]) is kind]
        network = "on complete networks" if links == COMPLETE else f"with links within {links} m"
        parts += [f"{network} at views of {', '.join(views)}"] if views else []
    return f" {' and '.join(parts)}" if parts else ""


PAGE = """# Is it worth it?

![Change of the tracking error against greedy plans, over the field of view and the network](limited_views.png)

{sentences}

Six robots with cameras that must choose what to look at, five targets; the adversary blinds two robots and cuts four
links in every step (`limited_view_scenario`). A greedy plan ignores the adversary. Below the dashed line robust plans
are better; an interval that meets the line shows no difference. One interval in twenty misses by chance. All numbers:
[tables](limited_views_tables.md). This page is written by

<!-- slow -->
```bash
python -m analysis.limited_views.worth --trials {trials} --out results
```
"""


def write_page(folder: Path) -> None:
    """Write the page and its figure beside the results."""
    rows = read_table(folder / STUDY.name)
    figure = figure_of(rows)
    trials = len({row["trial"] for row in rows})
    text = PAGE.format(sentences="\n".join(f"- {one}" for one in sentences(rows)), trials=trials)
    write_atomically(folder / "limited_views.png", lambda file: figure.savefig(file, dpi=120))
    write_atomically(folder / "limited_views.md", lambda file: file.write_text(text, encoding="utf-8"))


if __name__ == "__main__":
    sys.exit(main("Is it worth it?", [Entry(STUDY)], trials=24, after=write_page))
