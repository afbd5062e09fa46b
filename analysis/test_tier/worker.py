"""Runs chosen tests in forks of a process that has imported what all of them need; a program, not a module.

``python analysis/test_tier/worker.py FOLDER`` in the tree to be tested. A line of its input is a request, ``{"tests":
{function: seconds}}``. It prints a line for each: how it ended, at which test, and the processor's seconds.
"""

from __future__ import annotations

import importlib
import json
import os
import signal
import sys
import time
from contextlib import suppress
from typing import Any

import pytest

OPTIONS = (
    "-q",
    "-x",
    "--import-mode=importlib",
    "-m",
    "not slow",
    "--tb=line",
    "-p",
    "no:cacheprovider",
    "-p",
    "no:faulthandler",
)
INI = "addopts="
IMPORTED = (
    *("cvxpy", "distributed", "highspy", "matplotlib.pyplot", "networkx", "numba", "pandas", "pydantic"),
    *("scipy.optimize", "stonesoup.platform", "typer"),
)
"""What the tests import and no fault changes; without Hypothesis, whose plug-in must come after pytest."""
TOO_LONG = 77
"""Exit code of a run in which a test took too long."""


class Chosen:
    """Keeps the chosen functions, in the given order, and ends a run if one takes too long."""

    def __init__(self, limits: dict[str, float], cases: dict[str, int], note: Any) -> None:
        self._cases = cases
        self._limits = limits
        self._left = dict(limits)
        self._note = note

    @pytest.hookimpl(trylast=True)
    def pytest_collection_modifyitems(self, config: Any, items: list[Any]) -> None:
        """By file in the given order, since tests of a file share fixtures."""
        place = {file: i for i, file in reversed(list(enumerate(name.partition("::")[0] for name in self._limits)))}
        of_function: dict[str, list[Any]] = {}
        for item in items:
            of_function.setdefault(_function(item), []).append(item)
        kept = [item for name, all_of in of_function.items() for item in self._some(name, all_of)]
        staying = set(kept)
        config.hook.pytest_deselected(items=[item for item in items if item not in staying])
        items[:] = sorted(kept, key=lambda item: place[_function(item).partition("::")[0]])

    def _some(self, name: str, items: list[Any]) -> list[Any]:
        """Cases as tests/conftest.py chooses them."""
        if name not in self._limits:
            return []
        n = min(self._cases.get(name, len(items)), len(items))
        return [items[i * len(items) // n] for i in range(n)]

    def pytest_runtest_logstart(self, nodeid: str) -> None:
        """Set the clock."""
        self._note.seek(0)
        self._note.truncate()
        self._note.write(nodeid)
        self._note.flush()
        self._began = time.monotonic()
        signal.signal(signal.SIGALRM, signal.SIG_DFL)  # which ends the process, whatever it does
        signal.setitimer(signal.ITIMER_REAL, max(self._left[nodeid.partition("[")[0]], 5.0))

    def pytest_runtest_logfinish(self, nodeid: str) -> None:
        """Stop the clock."""
        signal.setitimer(signal.ITIMER_REAL, 0)
        self._left[nodeid.partition("[")[0]] -= time.monotonic() - self._began

    def pytest_runtest_logreport(self, report: Any) -> None:
        """Note what fails."""
        if report.failed:
            print("FAILED", report.nodeid, flush=True)


def _function(item: Any) -> str:
    return str(item.nodeid.partition("[")[0])


def _child(request: dict[str, Any], note: Any, log: int) -> int:
    os.setsid()
    os.dup2(log, 1)
    os.dup2(log, 2)
    limits = request["tests"]
    sys.argv = ["pytest"]
    files = list(dict.fromkeys(name.partition("::")[0] for name in limits))
    options = [option for option in OPTIONS if option != "-x" or not request.get("all")]
    return int(pytest.main([*options, "-o", INI, *files], plugins=[Chosen(limits, request["cases"], note)]))


def _ended(status: int) -> str:
    if os.WIFSIGNALED(status):
        return "too long" if os.WTERMSIG(status) == signal.SIGALRM else "crashed"
    code = os.WEXITSTATUS(status)
    return {0: "passed", 1: "failed", 5: "no tests"}.get(code, "broken")


def run(request: dict[str, Any], folder: str) -> dict[str, Any]:
    """Fork, run, wait."""
    note_path, log_path = f"{folder}/now.txt", f"{folder}/worker.log"
    with open(note_path, "w", encoding="utf-8") as note, open(log_path, "wb") as log:
        child = os.fork()
        if child == 0:
            code = 3
            try:
                code = _child(request, note, log.fileno())
            finally:
                sys.stdout.flush()
                os._exit(code)
        _, status, used = os.wait4(child, 0)
        with suppress(ProcessLookupError):
            os.killpg(child, signal.SIGKILL)
    with open(note_path, encoding="utf-8") as note:
        last = note.read()
    with open(log_path, encoding="utf-8", errors="replace") as log_text:
        failed = [line.split()[1] for line in log_text if line.startswith("FAILED ") or " FAILED tests/" in line]
    return {
        "ended": _ended(status),
        "test": failed[0] if failed else last,
        "failed": failed,
        "seconds": used.ru_utime + used.ru_stime,
    }


def main() -> None:
    """Answer requests until there are none."""
    sys.path[0] = os.getcwd()
    for name in IMPORTED:
        with suppress(ImportError):
            importlib.import_module(name)
    for line in sys.stdin:
        print(json.dumps(run(json.loads(line), sys.argv[1])), flush=True)


if __name__ == "__main__":
    main()
