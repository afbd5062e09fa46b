"""Limits of the verifier: what one file may ask of it before it is refused, or counts as undecided."""

from __future__ import annotations

from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from ratt_opt.errors import InputError

if TYPE_CHECKING:
    from collections.abc import Iterator

__all__ = ["DEFAULT", "SECONDS", "MatrixCost", "VerifierLimits", "limits", "within"]


SECONDS = 600.0
"""Seconds for one file unless the caller says otherwise (``time_limit``); proofs for 30 robots take seconds."""


@dataclass(frozen=True, slots=True, kw_only=True)
class MatrixCost:
    """Time of one exact operation on a matrix.

    ``seconds`` : for each of ``d^4 * bits``, an upper estimate (measured: 4e-11 to 2e-8). A larger one refuses more
    files at the end of their time; a smaller one lets the limit be overrun.
    ``short`` : seconds below which an operation is not estimated at all; the estimate takes time, too.
    ``widest`` : largest ``d^4 * bits`` of a matrix; an exact inverse takes 4.6 s at d = 30 and 300 bits
    """

    seconds: float = 2e-8
    short: float = 0.1
    widest: int = 2**28


@dataclass(frozen=True, slots=True, kw_only=True)
class VerifierLimits:
    """Limits of the work on one file, which a stranger may have written: larger ones decide more, and take longer.

    They decide if a file is decided, never what is proved.

    ``bits`` : of exact numbers held at once (1 GiB)
    ``file`` : size of a file [bytes]; ``entries`` : of all its lists together; ``cells`` : scores of points, directions
    of tangents, robots in attacks; ``depth`` : of a tree. Together they bound the memory of a check
    ``robots`` : of a team; ``sized_robots`` : of a team whose proof counts sizes of groups: a characteristic polynomial
    of 200 rows takes less than a second, one of 1,000 minutes
    ``terms`` : scores that all linear rows add up (seconds); ``scores`` : of rows, in memory at once (half a gigabyte)
    ``listed`` : groups that a cover lists; ``cut_groups`` : those of a certificate of cuts
    ``states`` : of a table of an elimination
    ``cut_numbers``, ``dual_numbers``, ``size_numbers`` : integers that a file states of a network, of duals and flows,
    and of sizes: larger ones take longer to add and to multiply
    ``precisions`` : of balls [bits], in turn; a comparison undecided at the last is not proved. The first decides
    nearly all of them
    ``block`` : points scored, or targets below one logarithm, between two looks at the clock: fewer stop sooner
    ``told`` : cases of a proof between two words about it; a tenth of a second or so if each is long
    ``matrix`` : cost of one operation on a matrix
    """

    bits: int = 2**33
    file: int = 32 * 2**20
    entries: int = 2_000_000
    cells: int = 1_000_000
    depth: int = 2500
    robots: int = 1000
    sized_robots: int = 200
    terms: int = 20_000_000
    scores: int = 4_000_000
    listed: int = 250_000
    cut_groups: int = 300_000
    states: int = 300_000
    cut_numbers: int = 2**62
    dual_numbers: int = 2**53
    size_numbers: int = 2**31
    precisions: tuple[int, ...] = (128, 1024)
    block: int = 16
    told: int = 100
    matrix: MatrixCost = field(default_factory=MatrixCost)

    def __post_init__(self) -> None:
        """Check what nothing could be decided with. ``InputError`` : it is less than 1, or there is no precision."""
        for name in ("block", "told"):
            if not (value := getattr(self, name)) >= 1:
                raise InputError(f"limits.{name}", "must be at least 1", value)
        if not self.precisions or not min(self.precisions) >= 2:
            raise InputError("limits.precisions", "must hold numbers of bits, of at least 2", self.precisions)


DEFAULT = VerifierLimits()
"""Limits of checks that are not given any."""
_CURRENT: ContextVar[VerifierLimits] = ContextVar("ratt_opt_verifier_limits", default=DEFAULT)


def limits() -> VerifierLimits:
    """Return the limits of the check that runs."""
    return _CURRENT.get()


@contextmanager
def within(given: VerifierLimits | None) -> Iterator[VerifierLimits]:
    """Check what is inside the block within these limits; within those around it if none are given."""
    chosen = limits() if given is None else given
    token = _CURRENT.set(chosen)
    try:
        yield chosen
    finally:
        _CURRENT.reset(token)
