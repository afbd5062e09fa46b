"""Scenario files: strict, versioned JSON.

Policy on versions: a file states ``format`` and ``version``. This release reads version 1, the first.
A later release will read every older version it documents, or refuse it naming the release that can;
a version newer than the program knows is refused.
"""

from __future__ import annotations

import json
import re
from codecs import BOM_UTF8
from collections import Counter
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ratt_opt._files import write_json
from ratt_opt.errors import FileFormatError, InputError
from ratt_opt.scenario.information_input import InformationInput
from ratt_opt.scenario.model import Scenario

if TYPE_CHECKING:
    from ratt_opt.scenario.record import Record

__all__ = ["load_input", "load_scenario", "parse_json", "read_bytes", "read_json", "save_scenario", "scenario_schema"]

LARGEST_FILE = 256 * 2**20
"""Bytes; a longer input file is refused, and never held whole."""

_KINDS: dict[str, type[Scenario] | type[InformationInput]] = {
    "ratt-opt scenario": Scenario,
    "ratt-opt information": InformationInput,
}
_VERSION = 1


def load_scenario(path: str | Path) -> Scenario:
    """Read a scenario file.

    Raises
    ------
    FileFormatError : unreadable, not strict JSON, or a field breaks its rule; the text names the line or field.
    """
    loaded = load_input(path)
    if not isinstance(loaded, Scenario):
        raise FileFormatError(f"{path}: format", "must be 'ratt-opt scenario'", loaded.format)
    return loaded


def load_input(path: str | Path) -> Scenario | InformationInput:
    """Read a scenario or a model-free information file; ``format`` says which.

    Raises
    ------
    FileFormatError : unreadable, not strict JSON, or a field breaks its rule; the text names the line or field.
    """
    document = read_json(path)
    if not isinstance(document, dict):
        raise FileFormatError(str(path), "must hold a JSON object", type(document).__name__)
    known = " or ".join(f"'{name}'" for name in _KINDS)
    kind = document.get("format")
    if not isinstance(kind, str) or kind not in _KINDS:
        raise FileFormatError(f"{path}: format", f"must be {known}", "nothing" if kind is None else kind)
    version = document.get("version")
    if version != _VERSION or isinstance(version, bool):
        raise FileFormatError(f"{path}: version", f"must be {_VERSION}", "nothing" if version is None else version)
    if "payload" in document:
        raise FileFormatError(f"{path}: payload", "is not a field of this format: payloads stay in memory", "a payload")
    try:
        return _KINDS[kind](**document)
    except InputError as error:
        raise FileFormatError(f"{path}: {error.argument}", error.rule, error.value) from None


def save_scenario(scenario: Scenario | InformationInput, path: str | Path) -> None:
    """Write a scenario (:func:`load_scenario` reads it) or matrices (:func:`load_input`), whole or not at all.

    Raises
    ------
    InputError : the file cannot be written, or could not be read back: a file names a sensor class of your own only if
        it is registered (:func:`register_sensor`). ``scenario.to_information()`` can always be saved.
    """
    if isinstance(scenario, Scenario):
        for field, kind in scenario.own_sensors.items():
            rule = "must be the library's Sensor or a registered one to be saved (register_sensor, or to_information())"
            raise InputError(field, rule, kind)
    document = scenario.model_dump(mode="json")
    length = len(json.dumps(document, indent=1))
    if length >= LARGEST_FILE:
        raise InputError("scenario", f"must make a file of at most {LARGEST_FILE} bytes", length)
    write_json(path, document)


def scenario_schema(kind: str = "scenario") -> dict[str, Any]:
    """Return the JSON Schema of ``"scenario"`` or ``"information"`` files.

    Raises
    ------
    InputError : any other kind.
    """
    record: type[Record] | None = _KINDS.get(f"ratt-opt {kind}")
    if record is None:
        raise InputError("kind", "must be scenario or information", kind)
    schema = record.model_json_schema()
    schema["required"] = sorted({*schema.get("required", []), "format", "version"})
    return {"$schema": "https://json-schema.org/draft/2020-12/schema", **schema}


def read_json(path: str | Path) -> Any:
    """Read strict JSON: UTF-8, no NaN or Infinity, no repeated keys, of bounded size and depth.

    A byte-order mark at the start is passed over.

    Raises
    ------
    FileFormatError : any of these is broken, with the line if one is known.
    """
    return parse_json(read_bytes(Path(path)), path)


def parse_json(raw: bytes, path: str | Path) -> Any:
    """Read strict JSON from the bytes of a file, as :func:`read_json`; ``path`` is for its errors."""
    text = _decoded(raw, path)
    try:
        document = json.loads(text, object_pairs_hook=_refuse_repeats)
    except json.JSONDecodeError as error:
        where = f"{path} line {error.lineno}, column {error.colno}"
        raise FileFormatError(where, "must be strict JSON", error.msg) from None
    except _NotStrictError as error:
        raise FileFormatError(str(path), "must be strict JSON", error) from None
    except ValueError:
        # Only int() is left to fail: Python refuses to convert more digits than its safety limit.
        raise FileFormatError(str(path), "must be strict JSON", "an integer with too many digits") from None
    except RecursionError:
        raise FileFormatError(str(path), "must be strict JSON", "lists or objects nested too deeply") from None
    _refuse_constants(path, text)
    return document


class _NotStrictError(Exception):
    """The text is JSON to Python but not to the standard."""


_TOKEN = re.compile(r'"(?:[^"\\]|\\.)*"|(-?Infinity|NaN)', re.DOTALL)
"""Strings, which are passed over, and the constants that Python reads but JSON does not have."""


def _refuse_constants(path: str | Path, text: str) -> None:
    for token in _TOKEN.finditer(text):
        if token[1]:
            line = text.count("\n", 0, token.start()) + 1
            raise FileFormatError(f"{path} line {line}", "must be strict JSON", f"the constant {token[1]}")


def _refuse_repeats(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    document = dict(pairs)
    if len(document) < len(pairs):
        repeated = next(name for name, count in Counter(name for name, _ in pairs).items() if count > 1)
        raise _NotStrictError(f"the field {repeated!r} twice")
    return document


def _decoded(raw: bytes, path: str | Path) -> str:
    try:
        return raw.removeprefix(BOM_UTF8).decode("utf-8")
    except UnicodeDecodeError as error:
        raise FileFormatError(str(path), "must be UTF-8 text", f"byte {error.start} is not") from None


def read_bytes(path: Path) -> bytes:
    """Read a file of at most ``LARGEST_FILE`` bytes.

    Raises
    ------
    FileFormatError : it is longer, or cannot be read.
    """
    try:
        # Pipes and devices have no size to ask for, so reading itself stops past the limit.
        with path.open("rb") as file:
            content = file.read(LARGEST_FILE + 1)
    except OSError as error:
        raise FileFormatError(str(path), "must be a file that can be read", error.strerror or "unreadable") from None
    if len(content) > LARGEST_FILE:
        raise FileFormatError(str(path), f"must be at most {LARGEST_FILE} bytes", "more")
    return content
