"""Progress for people at a terminal: the current step and its time, once it has taken two seconds.

A step says what it is with ``Step``, as a block or as a decorator. Nothing is shown if standard error is no
terminal, in worker processes and in threads other than the main one; nothing stays on the screen.
"""

from __future__ import annotations

import os
import sys
import threading
from contextlib import ContextDecorator, suppress
from time import monotonic
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from typing import Self

__all__ = ["PATIENCE", "Step"]

PATIENCE = 2.0
"""Seconds before a step is worth a line."""
PERIOD = 0.5
"""Seconds between two looks at what is going on."""
ERASE = "\r\x1b[2K"


class Step(ContextDecorator):
    """``with Step("certificate") as step: step.say("checking it")``, or ``@Step("the worst attack")``.

    ``patience`` : seconds before it is shown, ``PATIENCE`` by default; 0 if somebody waits for an answer.
    """

    def __init__(self, text: str, patience: float | None = None) -> None:
        self._text, self._patience, self._detail, self._began = text, patience, "", 0.0

    def _recreate_cm(self) -> Step:
        return Step(self._text, self._patience)  # each call of a decorated function is a step of its own

    def __enter__(self) -> Self:
        if _somebody_looks():
            self._began = monotonic()
            _SCREEN.enter(self)
        return self

    def __exit__(self, *failure: object) -> None:
        if self._began:
            _SCREEN.leave(self)

    def say(self, detail: str) -> None:
        """Add what the step is at; a later detail replaces it."""
        self._detail = detail

    def line(self, now: float) -> str | None:
        """Return the line to show, if the step has taken long enough."""
        seconds = now - self._began
        if seconds < (PATIENCE if self._patience is None else self._patience):
            return None
        return f"{self._text}{': ' if self._detail else ''}{self._detail} ({seconds:.0f} s)"


class _Screen:
    """The steps under way, the innermost last, and the thread that shows them."""

    def __init__(self) -> None:
        self._steps: list[Step] = []
        self._lock = threading.RLock()
        self._thread: threading.Thread | None = None
        self._dirty = False

    def enter(self, step: Step) -> None:
        with self._lock:
            self._steps.append(step)
            if self._thread is None:
                self._thread = threading.Thread(target=self._watch, daemon=True, name="progress")
                self._thread.start()

    def leave(self, step: Step) -> None:
        with self._lock:
            if step in self._steps:
                del self._steps[self._steps.index(step) :]
            self._write("")

    def _watch(self) -> None:
        pause = threading.Event()
        while not pause.wait(PERIOD):
            with self._lock:
                if not self._steps:
                    self._thread = None
                    return
                now = monotonic()
                lines = [line for line in (step.line(now) for step in self._steps) if line is not None]
                if lines:
                    self._write(" > ".join(lines))

    def _write(self, text: str) -> None:
        if text or self._dirty:
            with suppress(OSError, ValueError):
                sys.stderr.write(ERASE + text[: _columns() - 1])
                sys.stderr.flush()
            self._dirty = bool(text)


_SCREEN = _Screen()


def _columns() -> int:
    """Return the width of the terminal that standard error is: a longer line could not be erased."""
    try:
        return os.get_terminal_size(sys.stderr.fileno()).columns or 80
    except (OSError, ValueError):
        return 80


def _somebody_looks() -> bool:
    """Tell whether standard error is a terminal, and this is the process and thread that people started."""
    try:
        if sys.stderr is None or not sys.stderr.isatty():
            return False
    except ValueError:  # closed
        return False
    from multiprocessing import parent_process  # takes 10 ms, where somebody looks

    return threading.current_thread() is threading.main_thread() and parent_process() is None
