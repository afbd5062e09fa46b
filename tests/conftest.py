"""What every test may rely on."""

import signal
from collections.abc import Iterator
from pathlib import Path

import pytest
from hypothesis import settings

SHORT_TIER = Path(__file__).parent / "short_tier.txt"
"""Test functions of which the short tier runs some cases, or none: they cost much and find little that others miss.
``python -m analysis.test_tier choose`` writes it."""

# How long an example takes says more about a busy machine than about what is tested.
settings.register_profile("any machine", deadline=None)
settings.load_profile("any machine")


@pytest.fixture(autouse=True, scope="session")
def _processes_hear_ctrl_c() -> Iterator[None]:
    """A shell starts background jobs with Ctrl-C ignored, which every process they start would inherit."""
    before = signal.getsignal(signal.SIGINT)
    if before is signal.SIG_IGN:
        signal.signal(signal.SIGINT, signal.default_int_handler)
    yield
    if before is signal.SIG_IGN:
        signal.signal(signal.SIGINT, before)


@pytest.fixture
def exact_balls() -> Iterator[None]:
    """Differences of balls, and comparisons with floats, at the digits of :mod:`tests.exact_values`."""
    from flint import ctx

    from tests.exact_values import DIGITS

    with ctx.workdps(DIGITS):
        yield


def pytest_addoption(parser: pytest.Parser) -> None:
    parser.addoption("--whole", action="store_true", help="run the whole suite, not only the short tier")


def pytest_configure(config: pytest.Config) -> None:
    """Who names tests, by path, ``-k`` or ``-m``, gets all of them."""
    named = config.args_source is pytest.Config.ArgsSource.ARGS or config.option.markexpr != "not slow"
    config.option.whole |= named or bool(config.option.keyword)


def pytest_xdist_auto_num_workers(config: pytest.Config) -> int | None:
    """Files are run in this process, where a debugger works; folders on all cores."""
    return 0 if all(arg.partition("::")[0].endswith(".py") for arg in config.args) else None


@pytest.hookimpl(trylast=True)  # after slow tests are gone
def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    """Keep as many cases of a listed function as the list says, spread evenly."""
    if config.option.whole or not SHORT_TIER.exists():
        return
    listed = dict(line.split() for line in SHORT_TIER.read_text(encoding="utf-8").splitlines())
    cases: dict[str, list[pytest.Item]] = {}
    for item in items:
        cases.setdefault(item.nodeid.partition("[")[0], []).append(item)
    left_out: set[pytest.Item] = set()
    for name in listed.keys() & cases.keys():
        every, n = cases[name], min(int(listed[name]), len(cases[name]))
        left_out |= set(every) - {every[i * len(every) // n] for i in range(n)}
    config.hook.pytest_deselected(items=[item for item in items if item in left_out])
    items[:] = [item for item in items if item not in left_out]
