"""Communication graphs that are not complete: RATT with the exact smallest largest group instead of CAA.

``python -m analysis.extended.graphs --trials 200 --out DIR``
"""

from __future__ import annotations

import sys
from typing import TYPE_CHECKING

from analysis.extended.ratio_figure import draw_ratios
from ratt_opt.studies.cases import Case
from ratt_opt.studies.command import Entry, main
from ratt_opt.studies.study import Study

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence
    from pathlib import Path

GRAPHS = ("complete", "ladder", "grid", "ring", "star", "line")
STUDY = Study(
    name="graphs",
    cases=tuple(
        Case(n_robots=8, n_targets=10, alpha_s=s, alpha_c=c, graph=graph)
        for s, c in ((1, 2), (2, 4))
        for graph in GRAPHS
    ),
    planners=("ratt", "greedy", "myopic"),
    attackers=("worst",),
    metrics=("value", "proved"),
    quantities=("optimum",),
)


def draw(rows: Sequence[Mapping[str, str]], folder: Path) -> None:
    """One panel per budget pair, one group of bars per graph."""
    panels = {
        f"$\\alpha_s$={s}, $\\alpha_c$={c}": {k.graph: k for k in STUDY.cases if (k.alpha_s, k.alpha_c) == (s, c)}
        for s, c in dict.fromkeys((case.alpha_s, case.alpha_c) for case in STUDY.cases)
    }
    draw_ratios(rows, folder, name=STUDY.name, panels=panels)


ENTRY = Entry(STUDY, draw)

if __name__ == "__main__":
    sys.exit(main("Communication graphs that are not complete.", [ENTRY], trials=200))
