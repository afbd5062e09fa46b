"""The same sweep on a real Dask scheduler: the same bytes, also when a worker is killed in the middle."""

from __future__ import annotations

import os
import subprocess
import sys
import time
from contextlib import ExitStack, contextmanager
from pathlib import Path
from typing import TYPE_CHECKING

import pytest

from analysis.paper.small_scale import STUDY as SMALL
from analysis.studies.engine import run
from analysis.studies.executors import open_executor
from analysis.studies.progress import Progress
from ratt_opt import InputError
from tests.studies.toy import STUDY

if TYPE_CHECKING:
    from collections.abc import Iterator

distributed = pytest.importorskip("distributed", reason="the extra 'cluster' is not installed")

ROOT = Path(__file__).resolve().parents[2]


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
def _scheduler(folder: Path) -> Iterator[str]:
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
        until = time.monotonic() + 30
        while not address.exists() and time.monotonic() < until:
            time.sleep(0.05)
        import json

        yield json.loads(address.read_text())["address"]


def _worker(address: str, folder: Path, *, path: str = str(ROOT), seconds: float = 0.0) -> object:
    arguments = ("dask_worker", address, "--no-nanny", "--nthreads", "1", "--no-dashboard")
    return _process(*arguments, path=path, folder=folder, seconds=seconds)


def test_a_killed_worker_changes_nothing(tmp_path: Path) -> None:
    with open_executor(None, 1) as executor:
        expected = run(STUDY, tmp_path / "local", executor, trials=10, progress=Progress()).read_bytes()
    with ExitStack() as stack:
        address = stack.enter_context(_scheduler(tmp_path))
        first = stack.enter_context(_worker(address, tmp_path, seconds=0.1))
        stack.enter_context(_worker(address, tmp_path, seconds=0.1))
        with distributed.Client(address) as client:
            client.wait_for_workers(2, timeout=30)
        rows = 0

        class Killing(Progress):
            @contextmanager
            def task(self, name: str, *, total: int, done: int) -> Iterator[object]:
                def counting() -> None:
                    nonlocal rows
                    rows += 1
                    if rows == total // 5:
                        first.kill()
                    advance()

                with super().task(name, total=total, done=done) as advance:
                    yield counting

        with open_executor(address, None) as executor:
            table = run(STUDY, tmp_path / "dask", executor, trials=10, progress=Killing())
        assert first.wait(10) != 0
    assert rows == 40
    assert table.read_bytes() == expected


def test_the_papers_rows_are_the_same_bytes_on_a_cluster(tmp_path: Path) -> None:
    with open_executor(None, 1) as executor:
        expected = run(SMALL, tmp_path / "local", executor, trials=1, progress=Progress()).read_bytes()
    with ExitStack() as stack:
        address = stack.enter_context(_scheduler(tmp_path))
        stack.enter_context(_worker(address, tmp_path))
        with open_executor(address, None) as executor:
            table = run(SMALL, tmp_path / "dask", executor, trials=1, progress=Progress())
    assert table.read_bytes() == expected


def test_a_lost_scheduler_is_one_line_and_the_sweep_resumes(tmp_path: Path) -> None:
    with ExitStack() as stack:
        scheduler = stack.enter_context(ExitStack())
        address = scheduler.enter_context(_scheduler(tmp_path))
        stack.enter_context(_worker(address, tmp_path, seconds=0.1))
        command = [sys.executable, "-m", "tests.studies.run_toy", "--out", str(tmp_path / "out"), "--trials", "100"]
        process = stack.enter_context(
            subprocess.Popen([*command, "--cluster", address], cwd=ROOT, text=True, stderr=subprocess.PIPE)
        )
        journal = tmp_path / "out" / "toy" / "journal.csv"
        until = time.monotonic() + 60
        while (not journal.exists() or not journal.stat().st_size) and time.monotonic() < until:
            time.sleep(0.05)
        scheduler.close()
        errors = process.communicate(timeout=60)[1]
    assert process.returncode == 1
    again = "finished rows are kept, run the same command to resume"
    assert errors.splitlines() == [f"error: the cluster dropped the trials; {again}"]
    with open_executor(None, 1) as executor:
        table = run(STUDY, tmp_path / "out" / "toy", executor, trials=100, progress=Progress())
    assert len(table.read_text().splitlines()) == 401


def test_a_worker_without_the_package_is_one_line(tmp_path: Path) -> None:
    with ExitStack() as stack:
        address = stack.enter_context(_scheduler(tmp_path))
        stack.enter_context(_worker(address, tmp_path, path=""))
        with pytest.raises(InputError, match=r"worker tcp\S+ must import the same package .*; got ModuleNotFoundError"):
            stack.enter_context(open_executor(address, None))


def test_unreachable_cluster_exits_2_with_one_line(tmp_path: Path) -> None:
    command = [sys.executable, "-m", "tests.studies.run_toy", "--out", str(tmp_path), "--cluster", "tcp://127.0.0.1:9"]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=False)
    assert done.returncode == 2
    text = "error: cluster must be the address of a Dask scheduler that answers within 10 s; got tcp://127.0.0.1:9"
    assert done.stderr.splitlines() == [text]
    assert list(tmp_path.iterdir()) == []
