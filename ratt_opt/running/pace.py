"""Work between two looks at the clock: learned, as its speed depends on the data and the machine."""

from __future__ import annotations

from contextlib import contextmanager
from dataclasses import dataclass
from time import monotonic
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterator

__all__ = ["Pace", "PaceParams"]


@dataclass(frozen=True, slots=True, kw_only=True)
class PaceParams:
    """Limits of a pace.

    ``seconds`` : of the work between two looks [s]: a limit or an interrupt is met that late; less costs more calls
    ``first``, ``most`` : units of work at first, and at most
    """

    seconds: float = 0.02
    first: int = 1
    most: int = 2**14


class Pace:
    """Units of work for the next call, so that it takes about the seconds asked for."""

    def __init__(self, params: PaceParams) -> None:
        self._params, self.units = params, params.first

    @contextmanager
    def timed(self, units: int) -> Iterator[None]:
        """Time the work inside; the next call gets half of its ``units`` if it took too long, or twice as many."""
        began = monotonic()
        yield
        seconds = monotonic() - began
        if seconds > self._params.seconds:
            self.units = max(self.units // 2, 1)
        elif units == self.units and 2 * seconds < self._params.seconds:
            self.units = min(2 * self.units, self._params.most)
