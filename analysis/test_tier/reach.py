"""A pytest plug-in: processor seconds of every test function, and the lines that it reaches.

``python -m pytest --whole -p analysis.test_tier.reach`` writes ``costs.csv``; with ``TIER_REACH=1`` also the lines, by
coverage. Processes that a test starts are followed, too.
"""

from __future__ import annotations

import csv
import os
import resource
import sys
import time
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest

if TYPE_CHECKING:
    from collections.abc import Iterator

FOLDER = Path(os.environ.get("TIER_FOLDER", "build/test_tier")).absolute()
CONTEXT = "TIER_TEST"
"""Environment variable that tells processes which test started them."""
SETTINGS = """[run]
source_pkgs = ratt_opt, ratt_audit
parallel = true
data_file = {folder}/lines
context = ${{{context}-}}
disable_warnings = module-not-imported, no-data-collected, module-not-measured, module-not-python, already-imported
"""


def function_of(node: str) -> str:
    """The test function of a node: its name without parameters."""
    return node.partition("[")[0]


def _seconds() -> float:
    ended = resource.getrusage(resource.RUSAGE_CHILDREN)
    return time.process_time() + ended.ru_utime + ended.ru_stime


class Costs:
    """Adds up what every test function takes, and says to coverage which one runs."""

    def __init__(self, coverage: Any) -> None:
        self._coverage = coverage
        self._seconds: dict[str, float] = {}
        self._tests: dict[str, int] = {}
        self._compiling: dict[str, float] = {}
        self._fixtures: dict[str, float] = {}
        self._uses: dict[str, set[str]] = {}
        self._now = ""
        self._began = 0.0
        self._depth = 0

    def compiles(self) -> None:
        """Watch the compiler."""
        from numba.core import event

        costs = self

        class Watch(event.Listener):
            def on_start(self, event: object) -> None:
                del event
                costs._depth += 1
                if costs._depth == 1:
                    costs._began = time.process_time()

            def on_end(self, event: object) -> None:
                del event
                costs._depth -= 1
                if costs._depth == 0:
                    spent = time.process_time() - costs._began
                    costs._compiling[costs._now] = costs._compiling.get(costs._now, 0.0) + spent

        event.register("numba:compiler_lock", Watch())  # type: ignore[no-untyped-call]

    def _switch(self, context: str) -> None:
        os.environ[CONTEXT] = context
        if self._coverage is not None:
            if sys.gettrace() is None:  # a test has traced something itself
                self._coverage.stop()
                self._coverage.start()
            self._coverage.switch_context(context)

    @pytest.hookimpl(wrapper=True)
    def pytest_runtest_protocol(self, item: pytest.Item) -> Iterator[None]:
        """Say whose lines and seconds come now."""
        function = self._now = function_of(item.nodeid)
        self._switch(function)
        before = _seconds()
        try:
            return (yield)
        finally:
            self._uses.setdefault(function, set()).update(self._shared_by(item))
            self._seconds[function] = self._seconds.get(function, 0.0) + _seconds() - before
            self._tests[function] = self._tests.get(function, 0) + 1
            self._switch("")

    @pytest.hookimpl(wrapper=True)
    def pytest_fixture_setup(self, fixturedef: pytest.FixtureDef[Any]) -> Iterator[Any]:
        """What a shared fixture reaches counts for every test that may stand on it."""
        if fixturedef.scope == "function":
            return (yield)
        self._switch(f"{fixturedef.baseid}*")
        before = _seconds()
        try:
            return (yield)
        finally:
            taken, name = _seconds() - before, f"{fixturedef.baseid} {fixturedef.argname}"
            self._fixtures[name] = self._fixtures.get(name, 0.0) + taken
            self._seconds[self._now] = self._seconds.get(self._now, 0.0) - taken
            self._switch(self._now)

    def _shared_by(self, item: pytest.Item) -> set[str]:
        """The fixtures that a test shares with others."""
        names = set(getattr(item, "fixturenames", ()))
        places = ((shared, *shared.split(" ")) for shared in self._fixtures)
        return {shared for shared, base, own in places if own in names and item.nodeid.startswith(base)}

    def pytest_sessionfinish(self) -> None:
        """Write what was measured."""
        worker = os.environ.get("PYTEST_XDIST_WORKER", "")
        with (FOLDER / f"costs{worker}.csv").open("w", newline="", encoding="utf-8") as file:
            rows = csv.writer(file, lineterminator="\n")
            rows.writerow(("function", "tests", "seconds", "compiling", "shared"))
            for name in sorted(self._tests):
                seconds, compiling = self._seconds[name], self._compiling.get(name, 0.0)
                shared = sum(self._fixtures[one] for one in self._uses[name])
                rows.writerow((name, self._tests[name], *(f"{one:.3f}" for one in (seconds, compiling, shared))))
        if self._coverage is not None:
            self._coverage.stop()
            self._coverage.save()


def pytest_configure(config: pytest.Config) -> None:
    """Start to measure."""
    if "PYTEST_XDIST_WORKER" not in os.environ and getattr(config.option, "numprocesses", None):
        return
    FOLDER.mkdir(parents=True, exist_ok=True)
    coverage = None
    if os.environ.get("TIER_REACH"):
        from coverage import Coverage

        file = FOLDER / "coverage.ini"
        file.write_text(SETTINGS.format(folder=FOLDER, context=CONTEXT), encoding="utf-8")
        os.environ[CONTEXT] = ""
        os.environ["COVERAGE_PROCESS_START"] = str(file)
        coverage = Coverage(config_file=str(file))
        coverage.start()
    costs = Costs(coverage)
    costs.compiles()
    config.pluginmanager.register(costs, "test costs")
