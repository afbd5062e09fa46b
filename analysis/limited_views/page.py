"""The tables of limited views, made from the rows of the studies: ``python -m analysis.limited_views.page DIR``.

``python -m analysis.limited_views --trials 60 --out DIR`` runs the studies and writes the same page to
``DIR/limited_views_tables.md``. Every number and every verdict on it comes from the rows.
"""

from __future__ import annotations

import sys
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from analysis.limited_views.flights import MAIN, PLANNERS, STEPS, STUDIES
from analysis.limited_views.one_step import STUDY as ONE_STEP
from analysis.limited_views.verdicts import Outcome, outcome, relative_change
from ratt_opt._files import write_atomically
from ratt_opt.errors import InputError
from ratt_opt.studies.statistics import Estimate, column, estimate, select
from ratt_opt.studies.store import read_table

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping, Sequence

    from ratt_opt.studies.study import Study

    Row = Mapping[str, str]

__all__ = ["page", "write_page"]

OPENING = """# Limited views: tables

[Is it worth it?](limited_views.md) says in one figure what these tables say in numbers.

Six robots with cameras that turn among eight headings, drive at 0 or 2 m/s and see only a part of the area; slow
targets in a square of 60 m; an adversary who blinds two robots and cuts four links (`limited_view_scenario`). Each
robot must choose what to look at, and a target that few robots watch is a target that the adversary can hide. Two
commands fly everything, 60 trials of the main cases, 20 of the varied ones, and write this page; killed, they resume:

<!-- slow -->
```bash
python -m analysis.limited_views --trials 20 --only limited_views_varied --out results
python -m analysis.limited_views --trials 60 --only limited_views_main limited_views_one_step --out results
python -m analysis.limited_views.page results > docs/researchers/limited_views_tables.md
```

Every trial draws another team, other targets and other noise, and all planners fly it: trials share nothing, and
differences are paired. A cell shows the change of a mean against that of the greedy planner [%] with its 95 % interval.
It *pays* if the interval is below zero and *costs* if it is above; if neither is said, no difference is seen.
One interval in twenty misses by chance. Missions have {steps} steps, and their two windows, the first and the last
half, share no step. Max-min plans are searched for ten nodes a step and refined ones take twenty kicks, so that every
machine flies the same missions. The
base case has a view of 60 degrees without a limit of range, the camera's noise, five targets, a complete network and
attacks that are renewed in every step; main cases are bold.
"""
NAMES = {"ratt": "RATT", "maxmin": "max-min", "refined": "refined", "greedy": "greedy", "myopic": "myopic"}
TABLES = (
    ("worst", "rmse", "Root mean squared error, exact attacks", "m"),
    ("worst", "rmse_first_half", "The same, first half of the steps", "m"),
    ("worst", "rmse_last_half", "The same, last half of the steps", "m"),
    ("worst", "largest", "Largest error of any target in any step, exact attacks", "m"),
    ("worst", "unseen", "Targets and steps without a measurement that reaches the team, exact attacks", "%"),
    ("worst", "longest", "Longest time that some target goes unseen, exact attacks", "steps"),
    ("random", "rmse", "Root mean squared error, random attacks", "m"),
    ("none", "rmse", "Root mean squared error, nobody attacks: what robust plans cost", "m"),
    ("none", "largest", "Largest error, nobody attacks", "m"),
)
"""Attacker, metric, title and unit of each table of missions."""


def page(folder: Path) -> str:
    """Return the page, of the studies whose results are in ``folder``."""
    flown = {study: rows for study in STUDIES if (rows := _rows(folder, study))}
    parts = [OPENING.format(steps=STEPS)]
    if steps := _rows(folder, ONE_STEP):
        parts += ["\n".join(_one_step(steps))]
    if flown:
        parts += ["\n".join(_table(flown, *table)) for table in TABLES]
    return "\n".join(parts)


def write_page(folder: Path) -> None:
    """Write ``limited_views_tables.md`` into the folder of the results, and print it."""
    text = page(folder)
    write_atomically(folder / "limited_views_tables.md", lambda file: file.write_text(text, encoding="utf-8"))
    print(text, end="")


def _rows(folder: Path, study: Study) -> list[dict[str, str]]:
    try:
        return read_table(folder / study.name)
    except InputError:
        return []


