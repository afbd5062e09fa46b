"""Rows measured by worker processes whose limits count seconds of the processor."""

import os
import sys
from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import ProcessPoolExecutor, as_completed
from multiprocessing import get_context
from typing import Any

from analysis.benchmarks.timing import count_processor_time

__all__ = ["in_workers"]

THREADS = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS")


def in_workers(
    function: Callable[..., dict[str, Any]], asked: Iterable[tuple[Any, ...]], workers: int | None
) -> Iterator[dict[str, Any]]:
    """Yield ``function(*arguments)`` for all ``asked`` as they end; if one is interrupted, the rest is left out.

    A main module that uses this must not load the package before: its workers import it again, and limits count
    processor seconds only if they do from the start.
    """
    os.environ |= dict.fromkeys(THREADS, "1")
    with ProcessPoolExecutor(workers, get_context("spawn"), initializer=count_processor_time) as pool:
        calls = [pool.submit(function, *arguments) for arguments in asked]
        try:
            for k, done in enumerate(as_completed(calls), 1):
                row = done.result()
                if sys.stderr.isatty():
                    print(f"\r{k} of {len(calls)}: {row['part']}, {row['case']}", end="\x1b[K", file=sys.stderr)
                yield row
        finally:
            pool.shutdown(wait=False, cancel_futures=True)
