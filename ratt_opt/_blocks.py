"""Long loops in parts of some milliseconds, so that the clock is looked at in between and arrays stay in cache."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterator

__all__ = ["blocks"]

STEPS = 1 << 22
"""Multiplications or comparisons of numbers in a part: some milliseconds."""


def blocks(count: int, each: int, steps: int | None = None) -> Iterator[tuple[int, int]]:
    """First and last item (exclusive) of each part of a loop over ``count`` items that take ``each`` steps.

    ``steps`` : of a part, ``STEPS`` by default
    """
    size = max((STEPS if steps is None else steps) // max(each, 1), 1)
    for first in range(0, count, size):
        yield first, min(first + size, count)
