"""Messages of faults of the program itself."""

from __future__ import annotations

import os
import platform
import tempfile
import traceback
from pathlib import Path

from ratt_opt._version import __version__

__all__ = ["keep_traceback"]


def keep_traceback(error: Exception, arguments: list[str]) -> str:
    """Write the traceback to a file beside the output, or where temporary files go; return one line that names it."""
    text = f"ratt-opt {__version__}, Python {platform.python_version()}, {platform.platform()}\n{arguments!a}\n\n"
    text += "".join(traceback.format_exception(error))
    shown = f"unexpected {type(error).__name__}: {str(error)[:200]}"
    for folder in (_output_of(arguments), None):
        try:
            handle, name = tempfile.mkstemp(dir=folder, prefix="ratt-opt-error-", suffix=".txt")
            with os.fdopen(handle, "w", encoding="utf-8", errors="backslashreplace") as file:
                file.write(text)
        except (OSError, ValueError):
            continue
        return f"{shown}; this is a fault of ratt-opt: please report it with the file {name}"
    return f"{shown}; this is a fault of ratt-opt: please report it (the traceback could not be written)"


def _output_of(arguments: list[str]) -> Path | None:
    """The folder that a command line writes to, if it is there."""
    if "--out" not in arguments[:-1]:
        return None
    out = Path(arguments[arguments.index("--out") + 1])
    return next((folder for folder in (out, out.parent) if os.path.isdir(folder)), None)
