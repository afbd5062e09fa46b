"""Fig. caa_show: links that a team of five keeps when its largest group has n robots.

``python -m analysis.paper.caa --out DIR``
"""

import sys
from collections.abc import Mapping, Sequence
from itertools import combinations
from pathlib import Path

import numpy as np

from ratt_opt.graph.survivor_sizes import caa
from ratt_opt.studies.cases import Case, Cell, Seeds
from ratt_opt.studies.command import Entry, main
from ratt_opt.studies.plots import new_figure, save
from ratt_opt.studies.study import Study

N_ROBOTS = 5
N_LINKS = N_ROBOTS * (N_ROBOTS - 1) // 2
STUDY = Study(
    name="caa",
    cases=tuple(Case(n_robots=N_ROBOTS, n_targets=1, alpha_s=0, alpha_c=alpha_c) for alpha_c in range(N_LINKS + 1)),
    measure="analysis.paper.caa:measure",
    fixed_trials=1,
)
GROUP_COLOURS = ("#1f4e9c", "#e8871e", "#2a9d4b", "#b5179e", "#6c757d")


def measure(study: Study, case: Case, seeds: Seeds) -> dict[str, Cell]:
    """Apply CAA to one link budget; nothing is random."""
    del study, seeds
    result = caa(case.n_robots, case.alpha_c)
    return {"kept": N_LINKS - case.alpha_c, "n_max": result.n_max, "alpha_cs": result.alpha_cs}


def draw(rows: Sequence[Mapping[str, str]], folder: Path) -> None:
    """One panel per size n of the largest group: the most links that still let CAA answer n."""
    figure = new_figure(11, 2.9)
    angles = np.pi / 2 - 2 * np.pi * np.arange(N_ROBOTS) / N_ROBOTS
    x, y = np.cos(angles), np.sin(angles)
    for n, axes in enumerate(figure.subplots(1, N_ROBOTS), start=1):
        kept = max(int(row["kept"]) for row in rows if int(row["n_max"]) == n)
        group = np.arange(N_ROBOTS) // n
        for i, j in combinations(range(N_ROBOTS), 2):
            if group[i] == group[j]:
                axes.plot(x[[i, j]], y[[i, j]], "--", color="#444444", linewidth=1.2, zorder=1)
        axes.scatter(x, y, s=260, c=[GROUP_COLOURS[g] for g in group], zorder=2)
        axes.set(xlim=(-1.4, 1.4), ylim=(-1.3, 1.35), aspect="equal", title=f"$\\overline{{e}}_{n}$ = {kept},  n = {n}")
        axes.set_axis_off()
    answer = next(row for row in rows if int(row["alpha_c"]) == 7)
    text = f"7 links cut: 3 are left, so $n_{{\\max}}$ = {answer['n_max']} and $\\alpha_{{c,s}}$ = {answer['alpha_cs']}"
    figure.supxlabel(text)
    save(figure, folder, "caa")


ENTRY = Entry(STUDY, draw)

if __name__ == "__main__":
    sys.exit(main("The illustration of CAA.", [ENTRY], trials=1))
