"""Results on disk: a journal that only grows, and the sorted table made from it.

``study.json`` says which study the folder holds, ``journal.csv`` has one line per finished trial in
the order they finished, ``table.csv`` those of whole trials sorted by case and trial. The journal is
append-only and each line is forced to disk; a line torn by a kill is cut off and its trial run again.
Every line of the journal ends with a checksum of its cells. The manifest names the code that made the rows: rows of
other code are refused, or kept on demand; each row's own versions then say which code made it.
"""

from __future__ import annotations

import csv
import io
import json
import os
import zlib
from collections import Counter
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any, TextIO

from ratt_opt._files import output_directory, output_file, write_atomically, write_json
from ratt_opt.errors import InputError
from ratt_opt.studies.versions import VERSIONS
from ratt_opt.vocabulary import current_column

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping
    from pathlib import Path

    from ratt_opt.studies.cases import Cell
    from ratt_opt.studies.study import Study

__all__ = ["TrialJournal", "open_journal", "read_table"]

FORMAT = 2
CHECKSUM = "checksum"
"""Last column of the journal, with the header's own after its name; the table does not have it."""
MANIFEST, JOURNAL, TABLE = "study.json", "journal.csv", "table.csv"


class TrialJournal:
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
            self._stream.write(_line((*self._columns, _last_of_header(self._columns))))
        assert tuple(cells) == self._columns, "every trial of a study has the same columns"
        self._stream.write(_line((*cells.values(), _checksum(cells.values()))))
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
def open_journal(study: Study, folder: Path, *, accept_old_rows: bool = False) -> Iterator[TrialJournal]:
    """Open the results of ``study`` in ``folder`` for appending; nobody else may append meanwhile.

    ``accept_old_rows`` : keep rows that other code or versions made, and let the manifest say so.

    Raises
    ------
    InputError : the folder holds something else, another version, damaged rows, or is in use.
    """
    output_directory(folder, MANIFEST, JOURNAL, TABLE)
    manifest = _claim(study, folder, accept_old_rows=accept_old_rows)
    path = folder / JOURNAL
    with _opened(path) as stream:
        _lock(stream, folder)
        if manifest:
            write_json(folder / MANIFEST, manifest)
        _cut_torn_line(path)
        yield TrialJournal(study, folder, stream, _read(path, study))


def read_table(folder: Path) -> list[dict[str, str]]:
    """Return the rows of a finished study, sorted by case and trial; columns of former names go by those of today.

    Raises
    ------
    InputError : there is no finished table.
    """
    try:
        text = (folder / TABLE).read_text(encoding="utf-8")
    except OSError as error:
        raise InputError("results", "must hold a finished table", f"{folder / TABLE} ({error.strerror})") from None
    rows = list(csv.DictReader(io.StringIO(text)))
    return [{current_column(name): cell for name, cell in row.items()} for row in rows]


def _opened(path: Path) -> TextIO:
    try:
        return output_file(path).open("a+", encoding="utf-8", newline="")
    except OSError as error:
        raise InputError("out", "must hold a journal that can be written", f"{path} ({error.strerror})") from None


def _checksum(cells: Iterable[str]) -> str:
    """CRC-32 of the cells, as eight hexadecimal digits."""
    return f"{zlib.crc32(_line(cells).encode()):08x}"


def _last_of_header(columns: Iterable[str]) -> str:
    return f"{CHECKSUM} {_checksum(columns)}"


def _line(cells: object) -> str:
    stream = io.StringIO()
    csv.writer(stream, lineterminator="\n").writerow(cells)  # type: ignore[arg-type]
    return stream.getvalue()


def _claim(study: Study, folder: Path, *, accept_old_rows: bool) -> dict[str, Any]:
    """The manifest that the folder is to have, if it has another or none; refuse a folder that is not this study's.

    If no trial was finished, as when the first one raised, any version of the study may begin.
    """
    manifest = {
        "format": FORMAT,
        "study": study.name,
        "version": study.version,
        "fingerprint": study.fingerprint(),
        "made_with": VERSIONS,
        "measured_by": study.code(),
        "definition": study.definition(),
    }
    path = folder / MANIFEST
    if not path.exists():
        # A killed run may have left a hidden temporary file, or an empty journal, nothing else.
        if any(not file.name.startswith(".") and not _is_empty_journal(file) for file in folder.iterdir()):
            raise InputError("out", f"must be an empty folder or hold the {MANIFEST} of this study", folder)
        return manifest
    code = {name: manifest[name] for name in ("made_with", "measured_by")}
    measured = ", ".join(study.modules())
    try:
        found = json.loads(path.read_text(encoding="utf-8"))
        old = {name: found[name] for name in code}
        shown = f"study {found['study']!r} version {found['version']}"
        if found["study"] == study.name and not _has_rows(folder / JOURNAL):
            return {} if found == manifest else manifest
        same_study = (found["study"], found["version"]) == (study.name, study.version)
        checks = [
            (found["format"] == FORMAT, f"results of format {FORMAT}", f"format {found['format']}"),
            (same_study, f"results of study {study.name!r} version {study.version}", shown),
            (
                found["fingerprint"] == study.fingerprint(),
                "results of this definition and seed",
                f"{shown} with another definition or seed",
            ),
            (
                accept_old_rows or old["made_with"] == VERSIONS,
                f"results made with {VERSIONS} (or --accept-old-rows keeps the others, marked)",
                old["made_with"],
            ),
            (
                accept_old_rows or old == code,
                f"results measured by the same code of {measured} (or --accept-old-rows keeps the others, marked)",
                "other code",
            ),
        ]
    except (OSError, ValueError, KeyError, TypeError, RecursionError) as error:
        raise InputError("out", f"must hold a readable {MANIFEST}", f"{path} ({type(error).__name__})") from None
    for holds, wanted, got in checks:
        if not holds:
            raise InputError("out", f"must be a new folder or hold {wanted}", f"{got} in {folder}")
    return {} if old == code else {**manifest, "older_rows_by": [*found.get("older_rows_by", []), old]}


def _has_rows(journal: Path) -> bool:
    """Tell whether a trial was finished: a whole line beside the header."""
    return journal.exists() and journal.read_bytes().count(b"\n") > 1


def _is_empty_journal(file: Path) -> bool:
    return file.name == JOURNAL and file.stat().st_size == 0


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
    try:
        text = path.read_text(encoding="utf-8")
        lines = list(csv.reader(io.StringIO(text, newline=""), strict=True))
    except UnicodeDecodeError as error:
        raise InputError(str(path), "must be UTF-8 text", f"byte {error.start} is not") from None
    except csv.Error as error:
        raise InputError(str(path), "must be a table of comma-separated values", error) from None
    if not lines:
        return []
    *header, last = lines[0]
    if last != _last_of_header(header) or len(set(header)) < len(header):
        raise InputError(f"{path} line 1", f"must name the columns, last {CHECKSUM}", ",".join(lines[0]))
    names = {case.name for case in study.cases}
    rows = []
    seen: set[tuple[str, str]] = set()
    for number, (*cells, checksum) in enumerate((line or [""] for line in lines[1:]), start=2):
        row = dict(zip(header, cells, strict=False))
        key = (row.get("case", ""), row.get("trial", ""))
        whole = len(cells) == len(header) and checksum == _checksum(cells)
        number_of_trial = key[1].isascii() and key[1].isdecimal() and len(key[1]) < 19
        if not whole or key[0] not in names or not number_of_trial or key in seen:
            raise InputError(f"{path} line {number}", "must be one whole row, given once", ",".join(cells) or checksum)
        seen.add(key)
        rows.append(row)
    return rows
