"""The golden corpus: what the searches answered before a change, and what they answer now.

Run as ``python -m analysis.golden record|compare [--parts networks complete plans certificates unusual] [--sample S]
[--workers K] [--folder DIR] [--history FILE]``. ``record`` measures the cases that the folder's files have not
(``tests/golden`` by default), on all cores, row by row: run it again to go on. ``compare`` measures into its folder
(``build/golden``) in the same way, and prints what both have: rows closed then and now, geometric means of gaps,
processor seconds, proof sizes and verification now over then, and how many runs that are limited by nodes gave the
same. It ends with 1 if two brackets have no value in common, and with ``--strict`` if a row was lost or a limited run
differs. Seconds, and limits, are of the processor. ``--sample S``: cases whose record took S seconds in all.
``--history FILE`` adds the table to a file, with the commit.
"""

import argparse
import subprocess
import sys
from pathlib import Path

from analysis.golden.workers import in_workers

RECORDED, COMPARED = Path("tests/golden"), Path("build/golden")


def main() -> int:
    """Record or compare, and return the exit code."""
    # Not above: limits of the workers, which import this module, must count processor seconds from the start.
    from analysis.golden.comparison import apart, compared, differing, lost, read_rows
    from analysis.golden.corpus import PARTS, cases
    from analysis.golden.measure import measured_by_name
    from analysis.golden.sample import sample
    from analysis.tables import append_csv, print_table

    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("what", choices=["record", "compare"])
    parser.add_argument("--parts", nargs="+", default=list(PARTS), choices=PARTS)
    parser.add_argument("--sample", type=float, default=None, help="seconds that the record of the chosen cases took")
    parser.add_argument("--workers", type=int, default=None, help="processes; one for each core by default")
    parser.add_argument("--folder", type=Path, default=None, help="of the files that are written")
    parser.add_argument("--history", type=Path, default=None, help="CSV that the table is added to, with the commit")
    parser.add_argument("--strict", action="store_true", help="fail if a row is lost or a limited run differs")
    options = parser.parse_args()
    folder = options.folder or (RECORDED if options.what == "record" else COMPARED)
    recorded = read_rows(RECORDED, PARTS)
    names = [(case.part, case.name) for case in cases(options.parts)]
    if options.sample is not None:
        names = sample(names, recorded, options.sample)
        if not names:
            parser.error(f"--sample must be the seconds of at least one case, some more; got {options.sample:g}")
    there = read_rows(folder, PARTS)
    for row in in_workers(measured_by_name, [key for key in names if key not in there], options.workers):
        append_csv(folder / f"{row['part']}.csv", row)
    if options.what == "record":
        return 0
    now = {key: row for key, row in read_rows(folder, PARTS).items() if key in set(names)}
    lines = compared(recorded, now)
    print_table("Now over then, geometric means", lines)
    if options.history is not None:
        for line in lines:
            append_csv(options.history, _measured_at() | line)
    listed = {"Brackets that have no value in common": apart(recorded, now)}
    listed |= {"Closed then and open now": lost(recorded, now), "Limited runs that differ": differing(recorded, now)}
    for title, keys in listed.items():
        if keys:
            print(f"\n{title}:", *(f"  {part}: {name}" for part, name in keys), sep="\n")
    false, *changed = listed.values()
    return 1 if false or (options.strict and any(changed)) else 0


def _measured_at() -> dict[str, str]:
    """The commit that is measured, and the day of that commit."""
    command = ["git", "log", "-1", "--format=%h %cs"]
    commit, day = subprocess.run(command, capture_output=True, text=True, check=True).stdout.split()
    return {"commit": commit, "day": day}


if __name__ == "__main__":
    sys.exit(main())
