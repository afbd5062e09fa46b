"""One way to time things, shared by every benchmark."""

from __future__ import annotations

import time
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Callable

__all__ = ["best_seconds"]


def best_seconds(run: Callable[[], object], repeats: int = 5) -> float:
    """Return the smallest wall time of ``repeats`` runs after one that is not counted [s]."""
    run()
    times = []
    for _ in range(repeats):
        began = time.perf_counter()
        run()
        times.append(time.perf_counter() - began)
    return min(times)
