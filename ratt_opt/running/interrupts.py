"""Protection of short work that an interrupt must not leave half done."""

from __future__ import annotations

import signal
import sys
import threading
from contextlib import contextmanager
from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator
    from types import CodeType, FrameType

__all__ = [
    "AGAIN_AFTER",
    "imported_whole",
    "interrupt_main_thread",
    "interrupts_afterwards",
    "interrupts_between_packages",
    "must_wait",
]

PACKAGE = __name__.partition(".")[0]
AGAIN_AFTER = 0.01
"""Seconds until an interrupt that cannot be met where it came comes again."""


def _again_later(number: int) -> None:
    """Interrupt the main thread once more in a moment."""
    threading.Timer(AGAIN_AFTER, interrupt_main_thread, [number]).start()


def interrupt_main_thread(number: int = signal.SIGINT) -> None:
    """Interrupt the main thread from any thread, even if it sleeps or waits (if the system can tell single threads).

    A main thread that waits goes on for as long as it was to if the signal is sent to another one.
    """
    if sys.platform != "win32":
        signal.pthread_kill(threading.main_thread().ident or 0, number)
    else:
        signal.raise_signal(number)


@contextmanager
def interrupts_afterwards() -> Iterator[list[int]]:
    """Interrupts of the main thread come at the end of the block, which must be short or look at those it is given."""
    met: list[int] = []
    before = signal.getsignal(signal.SIGINT)
    if threading.current_thread() is not threading.main_thread() or not callable(before):
        yield met
        return
    signal.signal(signal.SIGINT, lambda number, _frame: met.append(number))
    try:
        yield met
    finally:
        signal.signal(signal.SIGINT, before)
        for number in met[:1]:
            signal.raise_signal(number)


def interrupts_between_packages(load: Callable[[str], object], name: str) -> object:
    """``load(name)``; an interrupt while a package of others is imported in it comes once all of that one is.

    Of NumPy, networkx or FLINT half imported what is left cannot be imported again, and every later search of the
    process failed. Of this package it can, so interrupts need not wait for all of it, which takes seconds.
    """
    before = signal.getsignal(signal.SIGINT)
    if threading.current_thread() is not threading.main_thread() or not callable(before):
        return load(name)

    def interrupt(number: int, frame: FrameType | None) -> None:
        if must_wait(frame, interrupts_between_packages.__code__):
            _again_later(number)
        else:
            before(number, frame)

    try:
        signal.signal(signal.SIGINT, interrupt)
        return load(name)
    finally:
        signal.signal(signal.SIGINT, before)


def imported_whole(module: str) -> Any:
    """A module of others whose import takes too long for interrupts to wait, imported anew if one ended it.

    What was imported of its package by then would stay, and hold on to a package that is none.
    """
    try:
        return import_module(module)
    except BaseException:
        package = module.partition(".")[0]
        for name in [name for name in sys.modules if name == package or name.startswith(f"{package}.")]:
            del sys.modules[name]
        raise


def must_wait(frame: FrameType | None, outermost: CodeType) -> bool:
    """Tell whether an interrupt must wait: a package of others is imported, something is collected, or handlers change.

    ``outermost`` : code of the function in which that counts
    """
    if frame is not None and frame.f_code is outermost:
        return True
    while frame is not None and frame.f_code is not outermost:
        code = frame.f_code
        # Python runs this from before a module is looked for until it stands in `sys.modules` for good.
        importing = code.co_name == "_find_and_load" and code.co_filename == "<frozen importlib._bootstrap>"
        if importing and frame.f_locals["name"].partition(".")[0] != PACKAGE:
            return True
        if code.co_name == "__del__":  # Python drops what is raised there
            return True
        frame = frame.f_back
    return False
