"""Ctrl-C at a chosen moment of a search."""

from collections.abc import Callable
from typing import Any

__all__ = ["INTERRUPTED_IMPORTS", "interrupted_at"]

INTERRUPTED_IMPORTS = """
import signal, sys

class Interrupts:
    def __init__(self, module):
        self.module = module

    def find_spec(self, name, path=None, target=None):
        if name == self.module:
            sys.meta_path.remove(self)
            signal.raise_signal(signal.SIGINT)
"""
"""Begins a program that is interrupted while it looks for a module: ``sys.meta_path.insert(0, Interrupts(module))``."""


def interrupted_at(call: int, function: Callable[..., Any]) -> Callable[..., Any]:
    """The same function, or method, interrupted in its ``call``-th call; ``calls`` of it are counted."""

    def watched(*given: Any, **named: Any) -> Any:
        watched.calls += 1
        if watched.calls == call:
            raise KeyboardInterrupt
        return function(*given, **named)

    watched.calls = 0
    return watched
