"""Journal of a mission: one line a step with its decisions, from which it is replayed and continued after a kill.

Each line carries a checksum of the rest of it: what was damaged since is refused by its line.

Everything else in a mission follows from its arguments and the seed, so that a replay is the mission, to the bit.
"""

from __future__ import annotations

import hashlib
import json
import os
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np

from ratt_opt._files import output_file
from ratt_opt._validation import IntArray, readonly
from ratt_opt.errors import FileFormatError, InputError
from ratt_opt.problem import Attack

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence
    from pathlib import Path

    from ratt_opt.scenario.model import Scenario

__all__ = ["Journal"]

FORMAT = "ratt-opt mission journal"
SEAL = "checksum"
"""The field of a line's checksum."""


@dataclass(slots=True)
class Journal:
    """The decisions recorded so far; ``path`` is ``None`` if none are kept.

    The file begins with the first decision: a mission that is refused leaves none behind.
    """

    path: Path | None
    head: Mapping[str, Any] = field(default_factory=dict)
    lines: list[tuple[IntArray, Attack]] = field(default_factory=list)

    @classmethod
    def open(cls, path: str | Path | None, scenario: Scenario, settings: Mapping[str, str]) -> Journal:
        """Read what a file holds of this mission, or begin it.

        A line that a kill cut short is dropped.

        Raises
        ------
        FileFormatError : the file is no journal.
        InputError : it is another mission's, or cannot be written.
        """
        if path is None:
            return cls(None)
        file = output_file(path)
        own = {name: [kind, scenario.digest] for name, kind in scenario.own_sensors.items()}
        text = json.dumps([scenario.model_dump(mode="json"), dict(settings) | own], sort_keys=True)
        head = {
            "format": FORMAT,
            "version": 1,
            "mission": hashlib.sha256(text.encode()).hexdigest(),
        }
        journal = cls(file, head)
        *whole, torn = _lines(file)
        if not whole:
            if not _sealed(head).startswith(torn):
                raise FileFormatError(f"{file} line 1", "must be a mission's journal", torn)
            return journal
        first, *rest = [_parsed(file, number, line) for number, line in enumerate(whole, start=1)]
        if first != head:
            raise InputError(
                "journal", "must be of the same mission (scenario, seed, all settings), or removed to begin anew", file
            )
        journal.lines = [_decision(file, number, line) for number, line in enumerate(rest)]
        if torn:
            _drop(file, torn)
        return journal

    def recorded(self, step: int) -> tuple[IntArray, Attack] | None:
        """The decisions of a step, if they are known."""
        return self.lines[step] if step < len(self.lines) else None

    def append(self, step: int, elements: IntArray, attack: Attack) -> None:
        """Keep the decisions of the next step."""
        if self.path is not None:
            links = [list(link) for link in sorted(attack.links)]
            line = {"step": step, "elements": elements.tolist(), "sensing": sorted(attack.sensing), "links": links}
            _write(self.path, [line] if step else [self.head, line])


def _lines(file: Path) -> list[str]:
    """Whole lines, and what follows the last of them."""
    try:
        return file.read_bytes().decode("utf-8").split("\n") if file.exists() else [""]
    except (OSError, UnicodeDecodeError) as error:
        raise FileFormatError(str(file), "must be a mission's journal", type(error).__name__) from None


def _drop(file: Path, torn: str) -> None:
    """Cut off what follows the last whole line: the next step is written there; whole lines are never written again."""
    try:
        os.truncate(file, file.stat().st_size - len(torn.encode()))
    except OSError as error:
        raise _unwritable(file, error) from None


def _unwritable(file: Path, error: OSError) -> InputError:
    return InputError("journal", "must be a file that can be written", f"{file} ({error.strerror})")


def _write(file: Path, records: Sequence[Mapping[str, Any]]) -> None:
    """Append records, or begin the file with a first pair of them."""
    try:
        with file.open("w" if len(records) > 1 else "a", encoding="utf-8") as stream:
            stream.write("".join(_sealed(record) + "\n" for record in records))
            stream.flush()
            os.fsync(stream.fileno())
    except OSError as error:
        raise _unwritable(file, error) from None


def _sealed(record: Mapping[str, Any]) -> str:
    """A line of the file, without its end."""
    return json.dumps({**record, SEAL: hashlib.sha256(json.dumps(record).encode()).hexdigest()[:16]})


def _parsed(file: Path, number: int, line: str) -> dict[str, Any]:
    try:
        record = json.loads(line)
    except (ValueError, RecursionError):
        record = None
    if not isinstance(record, dict):
        raise FileFormatError(f"{file} line {number}", "must be a JSON object", line)
    if number == 1 and record.get("format") != FORMAT:
        raise FileFormatError(f"{file} line 1", "must be a mission's journal", record.get("format"))
    record.pop(SEAL, None)
    if _sealed(record) != line:
        raise FileFormatError(f"{file} line {number}", "must be as it was written (its checksum says otherwise)", line)
    return record


def _decision(file: Path, step: int, record: dict[str, Any]) -> tuple[IntArray, Attack]:
    where = f"{file} line {step + 2}"
    try:
        if record["step"] != step:
            raise FileFormatError(where, f"must be step {step}", record["step"])
        links = frozenset((i, j) for i, j in record["links"])
        return readonly(np.array(record["elements"], dtype=np.int64)), Attack(frozenset(record["sensing"]), links)
    except (KeyError, TypeError, ValueError, OverflowError) as error:
        if isinstance(error, InputError):
            raise
        raise FileFormatError(where, "must hold step, elements, sensing and links", sorted(record)) from None
