"""Ctrl-C in a search: it is noted, every loop meets the note, and the bracket so far is returned.

An exception at any moment may be lost (in a destructor or a callback), leave something half done, or come before there
is a bracket. So a first interrupt raises nothing: the budgets of the search see the note. If the search is not back
soon, as in a value of the user's own function, the interrupt is raised, and a loop that keeps its bracket meets it.
"""

from __future__ import annotations

import _thread
import signal
import threading
from contextlib import contextmanager
from dataclasses import dataclass
from time import sleep
from typing import TYPE_CHECKING, Any

from ratt_opt.running.interrupts import AGAIN_AFTER, interrupt_main_thread, must_wait

if TYPE_CHECKING:
    from collections.abc import Iterator
    from types import CodeType, FrameType

__all__ = ["InterruptNote", "current_note", "noting_interrupts"]


@dataclass(frozen=True, slots=True, kw_only=True)
class InterruptParams:
    """``patience`` : time for a search to meet the note before the interrupt is raised [s]; a longer one gives long
    calls of others more time to end by themselves, a shorter one ends slow functions of users sooner
    """

    patience: float = 0.2


PARAMS = InterruptParams()
_THREAD = threading.local()


@dataclass(slots=True)
class InterruptNote:
    """Note that the user interrupted; one for a search and all its parts.

    ``begun_anew`` : whether the search was begun anew with the note, as it had no bracket when the interrupt was raised
    """

    happened: bool = False
    begun_anew: bool = False


def current_note() -> InterruptNote:
    """The note of the search under way in this thread, or a new one."""
    return getattr(_THREAD, "note", None) or InterruptNote()


def is_noting() -> bool:
    """Tell whether a search is under way in this thread."""
    return getattr(_THREAD, "note", None) is not None


@contextmanager
def noting_interrupts(note: InterruptNote, outermost: CodeType) -> Iterator[None]:
    """Note an interrupt of the main thread instead of raising it, if Python's or the command line's handler would.

    ``outermost`` : of the function that is the search
    """
    _THREAD.note = note
    before = signal.getsignal(signal.SIGINT)
    is_main = threading.current_thread() is threading.main_thread()
    if not (is_main and _raises(before)):
        try:
            yield
        finally:
            _THREAD.note = None
        return
    watch = _Watch(note, before, outermost)
    try:
        signal.signal(signal.SIGINT, watch.meet)
        yield
    finally:
        watch.end()
        signal.signal(signal.SIGINT, before)
        _THREAD.note = None


def _raises(handler: Any) -> bool:
    """Tell whether a handler only raises ``KeyboardInterrupt``: others belong to programs around."""
    is_ours = type(getattr(handler, "__self__", None)).__module__ == "ratt_opt.cli.interrupts"
    return handler is signal.default_int_handler or is_ours


class _Watch:
    """The handler of one search; raises an interrupt that was noted and is not met in time."""

    def __init__(self, note: InterruptNote, before: Any, outermost: CodeType) -> None:
        self._note, self._before, self._outermost = note, before, outermost
        self._is_over = self._was_sent = self._was_met = False
        self._lock = threading.Lock()

    def meet(self, number: int, frame: FrameType | None) -> None:
        """Note the first interrupt; raise the next, from the user or from the watch."""
        if not self._note.happened:
            self._note.happened = True
            self._raise_in(PARAMS.patience)
            return
        self._was_met = True
        if self._is_over:
            return
        if must_wait(frame, self._outermost):  # a package that is imported by half cannot be imported again
            self._was_sent = self._was_met = False
            self._raise_in(AGAIN_AFTER)
            return
        self._before(number, frame)

    def _raise_in(self, seconds: float) -> None:
        _thread.start_new_thread(self._raise_later, (seconds,))  # threading's own locks may be held by whom this ends

    def _raise_later(self, seconds: float) -> None:
        sleep(seconds)
        with self._lock:
            if not self._is_over:
                self._was_sent = True
                interrupt_main_thread()

    def end(self) -> None:
        """Raise nothing any more; one that was sent is met before another handler could meet it."""
        self._is_over = True
        with self._lock:
            was_sent = self._was_sent
        while was_sent and not self._was_met:
            sleep(0.001)
