"""The sources of the compiled loops and their library; the build loads this file too, and needs only Python for it."""

import hashlib
import sys
from pathlib import Path

__all__ = ["LIBRARY", "SOURCES", "fingerprint"]

FOLDER = Path(__file__).parent
SOURCES = FOLDER / "src"
LIBRARY = FOLDER / ("_loops" + {"win32": ".dll", "darwin": ".dylib"}.get(sys.platform, ".so"))


def fingerprint() -> str:
    """Of all sources: a library of others is not loaded."""
    return hashlib.sha256(b"".join(file.read_bytes() for file in sorted(SOURCES.iterdir()))).hexdigest()[:16]
