"""A pytest plug-in: processor seconds of every test function, and the lines that it reaches, by coverage.

``python -m pytest -n0 -p analysis.test_tier.reach`` writes ``measured.csv`` and files ``lines.*`` into the folder that
``TIER_FOLDER`` names. Processes that a test starts are followed, too.
"""

import os
import resource
import sys
import time
from collections import defaultdict
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from coverage import Coverage

from analysis.test_tier.choose import Cost, write_costs

CONTEXT = "TIER_TEST"
"""Environment variable that tells processes which test started them."""
SETTINGS = """[run]
source_pkgs = ratt_opt, ratt_audit
parallel = true
data_file = {folder}/lines
context = ${{{context}-}}
disable_warnings = module-not-imported, no-data-collected, module-not-measured, module-not-python, already-imported
"""


def _seconds() -> float:
    ended = resource.getrusage(resource.RUSAGE_CHILDREN)
    return time.process_time() + ended.ru_utime + ended.ru_stime


class Costs:
    """Adds up what every test function takes, and says to coverage which one runs."""

    def __init__(self, folder: Path, coverage: Coverage) -> None:
        self._folder = folder
        self._coverage = coverage
        self._costs: dict[str, Cost] = {}
        self._fixtures: dict[tuple[str, str], float] = defaultdict(float)
        """Seconds of the fixtures that tests share, by where they are valid and their names."""
        self._now = ""
        self._of_fixtures = 0.0

    def _switch(self, context: str) -> None:
        os.environ[CONTEXT] = context
        if sys.gettrace() is None:  # a test has traced something itself
            self._coverage.stop()
            self._coverage.start()
        self._coverage.switch_context(context)

    @pytest.hookimpl(wrapper=True)
    def pytest_runtest_protocol(self, item: pytest.Item) -> Iterator[None]:
        """Say whose lines and seconds come now."""
        self._now = item.nodeid.partition("[")[0]
        self._switch(self._now)
        self._of_fixtures, before = 0.0, _seconds()
        try:
            return (yield)
        finally:
            own = _seconds() - before - self._of_fixtures
            cost = Cost(1, own, self._shared_by(item))
            self._costs[self._now] = self._costs.get(self._now, Cost(0, 0.0)) + cost
            self._switch("")

    @pytest.hookimpl(wrapper=True)
    def pytest_fixture_setup(self, fixturedef: pytest.FixtureDef[Any]) -> Iterator[Any]:
        """Count the lines that a shared fixture reaches for every test that may rely on it."""
        if fixturedef.scope == "function":
            return (yield)
        self._switch(f"{fixturedef.baseid}*")
        before = _seconds()
        try:
            return (yield)
        finally:
            taken = _seconds() - before
            self._fixtures[fixturedef.baseid, fixturedef.argname] += taken
            self._of_fixtures += taken
            self._switch(self._now)

    def _shared_by(self, item: pytest.Item) -> float:
        names = set(getattr(item, "fixturenames", ()))
        shared = self._fixtures.items()
        return sum(taken for (base, own), taken in shared if own in names and item.nodeid.startswith(base))

    def pytest_sessionfinish(self) -> None:
        """Write what was measured."""
        write_costs(self._folder / "measured.csv", self._costs)
        self._coverage.stop()
        self._coverage.save()


def pytest_configure(config: pytest.Config) -> None:
    """Start to measure."""
    folder = Path(os.environ["TIER_FOLDER"])
    file = folder / "coverage.ini"
    file.write_text(SETTINGS.format(folder=folder, context=CONTEXT), encoding="utf-8")
    os.environ[CONTEXT] = ""
    os.environ["COVERAGE_PROCESS_START"] = str(file)
    coverage = Coverage(config_file=str(file))
    coverage.start()
    config.pluginmanager.register(Costs(folder, coverage), "test costs")
