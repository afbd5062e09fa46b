"""The tables of ``docs/researchers/benchmarks.md`` that logs of ``analysis.benchmarks.networks`` fill.

Run as ``python -m analysis.benchmarks.network_tables LOG ... [--within 0.02]``: for each number of robots a Markdown
table, families by seeds, three budgets each, and what is closed, what is within the target and what is not. A later row
of the same instance takes the place of an earlier one.
"""

from __future__ import annotations

import argparse
from collections import defaultdict
from pathlib import Path
from typing import TYPE_CHECKING

from analysis.tables import read_csv
from ratt_opt._rounding import relative_gap, up

if TYPE_CHECKING:
    from collections.abc import Iterable

__all__ = ["network_table", "read_rows", "summary"]

Row = dict[str, str]
DONE = {"closed", "exhausted", "gap"}
"""Stops of searches that proved all that they should."""


def read_rows(logs: Iterable[Path]) -> dict[int, list[Row]]:
    """The rows of the logs by their number of robots, the last one of every instance, in the order of the first."""
    rows: dict[int, dict[tuple[str, ...], Row]] = defaultdict(dict)
    for log in logs:
        for row in read_csv(log):
            instance = (row["family"], row["seed"], row["alpha_s"], row["alpha_c"])
            rows[int(row["robots"])][instance] = row
    return {robots: list(of_team.values()) for robots, of_team in sorted(rows.items())}


def network_table(rows: list[Row]) -> str:
    """Families by seeds: seconds of the processor if all was proved, else what is left."""
    cells: dict[str, dict[int, list[str]]] = defaultdict(lambda: defaultdict(list))
    for row in rows:
        cells[row["family"]][int(row["seed"])].append(_cell(row))
    seeds = sorted({seed for by_seed in cells.values() for seed in by_seed})
    lines = ["| graph | " + " | ".join(f"seed {seed}" for seed in seeds) + " |", "| --- " * (len(seeds) + 1) + "|"]
    for family, by_seed in cells.items():
        entries = [", ".join(by_seed[seed]) if seed in by_seed else "not run" for seed in seeds]
        lines.append(f"| {family} | " + " | ".join(entries) + " |")
    return "\n".join(lines)


def summary(rows: list[Row], within: float) -> str:
    """Count the rows that are closed and within the target; list the others, and plain annealing if it was run."""
    open_rows = [row for row in rows if row["stop"] not in DONE]
    over = [row for row in open_rows if float(row["gap"]) > within]
    text = f"{len(rows) - len(open_rows)} of {len(rows)} closed, {len(rows) - len(over)} within {100 * within:g} %"
    if over:
        text += "; beyond: " + "; ".join(
            f"{row['family']} ({row['alpha_s']}, {row['alpha_c']}) seed {row['seed']} {_cell(row)}" for row in over
        )
    compared = [float(row["plain_over_exact"]) for row in rows if row.get("plain_over_exact")]
    if compared:
        worse = sum(ratio < 1 - 1e-9 for ratio in compared)
        text += f". Plain annealing found a worse attack on {worse} of {len(compared)}"
        text += f", a milder one by up to {100 * (max(compared) - 1):.1f} %"
    earlier = [row for row in rows if row.get("earlier_stop")]
    if earlier:
        closed = sum(row["earlier_stop"] in DONE for row in earlier)
        ends = [(float(row["earlier_lower"]), float(row["earlier_upper"])) for row in earlier]
        gaps = [relative_gap(lower, upper) if lower > 0 else 1.0 for lower, upper in ends]
        text += f". The earlier edition closed {closed} of {len(earlier)}, {sum(gap <= within for gap in gaps)} within"
        text += f" {100 * within:g} %, and left up to {up(100 * max(gaps), 3)} %"
    return text + "."


def _cell(row: Row) -> str:
    if row["stop"] not in DONE:
        return f"{up(100 * float(row['gap']), 2)} %"
    seconds = float(row["processor_seconds"])
    return f"{seconds:.0f} s" if seconds >= 9.95 else f"{seconds:.1f} s"


def main() -> None:
    """Print the tables."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("logs", type=Path, nargs="+")
    parser.add_argument("--within", type=float, default=0.02, help="share that a bracket may leave open")
    options = parser.parse_args()
    for robots, rows in read_rows(options.logs).items():
        print(f"\n{robots} robots\n\n{network_table(rows)}\n\n{summary(rows, options.within)}")


if __name__ == "__main__":
    main()
