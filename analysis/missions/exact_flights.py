"""What exact max-min plans add to RATT over whole missions.

``python -m analysis.missions.exact_flights --trials 100 --out DIR``
"""

from __future__ import annotations

import sys
from typing import TYPE_CHECKING

from analysis.missions.flights import MODELS, SIZES, cases, draw_study, measure
from analysis.studies.command import Entry, main
from analysis.studies.study import Study

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence
    from pathlib import Path

STUDY = Study(
    name="exact_flights",
    cases=cases(SIZES[:2], (MODELS[0], MODELS[2])),
    planners=("ratt", "maxmin"),
    attackers=("worst",),
    metrics=("rmse", "trace", "nees"),
    measure=measure,
)


def draw(rows: Sequence[Mapping[str, str]], folder: Path) -> None:
    """The figure of both planners."""
    draw_study(STUDY, rows, folder)


ENTRY = Entry(STUDY, draw)

if __name__ == "__main__":
    sys.exit(main("Exact max-min plans over whole missions.", [ENTRY], trials=100))
