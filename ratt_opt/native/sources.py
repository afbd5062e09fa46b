"""The sources of the compiled loops and their library; the build loads this file too, and needs only Python for it."""

import hashlib
import sys
from pathlib import Path

__all__ = ["HEADERS", "LIBRARY", "RECORD", "SOURCES", "TO_COMPILE", "fault_of", "fingerprint", "record_of"]

FOLDER = Path(__file__).parent
SOURCES = FOLDER / "src"
LIBRARY = FOLDER / ("_loops" + {"win32": ".dll", "darwin": ".dylib"}.get(sys.platform, ".so"))
RECORD = FOLDER / "loops.sha256"
"""Size and hash of the library as it was built, written beside it."""

COMPILED = """
    annealing column_annealing contexts cover cover_attacks cover_dive cut_annealing cut_states disjoint
    elements exchanges flow greedy group_tree groups keeping kept_links lattice levels marginal_dive needs outputs
    polytopes pricing sets_of_size target_sets team thresholds
"""
HEADERS = """
    annealing covers cut_states elements group_search groups kept_links lattice marginals outputs planar polytopes
    pricing random sets sets_of_size target_sets team
"""
TO_COMPILE = tuple(SOURCES / f"{name}.c" for name in COMPILED.split())
"""Other files in the folder are neither compiled nor counted: backups, drafts, what a merge left."""


def fingerprint() -> str:
    """Return a hash of all sources and headers by name: a library of others is not loaded.

    OSError : one cannot be read.
    """
    found = hashlib.sha256()
    for file in (*TO_COMPILE, *(SOURCES / f"{name}.h" for name in HEADERS.split())):
        content = file.read_bytes()
        found.update(f"{file.name} {len(content)}\n".encode() + content)
    return found.hexdigest()[:16]


def record_of(content: bytes) -> str:
    """Return what ``RECORD`` says of a library with this content."""
    return f"{len(content)} bytes, SHA-256 {hashlib.sha256(content).hexdigest()}\n"


def fault_of(library: Path, record: Path) -> str:
    """Return why the library is not the one that was built, or nothing: loading another file may kill the process."""
    try:
        built = record.read_text(encoding="utf-8")
        content = library.read_bytes()
    except FileNotFoundError:
        return "are not compiled"
    except (OSError, UnicodeDecodeError) as error:
        return f"cannot be read ({getattr(error, 'strerror', None) or type(error).__name__})"
    if record_of(content) == built:
        return ""
    return (
        f"are damaged or another file: {library.name} has {len(content)} bytes, and was built as {built.strip()[:90]!r}"
    )
