"""Fig. large_comp: three planners under the bounded-rational attack, ten to thirty robots.

``python -m analysis.paper.large_scale --trials 10 --out DIR``
"""

import sys
from collections.abc import Mapping, Sequence
from pathlib import Path

from analysis.paper.comparison_figure import draw_comparison
from ratt_opt.studies.cases import Case
from ratt_opt.studies.command import Entry, main
from ratt_opt.studies.study import Study

SIZES = ((10, 15), (20, 20), (30, 25))


def budgets(n_robots: int) -> tuple[tuple[int, int], ...]:
    """Return the paper's three pairs of sensing and link attacks for a complete graph."""
    links = n_robots * (n_robots - 1) // 2
    return (n_robots // 3, links // 4), (n_robots // 2, links // 3), (2 * n_robots // 3, links // 2)


STUDY = Study(
    name="large_scale",
    cases=tuple(
        Case(n_robots=n, n_targets=m, alpha_s=alpha_s, alpha_c=alpha_c)
        for n, m in SIZES
        for alpha_s, alpha_c in budgets(n)
    ),
    planners=("ratt", "greedy", "random"),
    attackers=("bounded_rational",),
    metrics=("value", "trace", "mse"),
)


def draw(rows: Sequence[Mapping[str, str]], folder: Path) -> None:
    """One panel per team size with its three budget pairs; trace above, mean squared error below."""
    panels = [[case for case in STUDY.cases if case.n_robots == n] for n, _ in SIZES]
    draw_comparison(rows, folder, name="large_scale", panels=panels)


ENTRY = Entry(STUDY, draw)

if __name__ == "__main__":
    sys.exit(main("Large-scale comparison of Section VI.", [ENTRY], trials=10))
