"""One way to time things, shared by every benchmark."""

from __future__ import annotations

import time
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Callable

__all__ = ["best_seconds", "count_processor_time"]


def best_seconds(run: Callable[[], object], repeats: int = 5, clock: Callable[[], float] = time.perf_counter) -> float:
    """Return the smallest time of ``repeats`` runs after one that is not counted [s]; wall time by default."""
    run()
    times = []
    for _ in range(repeats):
        began = clock()
        run()
        times.append(clock() - began)
    return min(times)


def count_processor_time() -> None:
    """Let every limit in this process count processor seconds, which other work on the machine does not stretch.

    To be called before the package loads what reads the clock.
    """
    time.monotonic = time.process_time
