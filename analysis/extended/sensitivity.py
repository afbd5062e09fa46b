"""Sensitivity to what the paper leaves open: sensor noise, its law, the targets' prior and motion noise.

``python -m analysis.extended.sensitivity --trials 200 --out DIR``
"""

from __future__ import annotations

import sys
from typing import TYPE_CHECKING

from ratt_opt.studies.cases import Case, Cell
from ratt_opt.studies.command import Entry, main
from ratt_opt.studies.plots import bars, new_figure, save
from ratt_opt.studies.statistics import column, estimate, select
from ratt_opt.studies.study import Study

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence
    from pathlib import Path

DEFAULTS: dict[str, Cell] = {
    "prior_std": 3.0,
    "process_std": 0.5,
    "sensor.law": "variance",
    "sensor.range_noise": 0.5,
    "sensor.range_noise_slope": 0.2,
    "sensor.bearing_noise": 0.002,
    "sensor.bearing_noise_slope": 0.008,
}
RANGE = ("sensor.range_noise", "sensor.range_noise_slope")
BEARING = ("sensor.bearing_noise", "sensor.bearing_noise_slope")
REAL: dict[str, Cell] = {"sensor.law": "std", **dict(zip((*RANGE, *BEARING), (0.05, 0.042, 0.009, 0.0), strict=True))}
"""Noise of a real range-bearing sensor: standard deviation of the range grows with it, the bearing's is constant."""


def _scaled(names: Sequence[str], factor: float) -> dict[str, Cell]:
    return {name: factor * float(DEFAULTS[name]) for name in names}


VARIANTS: dict[str, dict[str, Cell]] = {
    "default": {},
    "prior std\n÷ 3": _scaled(["prior_std"], 1 / 3),
    "prior std\n× 3": _scaled(["prior_std"], 3),
    "motion std\n× 4": _scaled(["process_std"], 4),
    "range var.\n÷ 10": _scaled(RANGE, 0.1),
    "range var.\n× 10": _scaled(RANGE, 10),
    "bearing var.\n÷ 10": _scaled(BEARING, 0.1),
    "bearing var.\n× 10": _scaled(BEARING, 10),
    "real\nsensor": REAL,
}
CASES = {
    label: Case(n_robots=10, n_targets=15, alpha_s=5, alpha_c=15, options=tuple((DEFAULTS | change).items()))
    for label, change in VARIANTS.items()
}
STUDY = Study(
    name="sensitivity",
    cases=tuple(CASES.values()),
    planners=("ratt", "greedy", "random"),
    attackers=("worst", "bounded_rational"),
    metrics=("value", "trace"),
)


def draw(rows: Sequence[Mapping[str, str]], folder: Path) -> None:
    """One panel per attacker: how much larger the trace of Greedy and Random is than RATT's, per cent."""
    figure = new_figure(11, 6.4)
    for axes, attacker in zip(figure.subplots(2, 1, sharex=True), STUDY.attacker_names, strict=True):
        kept = [select(rows, case=case.name) for case in CASES.values()]
        own = [column(k, f"ratt/{attacker}/trace") for k in kept]
        series = {
            planner: [
                estimate(100 * (column(k, f"{planner}/{attacker}/trace") / base - 1))
                for k, base in zip(kept, own, strict=True)
            ]
            for planner in ("greedy", "random")
        }
        bars(axes, list(CASES), series)
        axes.set_title(f"{attacker.replace('_', '-')} attack")
        axes.set_ylabel("trace of covariance above RATT's [%]")
    handles, labels = figure.axes[0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside upper center", ncols=2, frameon=False)
    figure.supxlabel(
        f"N=10, M=15, $\\alpha_s$=5, $\\alpha_c$=15; mean of {len(kept[0])} paired trials with 95 % interval",
        fontsize="small",
    )
    save(figure, folder, STUDY.name)


ENTRY = Entry(STUDY, draw)

if __name__ == "__main__":
    sys.exit(main("Sensitivity to noise and prior.", [ENTRY], trials=200))
