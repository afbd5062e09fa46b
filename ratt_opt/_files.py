"""Files are written whole or not at all."""

from __future__ import annotations

import json
import os
import tempfile
from pathlib import Path
from typing import TYPE_CHECKING

from ratt_opt.errors import InputError

if TYPE_CHECKING:
    from collections.abc import Callable

__all__ = ["output_directory", "write_atomically", "write_json"]


def output_directory(path: str | Path) -> Path:
    """Create the folder ``path`` if needed and return it.

    Raises
    ------
    InputError : the folder cannot be created or written to.
    """
    folder = Path(path)
    try:
        folder.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryFile(dir=folder):
            pass
    except OSError as error:
        raise InputError("out", "must be a folder that can be written", f"{folder} ({error.strerror})") from None
    return folder


def write_atomically(path: str | Path, write: Callable[[Path], object]) -> Path:
    """Call ``write`` on a temporary file beside ``path``, then rename it over ``path``.

    Raises
    ------
    InputError : the file cannot be written there.
    """
    target = Path(path)
    try:
        handle, name = tempfile.mkstemp(dir=target.parent, prefix=f".{target.stem}-", suffix=target.suffix)
    except OSError as error:
        raise InputError("out", "must be a path that can be written", f"{target} ({error.strerror})") from None
    os.close(handle)
    temporary = Path(name)
    try:
        write(temporary)
        temporary.chmod(0o666 & ~_umask())
        temporary.replace(target)
    except OSError as error:
        raise InputError("out", "must be a path that can be written", f"{target} ({error.strerror})") from None
    finally:
        temporary.unlink(missing_ok=True)
    return target


def write_json(path: str | Path, document: object) -> Path:
    """Write ``document`` as strict JSON (no NaN or Infinity), floats at full precision."""
    text = json.dumps(document, indent=1, allow_nan=False) + "\n"
    return write_atomically(path, lambda file: file.write_text(text, encoding="utf-8"))


def _umask() -> int:
    mask = os.umask(0)
    os.umask(mask)
    return mask
