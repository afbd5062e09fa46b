"""Certificate files: strict JSON of bounded size and depth, every field checked as it is read.

A JSON number stands for the binary64 float nearest to it; everything after that is exact.
"""

from __future__ import annotations

import hashlib
import json
import math
import re
from functools import cache
from itertools import chain, pairwise
from pathlib import Path
from typing import Any

from flint import fmpq, fmpq_mat

from ratt_opt.certificates.verifier.limits import limits
from ratt_opt.certificates.verifier.work import tell, tick
from ratt_opt.errors import FileFormatError, InputError, ProofError

FORMAT = "ratt-opt certificate"
VERSION = 2
CUTS_FORMAT, CUTS_VERSION = "ratt-opt cut certificate", 1
"""Certificates of fewest cuts."""


def _refusal(where: str, rule: str, value: object) -> FileFormatError:
    return FileFormatError(f"certificate {where}".strip(), rule, value)


def _finite(text: str) -> float:
    if not math.isfinite(value := float(text)):
        raise _refusal("number", "must be finite", f"the number {text}")
    return value


def _record(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    if len(record := dict(pairs)) < len(pairs):
        raise _refusal("record", "must not repeat a field", [name for name, _ in pairs])
    return record


def check_size(where: str, size: int, limit: int) -> None:
    """Refuse what would take too much memory."""
    if size > limit:
        raise _refusal(f"size of {where}", f"must be at most {limit}", size)


def need(holds: object, fault: str) -> None:
    """Raise the fault unless it holds."""
    if not holds:
        raise ProofError(fault)


def walk(name: str, tree: object, root: Any, expand: Any) -> int:
    """Walk a tree given in preorder and count its leaves: ``expand(node, case)`` yields the child cases in order.

    A leaf yields none. Cases are made as they are needed, so that one path is in memory.
    """
    paths, leaves, nodes = [iter([root])], 0, array(f"{name} tree", tree)
    for done, node in enumerate(nodes):
        check_size(f"{name} tree (depth)", len(paths), limits().depth)
        tick()
        tell(f"{name} proof", done, len(nodes))
        case = _next_case(paths)
        need(case is not None, f"{name} proof: a node is repeated or follows the last leaf")
        below = expand(node, case)
        first = next(below, None)
        leaves += first is None
        paths.append(chain([] if first is None else [first], below))
    need(_next_case(paths) is None, f"{name} proof: a case has no leaf")
    return leaves


def _next_case(paths: list[Any]) -> Any:
    while paths:
        if (case := next(paths[-1], None)) is not None:
            return case
        paths.pop()
    return None


def load(path: str | Path) -> dict[str, Any]:
    """Read a document of this format and version; anything else is a FileFormatError."""
    try:
        with Path(path).open("rb") as file:
            raw = file.read(limits().file + 1)
        check_size("file", len(raw), limits().file)
        check_size("lists", raw.count(b",") + raw.count(b"["), limits().entries)
        text = raw.decode("utf-8")
        document = json.loads(text, parse_float=_finite, parse_constant=_finite, object_pairs_hook=_record)
    except OSError as error:
        raise _refusal("file", "must be a file that can be read", f"{path} ({error.strerror})") from None
    except RecursionError:
        raise _refusal("file", "must not nest this deep", "a deeper file") from None
    except ValueError as error:
        if isinstance(error, InputError):
            raise
        raise _refusal("file", "must be complete JSON in UTF-8", error) from None
    check_format(document)
    return document  # type: ignore[no-any-return]


def check_format(document: object) -> None:
    """Refuse a document of another format or version."""
    if isinstance(document, dict) and document.get("format") == CUTS_FORMAT:
        if type(document.get("version")) is not int or document["version"] != CUTS_VERSION:
            raise _refusal("version", f"must be {CUTS_VERSION}", document.get("version"))
        return
    if not isinstance(document, dict) or document.get("format") != FORMAT:
        raise _refusal("format", f"must be {FORMAT!r}", document.get("format") if type(document) is dict else "none")
    if type(document.get("version")) is not int or document["version"] != VERSION:
        rule = f"must be {VERSION}: write the certificate again with this release"
        raise _refusal("version", rule, document.get("version"))


def document_hash(document: object) -> str:
    """SHA-256 of a document in canonical JSON (sorted fields, shortest round-trip floats)."""
    text = json.dumps(document, sort_keys=True, separators=(",", ":"), allow_nan=False)
    return hashlib.sha256(text.encode()).hexdigest()


def stated_hash(where: str, value: Any) -> str:
    """Return a SHA-256 as :func:`document_hash` writes it."""
    if not isinstance(value, str) or re.fullmatch("[0-9a-f]{64}", value) is None:
        raise _refusal(where, "must be a SHA-256 of 64 lower-case hexadecimal digits", value)
    return value


def fields(where: str, value: Any, names: str) -> list[Any]:
    """Return the values of a record that has exactly these fields (names separated by spaces)."""
    if not isinstance(value, dict) or set(value) != set(names.split()):
        found = sorted(value) if isinstance(value, dict) else type(value).__name__
        raise _refusal(where, f"must be a record of {names.replace(' ', ', ')}", found)
    return [value[name] for name in names.split()]


def array(where: str, value: Any, length: int | None = None) -> list[Any]:
    """Return a list, of the given length if any."""
    if not isinstance(value, list) or (length is not None and len(value) != length):
        found = f"{len(value)} entries" if isinstance(value, list) else type(value).__name__
        raise _refusal(where, "must be a list" + (f" of {length} entries" if length is not None else ""), found)
    return value


def index(where: str, value: Any, size: int) -> int:
    """Return an integer in ``[0, size)``."""
    if type(value) is not int or not 0 <= value < size:
        raise _refusal(where, f"must be an integer in [0, {size - 1}]", value)
    return value


def signed(where: str, value: Any, size: int) -> int:
    """Return an integer in ``(-size, size)``."""
    return index(where, value, size) if type(value) is not int or value >= 0 else -index(where, -value, size)


def indices(where: str, value: Any, size: int) -> tuple[int, ...]:
    """Return strictly ascending integers in ``[0, size)``."""
    found = tuple(index(where, item, size) for item in array(where, value))
    if any(a >= b for a, b in pairwise(found)):
        raise _refusal(where, "must be strictly ascending", value)
    return found


def links(where: str, value: Any, size: int) -> frozenset[tuple[int, int]]:
    """Return distinct pairs ``[i, j]`` with ``i < j < size``."""
    found = [tuple(indices(where, array(where, pair, 2), size)) for pair in array(where, value)]
    if len(set(found)) < len(found):
        raise _refusal(where, "must not repeat a link", value)
    return frozenset((i, j) for i, j in found)


def exact(where: str, value: Any) -> fmpq:
    """Return a number exactly."""
    if type(value) is not float and (type(value) is not int or abs(value) > 2**53):
        raise _refusal(where, "must be a number", value)
    return fmpq(*value.as_integer_ratio())


def packed(where: str, value: Any, d: int) -> fmpq_mat:
    """Return a symmetric matrix from its lower triangle, row by row."""
    flat = [exact(where, x) for x in array(where, value, d * (d + 1) // 2)]
    return fmpq_mat(d, d, [flat[k] for k in places(d)])


@cache
def places(d: int) -> list[int]:
    """Positions in a packed lower triangle of the entries of the whole matrix."""
    pairs = [(max(i, j), min(i, j)) for i in range(d) for j in range(d)]
    return [i * (i + 1) // 2 + j for i, j in pairs]


def rows_of(where: str, value: Any, columns: int) -> fmpq_mat:
    """Return a matrix from its entries, row by row."""
    flat = [exact(where, x) for x in array(where, value)]
    return fmpq_mat(len(flat) // columns, columns, flat)


def check_rows(where: str, value: Any, columns: int) -> None:
    """Check that a list holds at least one row and at most as many as columns; more would depend on each other."""
    count, rest = divmod(len(array(where, value)), max(columns, 1))
    if rest or not 0 < count <= columns:
        raise _refusal(where, f"must hold rows of {columns} numbers, 1 to {columns} of them", f"{len(value)} numbers")
