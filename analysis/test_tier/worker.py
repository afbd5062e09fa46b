"""Runs chosen tests in forks of a process that has imported what all of them need; a program, not a module.

``python analysis/test_tier/worker.py FOLDER`` in the tree to be tested. A line of its input is a request, ``[{function:
seconds}, {function: cases}]``. It answers each with a line, ``[how it ended, the last test]``.
"""

import importlib
import json
import os
import signal
import sys
import time
from contextlib import suppress
from typing import TextIO

import pytest

OPTIONS = ("-qx", "-oaddopts=", "--import-mode=importlib", "--tb=line", "-pno:cacheprovider", "-pno:faulthandler")
IMPORTED = (
    *("cvxpy", "distributed", "highspy", "matplotlib.pyplot", "networkx", "pandas", "pydantic"),
    *("scipy.optimize", "stonesoup.platform", "typer"),
)
"""Modules that the tests import and no fault changes; without Hypothesis, whose plug-in must come after pytest."""
ENDS = {0: "passed", 1: "failed", 5: "no tests", -signal.SIGALRM: "too long"}
LEAST = 5.0
"""Seconds that every test has."""


class Chosen:
    """Plug-in that keeps the chosen functions, in the given order, and ends the process if one takes too long."""

    def __init__(self, limits: dict[str, float], cases: dict[str, int], note: TextIO) -> None:
        self._left = dict(limits)
        self._cases = cases
        self._note = note

    @pytest.hookimpl(trylast=True)
    def pytest_collection_modifyitems(self, items: list[pytest.Item]) -> None:
        """Order tests by file, as tests of a file share fixtures; choose cases as tests/conftest.py does."""
        of_function: dict[str, list[pytest.Item]] = {name: [] for name in self._left}
        for item in items:
            of_function.get(_function(item.nodeid), []).append(item)
        kept = []
        for name, every in of_function.items():
            n = min(self._cases.get(name, len(every)), len(every))
            kept += [every[i * len(every) // n] for i in range(n)]
        files = list(dict.fromkeys(item.path for item in kept))
        items[:] = sorted(kept, key=lambda item: files.index(item.path))

    def pytest_runtest_logstart(self, nodeid: str) -> None:
        """Set the clock."""
        self._note.seek(0)
        self._note.truncate()
        self._note.write(nodeid)
        self._note.flush()
        self._began = time.monotonic()
        signal.signal(signal.SIGALRM, signal.SIG_DFL)  # which ends the process, whatever it does
        signal.setitimer(signal.ITIMER_REAL, max(self._left[_function(nodeid)], LEAST))

    def pytest_runtest_logfinish(self, nodeid: str) -> None:
        """Stop the clock."""
        signal.setitimer(signal.ITIMER_REAL, 0)
        self._left[_function(nodeid)] -= time.monotonic() - self._began


def _function(nodeid: str) -> str:
    return nodeid.partition("[")[0]


def _child(limits: dict[str, float], cases: dict[str, int], note: TextIO, log: int) -> int:
    os.setsid()
    os.dup2(log, 1)
    os.dup2(log, 2)
    sys.argv = ["pytest"]
    files = dict.fromkeys(name.partition("::")[0] for name in limits)
    return int(pytest.main([*OPTIONS, "-m", "not slow", *files], plugins=[Chosen(limits, cases, note)]))


def run(limits: dict[str, float], cases: dict[str, int], folder: str) -> tuple[str, str]:
    """Fork, run, wait."""
    with open(f"{folder}/now.txt", "w+", encoding="utf-8") as note, open(f"{folder}/worker.log", "wb") as log:
        child = os.fork()
        if child == 0:
            code = 3
            try:
                code = _child(limits, cases, note, log.fileno())
            finally:
                sys.stdout.flush()
                os._exit(code)
        _, status = os.waitpid(child, 0)
        with suppress(ProcessLookupError):
            os.killpg(child, signal.SIGKILL)
        note.seek(0)
        code = os.waitstatus_to_exitcode(status)
        return ENDS.get(code, "crashed" if code < 0 else "broken"), note.read()


def main() -> None:
    """Answer requests until there are none."""
    sys.path[0] = os.getcwd()
    for name in IMPORTED:
        with suppress(ImportError):
            importlib.import_module(name)
    for line in sys.stdin:
        limits, cases = json.loads(line)
        print(json.dumps(run(limits, cases, sys.argv[1])), flush=True)


if __name__ == "__main__":
    main()
