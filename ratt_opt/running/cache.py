"""A folder for compiled loops where neither the installation nor the home can be written."""

from __future__ import annotations

import os
from pathlib import Path

__all__ = ["provide_cache"]

VARIABLE = "NUMBA_CACHE_DIR"
"""Where the compiler keeps what it made; without any place it refuses to compile."""


def provide_cache() -> None:
    """Let compiled loops be kept in a temporary folder of this process if there is no other place for them."""
    if VARIABLE in os.environ or os.access(Path(__file__).parent, os.W_OK) or _writable(_user_cache()):
        return
    import atexit
    import shutil
    import tempfile

    # Of this process alone: what is kept is loaded as code, so nobody else may have written it.
    folder = tempfile.mkdtemp(prefix="ratt-opt-compiled-")
    atexit.register(shutil.rmtree, folder, ignore_errors=True)
    os.environ[VARIABLE] = folder


def _user_cache() -> Path | None:
    given = os.environ.get("XDG_CACHE_HOME")
    try:
        return Path(given) if given else Path.home()
    except RuntimeError:  # nobody's home
        return None


def _writable(folder: Path | None) -> bool:
    """Whether the folder can be written, or made."""
    if folder is None:
        return False
    there = next((path for path in (folder, *folder.parents) if path.exists()), folder)
    return there.is_dir() and os.access(there, os.W_OK)
