"""The pages of limited views, made from the rows of the studies: ``python -m analysis.limited_views.page DIR OUT``.

``python -m analysis.limited_views --trials 60 --out DIR`` runs the studies and writes the same into ``DIR``: a figure
with three sentences, and tables. Every number and every verdict comes from the rows.
"""

from __future__ import annotations

import sys
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from analysis.limited_views import bite
from analysis.limited_views.flights import MAIN, PLANNERS, STEPS, STUDIES, VARIED, case_of
from analysis.limited_views.one_step import STUDY as ONE_STEP
from analysis.limited_views.verdicts import Outcome, outcome, relative_change
from analysis.limited_views.worth import figure_of, worth_page
from ratt_opt._files import write_atomically
from ratt_opt.errors import InputError
from ratt_opt.studies.statistics import Estimate, column, estimate, select
from ratt_opt.studies.store import read_table

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence

    from ratt_opt.studies.study import Study

    Row = Mapping[str, str]

__all__ = ["page", "write_page"]

OPENING = """# Limited views: tables

[Is it worth it?](limited_views.md) says in one figure what these tables say in numbers.

Six robots with cameras that turn among eight headings, drive at 0 or 2 m/s and see only a part of the area; slow
targets in a square of 60 m; an adversary who blinds two robots and cuts four links (`limited_view_scenario`). Each
robot must choose what to look at, and a target that few robots watch is a target that the adversary can hide. Two
commands fly everything, {main} missions of the main cell, {varied} of each varied one; killed, they resume. The third
writes the pages:

<!-- slow -->
```bash
python -m analysis.limited_views --trials {varied} --only limited_views_varied --out results
studies="limited_views_bite limited_views_one_step limited_views_main"
python -m analysis.limited_views --trials 60 --only $studies --out results
python -m analysis.limited_views.page results docs/researchers
```

Every trial draws another team, other targets and other noise, and all planners fly it: trials share nothing, and
differences are paired. A cell shows the change of a mean against that of the greedy planner [%] with its 95 % interval.
It *pays* if the interval is below zero and *costs* if it is above; if neither is said, no difference is seen.
One interval in twenty misses by chance. Missions have {steps} steps, and their two windows, the first and the last
half, share no step. Max-min plans are searched for ten nodes a step and refined ones take twenty kicks, so that every
machine flies the same missions. The main cell (bold) is the demo's kind of team: a view of 60 degrees, a reach of 40 m,
the camera's noise, six targets, links within 45 m, attacks that are renewed in every step. The others differ from it as
said. The rows were made with {made}.
"""
ROOT = Path(__file__).parents[2]
NAMES = {"ratt": "RATT", "maxmin": "max-min", "refined": "refined", "greedy": "greedy", "myopic": "myopic"}
TABLES = (
    ("worst", "rmse", "Root mean squared error, exact attacks", "m"),
    ("worst", "rmse_first_half", "The same, first half of the steps", "m"),
    ("worst", "rmse_last_half", "The same, last half of the steps", "m"),
    ("worst", "largest", "Largest error of any target in any step, exact attacks", "m"),
    ("worst", "unseen", "Targets and steps without a measurement that reaches the team, exact attacks", "%"),
    ("worst", "longest", "Longest time that some target goes unseen, exact attacks", "steps"),
    ("none", "rmse", "Root mean squared error, nobody attacks: what robust plans cost", "m"),
    ("none", "largest", "Largest error, nobody attacks", "m"),
)
"""Attacker, metric, title and unit of each table of missions."""


def page(folder: Path) -> str:
    """Return the page of tables, of the studies whose results are in ``folder``."""
    flown = {study: rows for study in STUDIES if (rows := _rows(folder, study))}
    trials = {study: len({row["trial"] for row in rows}) for study, rows in flown.items()}
    made = sorted({row["versions"] for rows in flown.values() for row in rows})
    told = {"steps": STEPS, "made": "; ".join(made) or "nothing yet"}
    parts = [OPENING.format(main=trials.get(MAIN, 0), varied=trials.get(VARIED, 0), **told)]
    if rows := _rows(folder, bite.STUDY):
        parts += ["\n".join(_bites(rows))]
    if rows := _rows(folder, ONE_STEP):
        parts += ["\n".join(_one_step(rows))]
    if flown:
        parts += ["\n".join(_table(flown, *table)) for table in TABLES]
    return "\n".join(parts)


def write_page(folder: Path, out: Path | None = None) -> None:
    """Write both pages and the figure beside the results, or into ``out``."""
    rows = [row for study in STUDIES for row in _rows(folder, study)]
    texts = {"limited_views.md": worth_page(rows), "limited_views_tables.md": page(folder)}
    figure, place = figure_of(rows), out or folder
    for name, text in texts.items():
        write_atomically(place / name, lambda file, text=text: file.write_text(text, encoding="utf-8"))  # type: ignore[misc]
    write_atomically(place / "limited_views.png", lambda file: figure.savefig(file, dpi=120))


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
    """Name the differences from the main cell."""
    main = {**dict(case_of().options), "n_targets": case_of().n_targets}
    words = {
        "view": "view {} degrees",
        "reach": "reach {} m",
        "noise": "noise {}",
        "n_targets": "{} targets",
        "links": "links within {} m",
        "attacks": "{} attacks",
    }
    told = [text.format(row[name]) for name, text in words.items() if row[name] != str(main[name])]
    plain = {"reach unlimited m": "unlimited reach", "links within complete m": "complete network"}
    return ", ".join(plain.get(one, one) for one in told) or "main cell"


def _bites(rows: Sequence[Row]) -> Iterator[str]:
    """Show the rule that chooses the main cell, and what it rests on."""
    yield "## Main cell\n"
    yield "The rule: an attack *bites* if it costs RATT's plan a tenth of its unattacked value or more, on average over"
    yield "the first steps of the missions. The main cell has the longest links at which blinding two robots bites and"
    yield "cutting four links does, each alone, and of these the widest reach. Shares kept [%], with 95 % intervals:\n"
    yield "| links | reach | teams | two robots blinded | four links cut | both |"
    yield "| --- | --- | --- | --- | --- | --- |"
    chosen = bite.chosen(rows)
    for case in bite.STUDY.cases:
        kept = bite.shares(rows, case)
        options = dict(case.options)
        links, reach = (
            str(options[name]) if isinstance(options[name], str) else f"{options[name]} m"
            for name in ("links", "reach")
        )
        shown = " | ".join(f"{kept[name].mean:.1f} [{kept[name].low:.1f}, {kept[name].high:.1f}]" for name in kept)
        mark = "**" if case == chosen else ""
        yield f"| {mark}{links}{mark} | {mark}{reach}{mark} | {kept['both'].n} | {shown} |"
    yield ""


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
        if attacker not in study.attacker_names:
            continue
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


def _main(arguments: Sequence[str]) -> int:
    folder, *out = map(Path, arguments)
    write_page(folder, *out)
    return 0


if __name__ == "__main__":
    sys.exit(_main(sys.argv[1:]))
