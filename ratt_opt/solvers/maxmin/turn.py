"""One turn of a search for the upper end."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Callable

    from ratt_opt.solvers.maxmin.time_slices import TimeSlices

    Progress = Callable[[int, float, float], None] | None

__all__ = ["Turn"]


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
