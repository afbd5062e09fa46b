"""Comparisons without a figure of their own: guarantees, objectives, graphs, and what the paper leaves open.

``python -m analysis.extended --only guarantees objectives graphs sensitivity --trials 200 --out DIR``
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from analysis.paper.large_scale import budgets
from ratt_opt.studies.cases import Case, Cell
from ratt_opt.studies.statistics import column
from ratt_opt.studies.study import Study

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from ratt_opt._validation import FloatArray

__all__ = ["DEFAULTS", "GRAPHS", "GUARANTEES", "OBJECTIVES", "SENSITIVITY", "STUDIES", "VARIANTS", "shares"]

GUARANTEES = Study(
    name="guarantees",
    cases=tuple(
        Case(n_robots=4, n_targets=4, alpha_s=s, alpha_c=c, objective=objective)
        for objective in ("logdet", "trace")
        for s, c in ((1, 3), (1, 4), (2, 3), (2, 4))
    ),
    planners=("ratt",),
    attackers=("worst",),
    metrics=("value", "proved"),
    quantities=("optimum", "guarantees"),
)
"""A-priori guarantee, exact worst-case ratio and certified ratio of the instance, side by side."""


def shares(rows: Sequence[Mapping[str, str]]) -> dict[str, FloatArray]:
    """(T,) each kind of guarantee: RATT's least share of the optimum under any attack."""
    certified = column(rows, "ratt/worst/proved") / column(rows, "optimum/upper")
    known = {name: column(rows, name) for name in ("theorem1", "pattern_free", "ratio")}
    return {**known, "certified": certified}


GRAPHS = Study(
    name="graphs",
    cases=tuple(
        Case(n_robots=8, n_targets=10, alpha_s=s, alpha_c=c, graph=graph)
        for s, c in ((1, 2), (2, 4))
        for graph in ("complete", "ladder", "grid", "ring", "star", "line")
    ),
    planners=("ratt", "greedy", "myopic"),
    attackers=("worst",),
    metrics=("value", "proved"),
    quantities=("optimum",),
)
"""Graphs that are not complete: RATT with the exact smallest largest group instead of CAA."""

OBJECTIVES = Study(
    name="objectives",
    cases=tuple(
        Case(n_robots=10, n_targets=15, alpha_s=s, alpha_c=c, objective=objective)
        for objective in ("trace", "logdet", "maxeig")
        for s, c in budgets(10)[::2]
    ),
    planners=("ratt", "greedy", "random"),
    attackers=("worst",),
    metrics=("value", "proved"),
    quantities=("optimum",),
)

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
    "prior std ÷ 3": _scaled(["prior_std"], 1 / 3),
    "prior std × 3": _scaled(["prior_std"], 3),
    "motion std × 4": _scaled(["process_std"], 4),
    "range variance ÷ 10": _scaled(RANGE, 0.1),
    "range variance × 10": _scaled(RANGE, 10),
    "bearing variance ÷ 10": _scaled(BEARING, 0.1),
    "bearing variance × 10": _scaled(BEARING, 10),
    "real sensor": REAL,
}
SENSITIVITY = Study(
    name="sensitivity",
    cases=tuple(
        Case(n_robots=10, n_targets=15, alpha_s=5, alpha_c=15, options=tuple((DEFAULTS | change).items()))
        for change in VARIANTS.values()
    ),
    planners=("ratt", "greedy", "random"),
    attackers=("worst", "bounded_rational"),
    metrics=("value", "trace"),
)
"""Sensor noise, its law, the targets' prior and motion noise, which the paper does not give."""

STUDIES = (GUARANTEES, OBJECTIVES, GRAPHS, SENSITIVITY)
