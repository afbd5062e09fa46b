"""A library: a folder of instances, their index, and the best that is known of each."""

from __future__ import annotations

import csv
import io
from dataclasses import asdict, dataclass, fields
from math import isfinite
from pathlib import Path
from typing import TYPE_CHECKING, Any, Self

from ratt_opt._files import write_atomically
from ratt_opt.benchmark.instances.instance import BenchmarkInstance, canonical, read_instance, write_document
from ratt_opt.errors import FileFormatError, InputError

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

__all__ = ["BEST", "INDEX", "BenchmarkLibrary", "Best", "IndexEntry"]

INDEX, BEST, INSTANCES, RECORDS = "library.csv", "best.csv", "instances", "records"
"""Files and folders of a library."""


@dataclass(frozen=True, slots=True, kw_only=True)
class IndexEntry:
    """One line of the index.

    ``code`` : class of the instance; ``robots`` and ``elements`` : its size (links, in the track of cuts);
    ``hardness`` : ``easy`` (a heuristic is optimal, and the proof takes seconds), ``medium``, ``hard`` (closed by the
    longest run only) or ``open``; ``curated`` : 1 for the few of a first look; ``sha256`` : of the instance
    """

    name: str
    code: str
    family: str
    robots: int
    elements: int
    hardness: str
    curated: int
    sha256: str


@dataclass(frozen=True, slots=True, kw_only=True)
class Best:
    """One line of the records: what is attained and what is proved of an instance.

    ``certificate`` : SHA-256 of the record file, which has the answer and the proof of ``bound``; ``bound`` is infinite
    if nothing is proved; ``who`` and ``version`` : what found it
    """

    instance: str
    value: float
    bound: float
    certificate: str
    who: str
    version: str
    date: str

    @property
    def is_closed(self) -> bool:
        """True if the ends meet up to a millionth."""
        gap = abs(self.bound - self.value)
        return isfinite(gap) and gap <= 1e-6 * max(abs(self.bound), abs(self.value))


@dataclass(frozen=True, slots=True)
class BenchmarkLibrary:
    """Instances and records of a folder; read on first use.

    ``entries`` : the index by name; ``best`` : the records by instance
    """

    folder: Path
    entries: dict[str, IndexEntry]
    best: dict[str, Best]

    @classmethod
    def load(cls, folder: str | Path) -> Self:
        """Read index and records of a folder.

        Raises
        ------
        FileFormatError : there is no index, or a line of a table breaks its rule.
        """
        place = Path(folder)
        entries = [IndexEntry(**row) for row in _rows(place / INDEX, IndexEntry)]
        best = [Best(**row) for row in _rows(place / BEST, Best)] if (place / BEST).exists() else []
        return cls(place, {entry.name: entry for entry in entries}, {row.instance: row for row in best})

    def instance(self, name: str) -> BenchmarkInstance:
        """Read an instance and compare it with the index.

        Raises
        ------
        InputError : there is none of that name.
        FileFormatError : its file is another one than the index says.
        """
        if name not in self.entries:
            raise InputError("instance", f"must be one of the {len(self.entries)} of {self.folder}", name)
        path = self.path(name)
        instance = read_instance(path)
        if hash_of(instance.document) != self.entries[name].sha256 or instance.name != name:
            raise FileFormatError(str(path), "must have the SHA-256 of the index", "another instance")
        return instance

    def path(self, name: str) -> Path:
        """File of an instance."""
        return self.folder / INSTANCES / f"{name}.json.xz"

    def record_path(self, name: str) -> Path:
        """File of the record of an instance."""
        return self.folder / RECORDS / f"{name}.json.xz"

    def chosen(self, names: Sequence[str] = (), *, curated: bool = False) -> list[str]:
        """Names of instances: those whose name or class begins with one of the words, the curated, or all.

        Raises
        ------
        InputError : a word fits none.
        """
        for word in names:
            if not any(_fits(entry, word) for entry in self.entries.values()):
                raise InputError("--only", "must begin the name or class of an instance", word)
        listed = [e for e in self.entries.values() if not names or any(_fits(e, word) for word in names)]
        return [entry.name for entry in listed if entry.curated or not curated]

    def add(self, instance: BenchmarkInstance, *, hardness: str, curated: bool = False) -> BenchmarkLibrary:
        """Write an instance and its line of the index; the library with it."""
        (self.folder / INSTANCES).mkdir(parents=True, exist_ok=True)
        digest = write_document(instance.document, self.path(instance.name))
        robots, elements = instance.sizes
        entry = IndexEntry(
            name=instance.name,
            code=instance.class_code,
            family=instance.family,
            robots=robots,
            elements=elements,
            hardness=hardness,
            curated=int(curated),
            sha256=digest,
        )
        entries = {**self.entries, entry.name: entry}
        write_table(self.folder / INDEX, [entries[name] for name in sorted(entries)], IndexEntry)
        return BenchmarkLibrary(self.folder, entries, self.best)

    def set_best(self, row: Best, record: dict[str, object]) -> BenchmarkLibrary:
        """Write a record that has been verified, and its line of the table; the library with it."""
        (self.folder / RECORDS).mkdir(parents=True, exist_ok=True)
        digest = write_document(record, self.record_path(row.instance))
        if digest != row.certificate:
            raise InputError("certificate", "must be the SHA-256 of the record", row.certificate)
        best = {**self.best, row.instance: row}
        write_table(self.folder / BEST, [best[name] for name in sorted(best)], Best)
        return BenchmarkLibrary(self.folder, self.entries, best)


