"""Rows of a study: one CSV file and one printed table."""

import csv
from collections.abc import Mapping, Sequence
from pathlib import Path

from ratt_opt._rounding import named_text

__all__ = ["append_csv", "print_table", "read_csv", "write_csv"]


def read_csv(path: Path) -> list[dict[str, str]]:
    """The rows of a file, every cell as text."""
    with path.open(newline="", encoding="utf-8") as file:
        return list(csv.DictReader(file))


def write_csv(path: str | Path, rows: Sequence[Mapping[str, object]]) -> None:
    """Write the rows under the first one's keys, in full precision."""
    target = Path(path)
    target.parent.mkdir(parents=True, exist_ok=True)
    with target.open("w", newline="", encoding="utf-8") as file:
        writer = csv.DictWriter(file, fieldnames=list(rows[0]))
        writer.writeheader()
        writer.writerows(rows)


def append_csv(path: str | Path, row: Mapping[str, object]) -> None:
    """Add one row, with a first line of names if the file is new: what a long study has so far is never lost."""
    target = Path(path)
    target.parent.mkdir(parents=True, exist_ok=True)
    with target.open("a", newline="", encoding="utf-8") as file:
        writer = csv.DictWriter(file, fieldnames=list(row))
        if not file.tell():
            writer.writeheader()
        writer.writerow(row)


def print_table(title: str, rows: Sequence[Mapping[str, object]]) -> None:
    """Print the rows with aligned columns, numbers to four significant digits; ends of brackets and gaps outward."""
    print(f"\n{title}")
    names = list(rows[0])
    cells = [[_cell(n, row[n]) for n in names] for row in rows]
    widths = [max(len(name), *(len(line[k]) for line in cells)) for k, name in enumerate(names)]
    for line in [names, *cells]:
        print("  ".join(cell.rjust(width) for cell, width in zip(line, widths, strict=True)))


def _cell(name: str, value: object) -> str:
    return named_text(name, value, 4) if isinstance(value, float) else str(value)
