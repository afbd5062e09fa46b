"""Worker processes: whatever they were at when they ended, those who started them end too."""

import subprocess
import sys
import time
from pathlib import Path

from ratt_opt.running.processes import local_processes

ROOT = Path(__file__).parents[2]
SECONDS = 60.0
LARGE = 10_000_000
"""Bytes of a call, more than a pipe takes at once."""


def nap(_payload: bytes) -> None:
    """A call that is at something."""
    time.sleep(SECONDS)


def leave_while_sending() -> None:
    """A block is left by an exception."""
    with local_processes(1) as pool:
        for _ in range(4):
            pool.submit(nap, bytes(LARGE))
        time.sleep(1.0)
        raise SystemExit(0)


def test_ending_while_a_call_is_sent() -> None:
    # Of its own process, as what may wait for ever is the interpreter's exit too (it did, in Python 3.11.2).
    begin = "from tests.running.test_processes import leave_while_sending"
    program = f"{begin}\nif __name__ == '__main__':\n    leave_while_sending()"
    subprocess.run([sys.executable, "-c", program], cwd=ROOT, check=True, timeout=SECONDS - 10.0)
