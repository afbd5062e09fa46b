"""The claim of the README alone: ``python -m analysis.limited_views.claim [--quick] --out DIR``.

Missions of the demo's kind of team: six cameras that turn and see 60 degrees and 40 m, six targets, links within 45 m,
two robots blinded and four links cut by exact attacks in each step. Plans of ten search nodes are compared with greedy
ones. The whole run has 60 missions (two minutes of the processor); ``--quick`` has the first twenty.
"""

import argparse
import sys
from collections.abc import Mapping, Sequence
from pathlib import Path

from analysis.limited_views.flights import case_of, measured
from analysis.limited_views.verdicts import outcome, relative_change
from ratt_opt.studies.engine import run
from ratt_opt.studies.statistics import column
from ratt_opt.studies.study import Study

__all__ = ["STUDY", "TRIALS", "said"]

TRIALS = {False: 60, True: 20}
"""Missions of the whole and of the quick run."""
STUDY = Study(
    name="limited_views_claim",
    cases=(case_of(n_targets=6, reach=40, links=45),),
    planners=("greedy", "maxmin"),
    attackers=("worst",),
    metrics=("rmse",),
    measure=measured,
)


def said(rows: Sequence[Mapping[str, str]]) -> str:
    """The change of the tracking error against greedy plans, with its interval and what that means."""
    change = relative_change(column(rows, "maxmin/worst/rmse"), column(rows, "greedy/worst/rmse"))
    return (
        f"RMSE of max-min plans against greedy ones: {change.show(100)} %, {change.n} missions: {outcome(change).value}"
    )


def main(arguments: Sequence[str] | None = None) -> int:
    """Fly the missions that are missing and print the change."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("--out", type=Path, required=True, help="folder of the results; run again to resume")
    parser.add_argument("--quick", action="store_true", help="twenty missions instead of 60")
    parser.add_argument("--workers", type=int, help="local processes (default: one per core)")
    options = parser.parse_args(arguments)
    wanted = TRIALS[options.quick]
    found = run(STUDY, options.out / STUDY.name, trials=wanted, workers=options.workers)
    print(said(found.rows[:wanted]))
    return 0


if __name__ == "__main__":
    sys.exit(main())
