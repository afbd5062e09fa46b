"""Files are written whole or not at all, and only if a regular file is or may come to be."""

from __future__ import annotations

import hashlib
import json
import os
import platform
import shutil
import stat
import sys
import tempfile
from pathlib import Path
from typing import TYPE_CHECKING

from ratt_opt.errors import InputError

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Mapping

__all__ = ["MIXED", "output_directory", "output_file", "write_atomically", "write_json", "write_together"]

MIXED = "incomplete.txt"
"""Present only while files that belong together are renamed, or after a kill in that moment."""
_MIXED_TEXT = """A run was stopped while it replaced the files of this folder: some may be of that run, some of an
earlier one. Run the same command again.
"""

WRITING = ".writing-"
"""Prefix of the names of files that are not yet whole."""

_KINDS = (
    (stat.S_ISLNK, "a symbolic link"),
    (stat.S_ISDIR, "a folder"),
    (stat.S_ISCHR, "a device"),
    (stat.S_ISBLK, "a device"),
    (stat.S_ISFIFO, "a pipe"),
    (stat.S_ISSOCK, "a socket"),
)


def output_directory(path: str | Path, *names: str) -> Path:
    """Create the folder ``path`` if needed and return it, ready to take files of these names.

    What a killed run of this machine left half-written there is removed.

    Raises
    ------
    InputError : the folder cannot be created or written to, or holds something else under one of the names.
    """
    folder = Path(path)
    try:
        folder.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryFile(dir=folder):
            pass
    except (OSError, ValueError) as error:
        raise InputError("out", "must be a folder that can be written", f"{folder} ({_reason(error)})") from None
    for name in (MIXED, *names):
        output_file(folder / name)
    _sweep(folder)
    return folder


def output_file(path: str | Path) -> Path:
    """Return ``path`` if a file may be written there: nothing is there yet, or a regular file.

    A symbolic link is not followed: what it points to may be anything, and the rename would replace the link.

    Raises
    ------
    InputError : a link, folder, device, pipe or socket is there, or it cannot be looked at.
    """
    target = Path(path)
    try:
        mode = target.lstat().st_mode
    except FileNotFoundError:
        return target
    except (OSError, ValueError) as error:
        raise InputError("out", "must be a path that can be written", f"{target} ({_reason(error)})") from None
    if not stat.S_ISREG(mode):
        kind = next((name for is_kind, name in _KINDS if is_kind(mode)), "no regular file")
        raise InputError("out", f"must be a new or a regular file, not {kind}", target)
    return target


def write_atomically(path: str | Path, write: Callable[[Path], object]) -> Path:
    """Call ``write`` on a temporary file beside ``path``, then rename it over ``path``.

    Raises
    ------
    InputError : the file cannot be written there, or what is there is no regular file.
    """
    target = output_file(path)
    try:
        handle, name = tempfile.mkstemp(dir=target.parent, prefix=_aside(), suffix=target.suffix)
    except (OSError, ValueError) as error:
        raise InputError("out", "must be a path that can be written", f"{target} ({_reason(error)})") from None
    os.close(handle)
    temporary = Path(name)
    try:
        write(temporary)
        temporary.chmod(0o666 & ~_umask())
        temporary.replace(target)
    except OSError as error:
        raise InputError("out", "must be a path that can be written", f"{target} ({_reason(error)})") from None
    finally:
        temporary.unlink(missing_ok=True)
    return target


def write_json(path: str | Path, document: object) -> Path:
    """Write ``document`` as strict JSON (no NaN or Infinity), floats at full precision."""
    text = json.dumps(document, indent=1, allow_nan=False) + "\n"
    return write_atomically(path, lambda file: file.write_text(text, encoding="utf-8"))


def write_together(
    folder: Path, writers: Mapping[str, Callable[[Path], object]], *, outdated: Iterable[str] = ()
) -> list[Path]:
    """Write files that belong together: all are made aside, then renamed into the folder one after the other.

    ``outdated`` : files of an earlier set that are removed with it, if they are there.

    A kill between two renames leaves ``MIXED`` in the folder, whose text says what that means.

    Raises
    ------
    InputError : a file cannot be written there; those of an earlier set are then all left as they were.
    """
    targets, gone = ([output_file(folder / name) for name in names] for names in (writers, outdated))
    mark = output_file(folder / MIXED)
    try:
        with tempfile.TemporaryDirectory(dir=folder, prefix=_aside()) as aside:
            for name, write in writers.items():
                write(Path(aside) / name)
            write_atomically(mark, lambda file: file.write_text(_MIXED_TEXT, encoding="utf-8"))
            for target in targets:
                (Path(aside) / target.name).replace(target)
            for target in gone:
                target.unlink(missing_ok=True)
            mark.unlink()
    except OSError as error:
        raise InputError("out", "must be a folder that can be written", f"{folder} ({_reason(error)})") from None
    return targets


def _aside() -> str:
    """Return the prefix of the names of half-written files, with the machine and the process that writes them."""
    return f"{WRITING}{_machine()}-{os.getpid()}-"


def _machine() -> str:
    return hashlib.sha256(platform.node().encode()).hexdigest()[:8]


def _sweep(folder: Path) -> None:
    """Remove what processes of this machine that run no more left aside; a running one needs its files."""
    for left in folder.glob(f"{WRITING}{_machine()}-*-*"):
        pid = left.name.split("-")[2]
        if not pid.isdecimal() or _runs(int(pid)):
            continue
        if left.is_dir() and not left.is_symlink():
            shutil.rmtree(left, ignore_errors=True)
        else:
            left.unlink(missing_ok=True)


def _runs(pid: int) -> bool:
    """Tell whether the process exists; also true if that cannot be tested without harm."""
    if sys.platform == "win32":
        return True
    try:
        os.kill(pid, 0)
    except ProcessLookupError:
        return False
    except (OSError, OverflowError):  # of another user, or no number of a process
        return True
    return True


def _reason(error: OSError | ValueError) -> str:
    return (error.strerror if isinstance(error, OSError) else str(error)) or type(error).__name__


def _umask() -> int:
    mask = os.umask(0)
    os.umask(mask)
    return mask
