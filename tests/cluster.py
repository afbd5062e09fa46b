"""A Dask scheduler and its workers as processes of their own, on this machine."""

import json
import os
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path

import pytest

from tests.documents import ROOT

distributed = pytest.importorskip("distributed", reason="the extra 'cluster' is not installed")

SLOW = 120
"""Seconds that a loaded machine may take for what an idle one does in two."""


@contextmanager
def _process(*arguments: str, path: str, folder: Path, seconds: float = 0.0) -> Iterator[subprocess.Popen[str]]:
    environment = os.environ | {"PYTHONPATH": path, "TOY_SECONDS": str(seconds), "OMP_NUM_THREADS": "1"}
    command = [sys.executable, "-m", "distributed.cli." + arguments[0], *arguments[1:]]
    process = subprocess.Popen(
        command, env=environment, cwd=folder, text=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL
    )
    try:
        yield process
    finally:
        process.kill()
        process.wait()


@contextmanager
def scheduler(folder: Path) -> Iterator[str]:
    """A scheduler on a free port; its address."""
    address = folder / "scheduler.json"
    arguments = (
        "dask_scheduler",
        "--host",
        "127.0.0.1",
        "--port",
        "0",
        "--no-dashboard",
        "--scheduler-file",
        str(address),
    )
    with _process(*arguments, path=str(ROOT), folder=folder):
        wait_for(lambda: _address(address) is not None)
        yield str(_address(address))


def _address(file: Path) -> str | None:
    """The scheduler's address, or nothing while its file is missing or half written."""
    try:
        return str(json.loads(file.read_text())["address"])
    except (OSError, ValueError):
        return None


def wait_for(condition: Callable[[], bool]) -> None:
    """Wait as long as a loaded machine may need; fail rather than go on without it."""
    until = time.monotonic() + SLOW
    while not condition():
        assert time.monotonic() < until
        time.sleep(0.05)


@contextmanager
def workers(
    n: int, address: str, folder: Path, *, path: str = str(ROOT), seconds: float = 0.0, before: int = 0
) -> Iterator[list[subprocess.Popen[str]]]:
    """``n`` workers that have all reported to the scheduler, where ``before`` others had."""
    arguments = ("dask_worker", address, "--no-nanny", "--nthreads", "1", "--no-dashboard")
    with ExitStack() as stack:
        processes = [
            stack.enter_context(_process(*arguments, path=path, folder=folder, seconds=seconds)) for _ in range(n)
        ]
        with distributed.Client(address, timeout=SLOW, set_as_default=False) as client:
            client.wait_for_workers(before + n, timeout=SLOW)
        yield processes
