"""Gain of exact max-min plans over RATT over whole missions, and loss of the best plan without attack.

``python -m analysis.missions.exact_flights --trials 100 --out DIR``
"""

from __future__ import annotations

import sys
from functools import partial

from analysis.missions.flights import MODELS, SIZES, cases, draw_study, measure
from ratt_opt.studies.command import Entry, main
from ratt_opt.studies.study import Study


def study_of(n_robots: int, n_targets: int) -> Study:
    """Missions of teams of one size under the worst attacks, if max-min plans are affordable."""
    return Study(
        name=f"exact_flights_{n_robots}",
        cases=cases([(n_robots, n_targets)], (MODELS[0], MODELS[2])),
        planners=("ratt", "maxmin", "nonrobust_optimum"),
        attackers=("worst",),
        metrics=("rmse", "trace", "nees"),
        measure=measure,
    )


STUDIES = tuple(study_of(n, m) for n, m in SIZES[:2])
ENTRIES = [Entry(study, partial(draw_study, study)) for study in STUDIES]

if __name__ == "__main__":
    sys.exit(main("Exact max-min plans over whole missions.", ENTRIES, trials=100))
