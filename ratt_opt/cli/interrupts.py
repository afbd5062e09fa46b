"""Interrupts (Ctrl-C) that are never lost and never a traceback. Light: it is imported before anything else."""

from __future__ import annotations

import signal
import sys
import threading
from time import sleep
from typing import TYPE_CHECKING, Any, Self

from ratt_opt.running.interrupts import AGAIN_AFTER, interrupt_main_thread

if TYPE_CHECKING:
    from types import FrameType

__all__ = ["Interrupts", "ignore_interrupts"]


class Interrupts:
    """Handler that raises ``KeyboardInterrupt`` as Python does, and remembers it; ``happened`` : whether there was one.

    One that Python drops, because it came inside a destructor or callback, comes again after it. What an
    interrupt leaves half done may fail when it is collected; that says nothing and is not shown.
    """

    def __init__(self) -> None:
        self.happened = False
        self._before: Any = None
        self._hook: Any = None
        self._is_dropping = False
        self._met = False  # no event: its lock would be waited for by the handler that interrupts whoever holds it

    def __enter__(self) -> Self:
        main_thread = threading.current_thread() is threading.main_thread()
        if main_thread and signal.getsignal(signal.SIGINT) is signal.default_int_handler:
            self._before = signal.signal(signal.SIGINT, self._interrupt)
        self._hook, sys.unraisablehook = sys.unraisablehook, self._dropped
        return self

    def __exit__(self, *_: object) -> None:
        try:
            self._leave()
        except KeyboardInterrupt:
            self._leave()
            raise

    def _leave(self) -> None:
        self._met = True
        if self._before is not None:
            signal.signal(signal.SIGINT, self._before)
        sys.unraisablehook = self._hook

    def _interrupt(self, number: int, frame: FrameType | None) -> None:
        self.happened = True
        if self._is_dropping:  # dropped too where raised: the one that comes again is not met yet
            return
        self._met = True
        signal.default_int_handler(number, frame)

    def _dropped(self, what: Any) -> None:
        if issubclass(what.exc_type, KeyboardInterrupt):
            self.happened = True
            # Raised from here it would be dropped again.
            self._is_dropping, self._met = True, False
            threading.Thread(target=self._again, daemon=True).start()
            self._is_dropping = False
        elif not self.happened:
            self._hook(what)

    def _again(self) -> None:
        """Interrupt the main thread until it has met that, unless the process would end by it.

        The destructor or callback that dropped it has ended by then. It comes again until it is met: one that comes
        just before the program waits for something does not end the waiting.
        """
        sleep(AGAIN_AFTER)
        while not self._met and signal.getsignal(signal.SIGINT) == self._interrupt:
            interrupt_main_thread()
            sleep(AGAIN_AFTER)


def ignore_interrupts() -> None:
    """Ignore interrupts from now on: the program is ending, and has said all it has to say.

    Ignored by the system: in place of any other handler the interpreter, on its way out, puts death by the signal.
    """
    signal.signal(signal.SIGINT, signal.SIG_IGN)
