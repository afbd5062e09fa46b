"""What every test may rely on."""

from __future__ import annotations

import signal
from typing import TYPE_CHECKING

import pytest
from hypothesis import settings

if TYPE_CHECKING:
    from collections.abc import Iterator

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


def pytest_xdist_auto_num_workers(config: pytest.Config) -> int | None:
    """Files are run in this process, where a debugger works; folders on all cores."""
    return 0 if all(arg.partition("::")[0].endswith(".py") for arg in config.args) else None
