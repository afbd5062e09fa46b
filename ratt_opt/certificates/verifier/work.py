"""Limits of the verifier's work on one file, beyond which the file is not decided.

A certificate comes from strangers: a short file can state numbers, matrices or trees that take days. The limits
are asked between single operations, each of which is short because wide matrices are refused first.
"""

from __future__ import annotations

from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import dataclass
from math import inf
from time import monotonic
from typing import TYPE_CHECKING

from ratt_opt.certificates.verifier.limits import limits
from ratt_opt.errors import UndecidedError

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator

    from flint import fmpq, fmpq_mat, fmpz_mat

__all__ = [
    "afford",
    "hold",
    "limited",
    "refuse_wide",
    "seconds_left",
    "tell",
    "tick",
    "watched",
]

BITS_OF_A_FLOAT = 2200
"""Numerator and common denominator of the widest range that binary64 floats can have, in bits."""


@dataclass(slots=True)
class _Work:
    ends: float
    limit: float
    bits: int = 0


_CURRENT: ContextVar[_Work | None] = ContextVar("ratt_opt_verifier_work", default=None)
_WATCHER: ContextVar[Callable[[str], None] | None] = ContextVar("ratt_opt_verifier_watcher", default=None)


@contextmanager
def watched(say: Callable[[str], None]) -> Iterator[None]:
    """Report the progress of checks and covers inside the block by ``say``."""
    token = _WATCHER.set(say)
    try:
        yield
    finally:
        _WATCHER.reset(token)


def tell(doing: str, done: int, whole: int | None = None) -> None:
    """Say how many cases are done, of how many where that is known; cheap enough for every case."""
    if done % limits().told == 0 and (say := _WATCHER.get()) is not None:
        say(f"{doing}, {done:,} cases" if whole is None else f"{doing}, {done:,} of {whole:,} cases")


@contextmanager
def limited(seconds: float) -> Iterator[None]:
    """Limit what is checked inside the block; outside of one there is no limit (when a proof is being written)."""
    token = _CURRENT.set(_Work(monotonic() + seconds, seconds))
    try:
        yield
    finally:
        _CURRENT.reset(token)


def seconds_left() -> float:
    """Seconds that are left of the block that limits what is checked; infinite outside of one."""
    work = _CURRENT.get()
    return inf if work is None else max(work.ends - monotonic(), 0.0)


def tick() -> None:
    """Raise :class:`UndecidedError` when the time is up."""
    work = _CURRENT.get()
    if work is not None and monotonic() > work.ends:
        raise UndecidedError(f"not decided within {work.limit:.2g} s" if work.limit > 0 else "no time was left for it")


def hold(number: fmpq, count: int = 1) -> None:
    """Count the bits of ``count`` numbers like this one that stay in memory."""
    work = _CURRENT.get()
    if work is None:
        return
    work.bits += count * (int(number.p).bit_length() + int(number.q).bit_length())
    if work.bits > (most := limits().bits):
        raise UndecidedError(f"not decided within {most // 2**23} MiB of exact numbers")


def afford(matrix: fmpq_mat | fmpz_mat) -> None:
    """Raise :class:`UndecidedError` if one inverse, determinant or polynomial of a matrix outlasts the time left.

    Nothing looks at the clock inside such an operation, so its time is estimated before.
    """
    tick()
    work, d, cost = _CURRENT.get(), matrix.nrows(), limits().matrix
    if work is None or d**4 * BITS_OF_A_FLOAT * cost.seconds <= cost.short:
        return
    whole, unit = matrix.numer_denom() if hasattr(matrix, "numer_denom") else (matrix, 1)
    bits = max(int(x).bit_length() for x in whole.entries()) + int(unit).bit_length()
    if d**4 * bits * cost.seconds > work.ends - monotonic():
        raise UndecidedError(f"not decided within {work.limit:.2g} s: a matrix of {d} rows has numbers of {bits} bits")


def refuse_wide(matrices: Iterable[fmpq_mat], d: int) -> None:
    """Raise :class:`UndecidedError` if a single operation on one of the matrices would take too long."""
    widest = limits().matrix.widest
    if d**4 * BITS_OF_A_FLOAT <= widest:
        return
    for matrix in matrices:
        tick()
        sizes = [(int(x.p).bit_length(), int(x.q).bit_length()) for x in matrix.entries()]
        bits = max(p for p, _ in sizes) + max(q for _, q in sizes)
        if d**4 * bits > widest:
            raise UndecidedError(f"not decided: numbers of {bits} bits in matrices of {d} rows are too wide")
