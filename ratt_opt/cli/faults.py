"""What happens when the program itself is at fault, or is interrupted where nobody expects it."""

from __future__ import annotations

import _thread
import os
import platform
import signal
import sys
import tempfile
import threading
import traceback
from pathlib import Path
from typing import TYPE_CHECKING, Any, Self

from ratt_opt import __version__

if TYPE_CHECKING:
    from types import FrameType

__all__ = ["Interrupts", "keep_traceback"]


class Interrupts:
    """Raises ``KeyboardInterrupt`` as Python does, and remembers that it did; ``happened`` : whether there was one.

    One that Python drops, because it came inside a destructor or callback, is raised again after it.
    """

    def __init__(self) -> None:
        self.happened = False
        self._before: Any = None
        self._hook: Any = None

    def __enter__(self) -> Self:
        main_thread = threading.current_thread() is threading.main_thread()
        if main_thread and signal.getsignal(signal.SIGINT) is signal.default_int_handler:
            self._before = signal.signal(signal.SIGINT, self._interrupt)
        self._hook, sys.unraisablehook = sys.unraisablehook, self._dropped
        return self

    def __exit__(self, *_: object) -> None:
        sys.unraisablehook = self._hook
        if self._before is not None:
            signal.signal(signal.SIGINT, self._before)

    def _interrupt(self, number: int, frame: FrameType | None) -> None:
        self.happened = True
        signal.default_int_handler(number, frame)

    def _dropped(self, what: Any) -> None:
        if issubclass(what.exc_type, KeyboardInterrupt):
            self.happened = True
            _thread.interrupt_main()
        else:
            self._hook(what)


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
