"""Limits that count seconds of the processor, for every benchmark."""

import time

__all__ = ["count_processor_time"]


def count_processor_time() -> None:
    """Let every limit in this process count processor seconds, which other work on the machine does not stretch.

    To be called before the package loads what reads the clock.
    """
    time.monotonic = time.process_time
