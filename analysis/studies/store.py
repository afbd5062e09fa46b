"""Results on disk: a journal that only grows, and the sorted table made from it.

``study.json`` says which study the folder holds, ``journal.csv`` has one line per finished trial in
the order they finished, ``table.csv`` those of whole trials sorted by case and trial. The journal is
append-only and each line is forced to disk; a line torn by a kill is cut off and its trial run again.
"""

from __future__ import annotations

import csv
import io
import json
import os
from collections import Counter
from contextlib import contextmanager
from typing import TYPE_CHECKING, TextIO

from analysis.studies.versions import VERSIONS
from ratt_opt._files import output_directory, write_atomically, write_json
from ratt_opt.errors import InputError

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping
    from pathlib import Path

    from analysis.studies.study import Cell, Study

__all__ = ["Journal", "open_journal", "read_table"]

FORMAT = 1
MANIFEST, JOURNAL, TABLE = "study.json", "journal.csv", "table.csv"


class Journal:
    """The finished trials of one study; made by :func:`open_journal`."""

    def __init__(self, study: Study, folder: Path, stream: TextIO, rows: list[dict[str, str]]) -> None:
        self._study, self._folder, self._stream = study, folder, stream
        self._rows = rows
        self._columns = tuple(rows[0]) if rows else ()

    @property
    def done(self) -> set[tuple[str, int]]:
        """Case name and trial number of every finished trial."""
        return {(row["case"], int(row["trial"])) for row in self._rows}

    def append(self, row: Mapping[str, Cell]) -> None:
        """Write one finished trial and force it to disk."""
        # NumPy's floats are floats too, but their repr is not a number.
        cells = {name: repr(float(value)) if isinstance(value, float) else str(value) for name, value in row.items()}
        assert not any("\n" in cell or "\r" in cell for cell in cells.values())
        if not self._columns:
            self._columns = tuple(cells)
            self._stream.write(_line(self._columns))
        assert tuple(cells) == self._columns, "every trial of a study has the same columns"
        self._stream.write(_line(cells.values()))
        self._stream.flush()
        os.fsync(self._stream.fileno())
        self._rows.append(cells)

    def write_table(self) -> Path:
        """Write the rows sorted by case and trial; the same rows give the same bytes.

        Trials that a killed run left in some cases only, beyond those asked for now, stay in the journal: in the
        table every case has the same trials, so that they can be compared.
        """
        order = {case.name: k for k, case in enumerate(self._study.cases)}
        cases = Counter(row["trial"] for row in self._rows)
        whole = [row for row in self._rows if cases[row["trial"]] == len(order)]
        rows = sorted(whole, key=lambda row: (order[row["case"]], int(row["trial"])))
        text = _line(self._columns) + "".join(_line(row.values()) for row in rows)
        return write_atomically(self._folder / TABLE, lambda file: file.write_bytes(text.encode()))


@contextmanager
def open_journal(study: Study, folder: Path) -> Iterator[Journal]:
    """Open the results of ``study`` in ``folder`` for appending; nobody else may append meanwhile.

    Raises
    ------
    InputError : the folder holds something else, another version, damaged rows, or is in use.
    """
    output_directory(folder)
    _claim(study, folder)
    path = folder / JOURNAL
    with path.open("a+", encoding="utf-8", newline="") as stream:
        _lock(stream, folder)
        _cut_torn_line(path)
        yield Journal(study, folder, stream, _read(path, study))


def read_table(folder: Path) -> list[dict[str, str]]:
    """Return the rows of a finished study, sorted by case and trial.

    Raises
    ------
    InputError : there is no finished table.
    """
    try:
        text = (folder / TABLE).read_text(encoding="utf-8")
    except OSError as error:
        raise InputError("results", "must hold a finished table", f"{folder / TABLE} ({error.strerror})") from None
    return list(csv.DictReader(io.StringIO(text)))


def _line(cells: object) -> str:
    stream = io.StringIO()
    csv.writer(stream, lineterminator="\n").writerow(cells)  # type: ignore[arg-type]
    return stream.getvalue()


def _claim(study: Study, folder: Path) -> None:
    """Write the manifest into a new folder, or refuse a folder that is not this study's."""
    manifest = {
        "format": FORMAT,
        "study": study.name,
        "version": study.version,
        "fingerprint": study.fingerprint(),
        "made_with": VERSIONS,
        "definition": study.definition(),
    }
    path = folder / MANIFEST
    if not path.exists():
        # A killed run may have left a hidden temporary file, nothing else.
        if any(not file.name.startswith(".") for file in folder.iterdir()):
            raise InputError("out", f"must be an empty folder or hold the {MANIFEST} of this study", folder)
        write_json(path, manifest)
        return
    try:
        found = json.loads(path.read_text(encoding="utf-8"))
        shown = f"study {found['study']!r} version {found['version']}"
        same_study = (found["study"], found["version"]) == (study.name, study.version)
        checks = [
            (found["format"] == FORMAT, f"results of format {FORMAT}", f"format {found['format']}"),
            (same_study, f"results of study {study.name!r} version {study.version}", shown),
            (
                found["fingerprint"] == study.fingerprint(),
                "results of this definition and seed",
                f"{shown} with another definition or seed",
            ),
            (found["made_with"] == VERSIONS, f"results made with {VERSIONS}", found["made_with"]),
        ]
    except (OSError, ValueError, KeyError, TypeError) as error:
        raise InputError("out", f"must hold a readable {MANIFEST}", f"{path} ({type(error).__name__})") from None
    for holds, wanted, got in checks:
        if not holds:
            raise InputError("out", f"must be a new folder or hold {wanted}", f"{got} in {folder}")


def _lock(stream: TextIO, folder: Path) -> None:
    try:
        import fcntl
    except ImportError:  # not a POSIX system: two runs at once are then the user's care
        return
    try:
        fcntl.flock(stream, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except OSError:
        raise InputError("out", "must not be in use by another run", folder) from None


def _cut_torn_line(path: Path) -> None:
    """Drop what a killed run left of its last line; a whole line ends with a newline."""
    data = path.read_bytes()
    whole = data.rfind(b"\n") + 1
    if whole < len(data):
        os.truncate(path, whole)


def _read(path: Path, study: Study) -> list[dict[str, str]]:
    lines = list(csv.reader(io.StringIO(path.read_text(encoding="utf-8"), newline="")))
    if not lines:
        return []
    header, names = lines[0], {case.name for case in study.cases}
    rows = []
    seen: set[tuple[str, str]] = set()
    for number, cells in enumerate(lines[1:], start=2):
        row = dict(zip(header, cells, strict=False))
        key = (row.get("case", ""), row.get("trial", ""))
        if len(cells) != len(header) or key[0] not in names or not key[1].isdecimal() or key in seen:
            raise InputError(f"{path} line {number}", "must be one whole row, given once", ",".join(cells))
        seen.add(key)
        rows.append(row)
    return rows
