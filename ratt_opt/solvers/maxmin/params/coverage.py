"""Parameters of coverage as a trace."""

from __future__ import annotations

from dataclasses import dataclass

__all__ = ["CoverageParams"]


@dataclass(frozen=True, slots=True, kw_only=True)
class CoverageParams:
    """Numbers of the trace that stands for coverage.

    ``information`` : of an element that covers an item; more leaves less between both values, and linear programs worse
        scaled: with 1e8 ten robots did not close in a minute, with 1e6 in eight seconds
    ``most_entries`` : elements times items; beyond it the trace takes too much memory and time
    ``share`` : of the seconds left, for the search of the trace; ``nodes`` : of it, if nothing is limited
    """

    information: float = 2.0**20
    most_entries: int = 200_000
    share: float = 0.8
    nodes: int = 1_000
