"""A limit on the processor's seconds, for searches that must end by themselves."""

import signal
from collections.abc import Iterator
from contextlib import contextmanager

import pytest

__all__ = ["NotBackError", "ends_within"]


class NotBackError(BaseException):
    """The search did not end; no search catches it."""


@contextmanager
def ends_within(seconds: float) -> Iterator[None]:
    """Fail if what is done inside takes more seconds of the processor, which other work does not stretch.

    Raises
    ------
    NotBackError : it took more.
    """
    if not hasattr(signal, "setitimer"):
        pytest.skip("needs a timer of processor seconds")

    def bark(*_: object) -> None:
        raise NotBackError(f"not back after {seconds} s of the processor")

    before = signal.signal(signal.SIGPROF, bark)
    signal.setitimer(signal.ITIMER_PROF, seconds)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_PROF, 0.0)
        signal.signal(signal.SIGPROF, before)
