"""Fig. small_comp: five planners under the worst attack, four robots and four targets.

``python -m analysis.paper.small_scale --trials 10 --out DIR``
"""

import sys
from collections.abc import Mapping, Sequence
from pathlib import Path

from analysis.paper.comparison_figure import draw_comparison
from ratt_opt.studies.cases import Case
from ratt_opt.studies.command import Entry, main
from ratt_opt.studies.study import Study

STUDY = Study(
    name="small_scale",
    cases=tuple(
        Case(n_robots=4, n_targets=4, alpha_s=alpha_s, alpha_c=alpha_c) for alpha_s in (1, 2) for alpha_c in (3, 4)
    ),
    planners=("maxmin", "ratt", "nonrobust_optimum", "greedy", "random"),
    attackers=("worst",),
    metrics=("value", "trace", "mse"),
)


def draw(rows: Sequence[Mapping[str, str]], folder: Path) -> None:
    """One group of bars a budget pair; trace above, mean squared error below, as in the paper."""
    draw_comparison(rows, folder, name="small_scale", panels=[STUDY.cases])


ENTRY = Entry(STUDY, draw)

if __name__ == "__main__":
    sys.exit(main("Small-scale comparison of Section VI.", [ENTRY], trials=10))
