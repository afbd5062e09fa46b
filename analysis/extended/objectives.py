"""All three objectives: what RATT and Greedy certifiably keep of the optimum.

``python -m analysis.extended.objectives --trials 200 --out DIR``
"""

from __future__ import annotations

import sys
from typing import TYPE_CHECKING

from analysis.extended.ratio_figure import draw_ratios
from analysis.paper.large_scale import budgets
from ratt_opt.studies.cases import Case
from ratt_opt.studies.command import Entry, main
from ratt_opt.studies.study import Study

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence
    from pathlib import Path

OBJECTIVES = {"trace": "trace", "logdet": "log-determinant", "maxeig": "largest eigenvalue"}
STUDY = Study(
    name="objectives",
    cases=tuple(
        Case(n_robots=10, n_targets=15, alpha_s=s, alpha_c=c, objective=o)
        for o in OBJECTIVES
        for s, c in budgets(10)[::2]
    ),
    planners=("ratt", "greedy", "random"),
    attackers=("worst",),
    metrics=("value", "proved"),
    quantities=("optimum",),
)


def draw(rows: Sequence[Mapping[str, str]], folder: Path) -> None:
    """One panel per objective, one group of bars per budget pair."""
    panels = {
        label: {f"$\\alpha_s$={c.alpha_s}\n$\\alpha_c$={c.alpha_c}": c for c in STUDY.cases if c.objective == objective}
        for objective, label in OBJECTIVES.items()
    }
    draw_ratios(rows, folder, name=STUDY.name, panels=panels, one_scale=False)


ENTRY = Entry(STUDY, draw)

if __name__ == "__main__":
    sys.exit(main("Three objectives against the certified optimum.", [ENTRY], trials=200))
