"""Ablation: the loss on a part of the corpus without each stage and each bound of the engine, one after the other.

Run as ``python -m analysis.golden.ablation [--seconds 4] [--cases 16] [--only NAME ...] [--workers K] [--twice]
[--folder build/ablation]``. From networks, complete graphs and best plans that many cases each are taken that took
long, evenly over their names; each is asked with everything, and without each part, for that many seconds of the
processor. Printed in Markdown: rows closed with everything and without, lost and gained, geometric means of gaps and
seconds, without over with. Rows are appended as they end, a file for each ``--seconds``: run it again to go on.
``--twice`` measures a second time.
"""

import argparse
import sys
from dataclasses import replace
from pathlib import Path
from typing import Any

from analysis.golden.comparison import Rows
from analysis.golden.workers import in_workers

LONG = 0.2
"""Recorded seconds from which a case shows what a part is worth."""
EVERYTHING = "everything"
HEAD = (
    "| without | part | closed with, without it | lost, gained | gaps without over with | seconds |",
    "| --- | --- | --- | --- | --- | --- |",
)


def measured_without(name: str, part: str, case: str, turn: int, seconds: float) -> dict[str, Any]:
    """A row of the corpus without one part of the engine; loads the package, in a worker."""
    from analysis.golden.corpus import get_case
    from analysis.golden.measure import measured, warm
    from analysis.golden.switches import without

    warm()
    with without(name):
        row = measured(replace(get_case(part, case), seconds=seconds, nodes=None))
    return {"without": name, "turn": turn} | row


def chosen(parts: list[str], count: int, rows: Rows) -> list[tuple[str, str]]:
    """Choose ``count`` cases of each part, evenly over those that took long."""
    keys: list[tuple[str, str]] = []
    for part in parts:
        long = [key for key, row in rows.items() if key[0] == part and float(row["cpu_s"]) >= LONG]
        keys += [long[k * len(long) // count] for k in range(min(count, len(long)))]
    return list(dict.fromkeys(keys))


def main() -> int:
    """Measure, and print the table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--seconds", type=float, default=4.0, help="limit of one run")
    parser.add_argument("--cases", type=int, default=16, help="of each part of the corpus")
    parser.add_argument("--only", nargs="+", default=None, help="names of what is left out")
    parser.add_argument("--workers", type=int, default=None, help="processes; one for each core by default")
    parser.add_argument("--twice", action="store_true", help="a second time, if rows differ by chance")
    parser.add_argument("--folder", type=Path, default=Path("build/ablation"))
    options = parser.parse_args()
    from analysis.golden.comparison import apart, compared, read_rows
    from analysis.golden.switches import ATTACK_SWITCHES, PLAN_SWITCHES
    from analysis.tables import append_csv, read_csv

    recorded = read_rows(Path("tests/golden"), ["networks", "complete", "plans"])
    attacks = chosen(["networks", "complete"], options.cases, recorded)
    plans = chosen(["plans"], options.cases, recorded)
    names = [*ATTACK_SWITCHES, *PLAN_SWITCHES]
    if unknown := set(options.only or []) - set(names):
        parser.error(f"--only must be of {', '.join(names)}; got {', '.join(sorted(unknown))}")
    wanted = [EVERYTHING, *(options.only or names)]
    path = options.folder / f"ablation_{options.seconds:g}.csv"
    there = {
        (row["without"], row["part"], row["case"], int(row["turn"]))
        for row in (read_csv(path) if path.exists() else [])
    }
    turns = range(2 if options.twice else 1)
    asked = [
        (name, *key, turn)
        for turn in turns
        for name in wanted
        for key in (plans if name in PLAN_SWITCHES else attacks if name != EVERYTHING else attacks + plans)
    ]
    missing = [(*one, options.seconds) for one in asked if one not in there]
    for row in in_workers(measured_without, missing, options.workers):
        append_csv(path, row)
    rows = read_csv(path)
    by_name = {name: {_key(row): row for row in rows if row["without"] == name} for name in wanted}
    print(*HEAD, sep="\n")
    for name in wanted[1:]:
        for line in compared(by_name[EVERYTHING], by_name[name]):
            print(_line(name, line))
    false = [key for name in wanted[1:] for key in apart(by_name[EVERYTHING], by_name[name])]
    if false:
        print("\nBrackets that have no value in common:", *false, sep="\n")
    return 1 if false else 0


def _key(row: dict[str, str]) -> tuple[str, str]:
    return row["part"], f"{row['case']}, {row['turn']}"


def _line(name: str, line: dict[str, Any]) -> str:
    ratios = [f"{line[kind]:.2f}" if line[kind] != "" else "" for kind in ("gap_ratio", "seconds_ratio")]
    closed, moved = f"{line['closed_then']}, {line['closed_now']}", f"{line['lost']}, {line['gained']}"
    return "| " + " | ".join([name, line["part"], closed, moved, *ratios]) + " |"


if __name__ == "__main__":
    sys.exit(main())
