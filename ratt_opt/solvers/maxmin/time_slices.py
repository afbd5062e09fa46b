"""Time slices and turns of searches for the upper bound; between them the best plan is proved, or another one runs."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from ratt_opt.budget import Stop

if TYPE_CHECKING:
    from collections.abc import Callable

    from ratt_opt.budget import Budget
    from ratt_opt.solvers.maxmin.incumbent import Incumbent

    Progress = Callable[[int, float, float], None] | None

__all__ = ["TimeSlices", "TimeSlicesUntil", "Turn"]


class TimeSlices:
    """Clock of a search: it stops for good, or to prove the best plan's value."""

    def __init__(self, budget: Budget, incumbent: Incumbent) -> None:
        self.budget, self.incumbent = budget, incumbent
        self._slice = budget.part(incumbent.params.incumbent.searched)

    @property
    def seconds_left(self) -> float:
        """Seconds until it is time to stop, as far as that is known."""
        left = self.budget.seconds_left
        return left if self.incumbent.is_proved else min(left, self._slice.seconds_left)

    def stop(self) -> Stop | None:
        """Return the reason to stop searching now, if there is one."""
        if (stop := self.budget.stop()) not in {None, Stop.NODES}:
            return stop
        return Stop.TIME if self._slice.stop() is Stop.TIME and not self.incumbent.is_proved else None

    def stop_within_node(self) -> Stop | None:
        """Return the reason to stop within a node; a limit of nodes is none."""
        stop = self.stop()
        return None if stop is Stop.NODES else stop

    def begin_turn(self) -> None:
        """Begin the next slice."""
        self._slice = self.budget.part(self.incumbent.params.incumbent.searched)


class TimeSlicesUntil(TimeSlices):
    """Time slices of a search that also stops, as at a limit of nodes, when ``is_enough`` holds."""

    def __init__(self, slices: TimeSlices, is_enough: Callable[[], bool]) -> None:
        self.budget, self.incumbent, self._slices, self._is_enough = slices.budget, slices.incumbent, slices, is_enough

    @property
    def seconds_left(self) -> float:
        """Seconds left to the slices themselves."""
        return self._slices.seconds_left

    def stop(self) -> Stop | None:
        """Return the reason to stop searching now, if there is one."""
        return self._slices.stop() or (Stop.NODES if self._is_enough() else None)


@dataclass(frozen=True, slots=True, kw_only=True)
class Turn:
    """One turn of a search: ``nodes`` that it may spend, within ``slices``, which say when to stop.

    ``upper`` : proved by all searches so far; infinite if there are no others
    ``progress`` : called as ``progress(nodes, lower, upper)``
    """

    slices: TimeSlices
    progress: Progress
    upper: float
    nodes: float
