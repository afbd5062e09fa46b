"""Worker processes: whatever they were at when they ended, those who started them end too."""

from __future__ import annotations

import os
import subprocess
import sys
import time
from pathlib import Path

import pytest

from ratt_opt.running.processes import SeparateProcesses, local_processes

ROOT = Path(__file__).parents[2]
SECONDS = 60.0
LARGE = 10_000_000
"""Bytes of a call, more than a pipe takes at once."""


def nap(_payload: bytes) -> None:
    """A call that is at something."""
    time.sleep(SECONDS)


def vanish(_payload: bytes) -> None:
    """A call whose process dies while the next one is being sent to it."""
    time.sleep(1.0)
    os._exit(1)


def shut_down_while_sending() -> None:
    """Processes are ended by those who started them."""
    pool = SeparateProcesses(1)
    for _ in range(4):
        pool.submit(nap, bytes(LARGE))
    time.sleep(1.0)
    pool.shutdown()


def lose_while_sending() -> None:
    """A process is lost, and another one takes its place."""
    pool = SeparateProcesses(1)
    lost = [pool.submit(call, bytes(LARGE)) for call in (vanish, nap, nap)]
    assert all(future.exception() is not None for future in lost)
    assert pool.submit(len, b"123").result() == 3
    pool.shutdown()


def leave_while_sending() -> None:
    """A block is left by an exception."""
    with local_processes(1) as pool:
        for _ in range(4):
            pool.submit(nap, bytes(LARGE))
        time.sleep(1.0)
        raise SystemExit(0)


@pytest.mark.parametrize("ending", ["shut_down_while_sending", "lose_while_sending", "leave_while_sending"])
def test_ending_while_a_call_is_sent(ending: str) -> None:
    # Of its own process, as what may wait for ever is the interpreter's exit too (it did, in Python 3.11.2).
    program = f"from tests.running.test_processes import {ending}\nif __name__ == '__main__':\n    {ending}()"
    subprocess.run([sys.executable, "-c", program], cwd=ROOT, check=True, timeout=SECONDS - 10.0)