def hash_of(document: object) -> str:
    """SHA-256 of a document."""
    import hashlib

    return hashlib.sha256(canonical(document)).hexdigest()


def _fits(entry: IndexEntry, word: str) -> bool:
    return entry.name.startswith(word) or entry.code.startswith(word)


def _rows(path: Path, kind: type[IndexEntry | Best], most: int = 16 * 2**20) -> list[dict[str, Any]]:
    """Lines of a table of at most that many bytes, with the columns of a record, as the types of its fields."""
    try:
        raw = path.read_bytes()
    except OSError as error:
        raise FileFormatError(str(path), "must be a file that can be read", error.strerror or "unreadable") from None
    if len(raw) > most:
        raise FileFormatError(str(path), f"must be at most {most} bytes", len(raw))
    try:
        lines = list(csv.reader(io.StringIO(raw.decode("utf-8"), newline=""), strict=True))
    except (UnicodeDecodeError, csv.Error) as error:
        raise FileFormatError(str(path), "must be a table in UTF-8", error) from None
    names = [field.name for field in fields(kind)]
    if not lines or lines[0] != names:
        raise FileFormatError(
            f"{path} line 1", f"must be {','.join(names)}", ",".join(lines[0]) if lines else "nothing"
        )
    found, seen = [], set()
    for number, line in enumerate(lines[1:], start=2):
        if len(line) != len(names) or line[0] in seen:
            raise FileFormatError(f"{path} line {number}", f"must have {len(names)} cells, once", ",".join(line))
        seen.add(line[0])
        found.append(_typed(f"{path} line {number}", kind, dict(zip(names, line, strict=True))))
    return found


def _typed(where: str, kind: type[IndexEntry | Best], row: dict[str, str]) -> dict[str, Any]:
    types = {"int": int, "float": float, "str": str}
    try:
        return {field.name: types[str(field.type)](row[field.name]) for field in fields(kind)}
    except ValueError as error:
        raise FileFormatError(where, "must have numbers in their columns", error) from None


def write_table(path: Path, rows: Iterable[IndexEntry | Best], kind: type[IndexEntry | Best]) -> None:
    """Write records as a table of comma-separated values; floats so that they read back exactly."""
    text = io.StringIO(newline="")
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow([field.name for field in fields(kind)])
    writer.writerows([list(asdict(row).values()) for row in rows])
    write_atomically(path, lambda file: file.write_text(text.getvalue(), encoding="utf-8", newline=""))
