"""CSV files for spreadsheets: text that would be a formula there is kept text."""

from __future__ import annotations

import csv
import re
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence
    from pathlib import Path

__all__ = ["write_csv"]

QUANTITY = re.compile(r"[-+]\d[\w ./,-]*")
"""A signed number, as a control's label begins with ("-3 m/s, 2 rad/s"): it calls nothing."""
FORMULA = tuple("=+-@＝＋－＠\t\r\n")
"""First characters of formulas (OWASP, "CSV injection"), full-width signs too: names come from files of strangers."""


def write_csv(path: Path, columns: Sequence[str], rows: Iterable[Sequence[object]]) -> None:
    """Write a header and rows; text that begins like a formula gets an apostrophe before it."""
    with path.open("w", encoding="utf-8", newline="") as file:
        table = csv.writer(file, lineterminator="\n")
        table.writerow(columns)
        table.writerows([_cell(value) for value in row] for row in rows)


def _cell(value: object) -> object:
    is_formula = isinstance(value, str) and value.startswith(FORMULA) and not QUANTITY.fullmatch(value)
    return f"'{value}" if is_formula else value