def _cases(rows: Sequence[Row]) -> Iterator[tuple[str, list[Row]]]:
    """Each case by what is particular to it, with its rows."""
    for name in dict.fromkeys(row["case"] for row in rows):
        kept = select(rows, case=name)
        yield _particular(kept[0]), kept


def _particular(row: Row) -> str:
    """Name the differences from the base case."""
    words = [f"view {row['view']} degrees"]
    words += [f"reach {row['reach']} m"] if row["reach"] != "unlimited" else []
    words += [f"noise {row['noise']}"] if row["noise"] != "camera" else []
    words += [f"{row['n_targets']} targets"] if row["n_targets"] != "5" else []
    words += [f"links within {row['links']} m"] if row["links"] != "complete" else []
    words += [f"{row['attacks']} attacks"] if row["attacks"] != "renewed" else []
    return ", ".join(words)


def _one_step(rows: Sequence[Row]) -> Iterator[str]:
    """Compare an exact plan's distance from the best possible with the other planners', in one step."""
    yield "## One step\n"
    yield "Worst-case value of each plan as a share of the best possible (trace, mean over the teams), and what an"
    yield "exact plan adds to that of RATT. Shares are of the proved upper end, so they are at least as stated. Open:"
    yield "teams whose search ended with more than 0.1 % undecided.\n"
    planners = [planner for planner in ONE_STEP.planner_names if f"{planner}/worst/value" in rows[0]]
    head = " | ".join(NAMES.get(planner, planner) for planner in planners)
    yield f"| case | teams | {head} | exact plan over RATT | teams where it adds 10 % | open |"
    yield f"| --- | --- |{' --- |' * len(planners)} --- | --- | --- |"
    for name, kept in _cases(rows):
        upper, lower = column(kept, "optimum/upper"), column(kept, "optimum/lower")
        shares = [estimate(column(kept, f"{planner}/worst/value") / upper).mean for planner in planners]
        ratt = column(kept, "ratt/worst/value")
        exact = np.maximum(ratt, lower)
        gain, often = relative_change(exact, ratt), float(np.mean(exact >= 1.1 * ratt))
        undecided = int(np.sum(upper - lower > 1.001e-3 * upper))
        told = " | ".join(f"{share:.3f}" for share in shares)
        yield f"| {name} | {len(kept)} | {told} | {gain.show(100)} % | {often:.0%} | {undecided} |"
    yield ""


def _compared(rows: Sequence[Row]) -> list[str]:
    """The planners that the rows have, without the one they are compared with."""
    return [planner for planner in PLANNERS[1:] if f"{planner}/worst/rmse" in rows[0]]


def _change(rows: Sequence[Row], planner: str, attacker: str, metric: str) -> Estimate:
    ours, theirs = (column(rows, f"{name}/{attacker}/{metric}") for name in (planner, PLANNERS[0]))
    return relative_change(ours, theirs) if theirs.any() else estimate(ours - theirs)


def _table(flown: Mapping[Study, Sequence[Row]], attacker: str, metric: str, title: str, unit: str) -> Iterator[str]:
    yield f"## {title}\n"
    compared = _compared(next(iter(flown.values())))
    head = [f"{NAMES.get(planner, planner)} [%]" for planner in compared]
    yield f"| case | seeds | greedy [{unit}] | {' | '.join(head)} |"
    yield f"| --- | --- | --- |{' --- |' * len(head)}"
    for study, rows in flown.items():
        for name, kept in _cases(rows):
            base = estimate(column(kept, f"{PLANNERS[0]}/{attacker}/{metric}")).mean
            changes = [_change(kept, planner, attacker, metric) for planner in compared]
            cells = [change.show(100) + _word(change) for change in changes]
            shown = f"**{name}**" if study is MAIN else name
            yield f"| {shown} | {len(kept)} | {base:.3g} | {' | '.join(cells)} |"
    yield ""


def _word(change: Estimate) -> str:
    found = outcome(change)
    return "" if found is Outcome.UNSEEN else f" {found.value}"


def _main(arguments: Iterable[str]) -> int:
    for folder in arguments:
        print(page(Path(folder)), end="")
    return 0


if __name__ == "__main__":
    sys.exit(_main(sys.argv[1:]))
