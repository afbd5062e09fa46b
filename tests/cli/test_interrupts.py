"""An interrupt at any moment ends the program with 130 and one line, and is never lost."""

import gc
import signal
import subprocess
import sys
import threading
import time
from typing import Any

import pytest

from ratt_opt.cli.interrupts import Interrupts
from tests.interrupts import INTERRUPTED_IMPORTS

DURING_IMPORT = f"""{INTERRUPTED_IMPORTS}
sys.meta_path.insert(0, Interrupts({{name!r}}))
from ratt_opt.cli import main
main()
"""
ON_THE_WAY_OUT = """
import atexit, signal
atexit.register(signal.raise_signal, signal.SIGINT)
from ratt_opt.cli import main
main()
"""


def _run(program: str, *arguments: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run([sys.executable, "-c", program, *arguments], capture_output=True, text=True, check=False)


@pytest.mark.parametrize(
    "name",
    [
        "ratt_opt.cli.exit_codes",
        "logging",
        "ratt_opt.cli.interrupts",
        "typer",
        "ratt_opt.cli.planning",
        "numpy",
        "pydantic",
    ],
)
def test_while_modules_are_imported(name: str) -> None:
    done = _run(DURING_IMPORT.format(name=name), "bound", "none.json", "--out", ".")
    assert done.returncode == 130
    assert done.stderr == "error: interrupted\n"


def test_one_while_another_is_being_answered() -> None:
    """Two early ones: the second, before interrupts are ignored, ended the program by the signal."""
    twice = DURING_IMPORT.replace(
        "from ratt_opt.cli", "sys.meta_path.insert(0, Interrupts({name!r}))\nfrom ratt_opt.cli"
    )
    done = _run(twice.format(name="ratt_opt.cli.interrupts"), "--version")
    assert (done.returncode, done.stderr) == (130, "error: interrupted\n")


STUDY_IMPORT = (
    DURING_IMPORT.rpartition("from ratt_opt.cli")[0]
    + """
import runpy
runpy.run_module("analysis.paper", run_name="__main__", alter_sys=True)
"""
)


@pytest.mark.parametrize("name", ["analysis.paper.caa", "numpy"])
def test_while_a_study_imports_its_modules(name: str) -> None:
    done = _run(STUDY_IMPORT.format(name=name), "--out", "none")
    assert (done.returncode, done.stderr) == (130, "error: interrupted\n")


def test_when_all_is_done_it_changes_nothing() -> None:
    done = _run(ON_THE_WAY_OUT, "--version")
    assert (done.returncode, done.stderr) == (0, "")


AT_THE_VERY_END = """
import signal, sys
class Last:
    def __del__(self, raise_signal=signal.raise_signal, number=signal.SIGINT):
        raise_signal(number)
sys.kept_to_the_end = Last()
from ratt_opt.cli import main
main()
"""


def test_when_the_interpreter_ends_it_changes_nothing() -> None:
    """It resets the handlers of signals before it lets go of the last modules."""
    done = _run(AT_THE_VERY_END, "--version")
    assert (done.returncode, done.stderr) == (0, "")


class _Collected:
    """Interrupted while it is collected, where Python drops the exception."""

    def __del__(self) -> None:
        signal.raise_signal(signal.SIGINT)


class _HalfMade:
    def __del__(self) -> None:
        raise AttributeError("never made")


@pytest.mark.filterwarnings("error::pytest.PytestUnraisableExceptionWarning")
def test_one_that_python_drops_comes_again(capsys: pytest.CaptureFixture[str]) -> None:
    with Interrupts() as interrupts:
        with pytest.raises(KeyboardInterrupt):  # noqa: PT012  (it comes some time later)
            _Collected()
            gc.collect()
            time.sleep(10)
        _HalfMade()
        gc.collect()
    assert interrupts.happened
    assert capsys.readouterr().err == ""


@pytest.mark.filterwarnings("error::pytest.PytestUnraisableExceptionWarning")
def test_one_that_comes_while_another_is_dropped(monkeypatch: pytest.MonkeyPatch) -> None:
    """On a busy machine the one that comes again came before the hook had returned, and was dropped for good."""
    start = threading.Thread.start

    def interrupted(thread: threading.Thread) -> None:
        start(thread)
        signal.raise_signal(signal.SIGINT)

    monkeypatch.setattr(threading.Thread, "start", interrupted)
    with Interrupts(), pytest.raises(KeyboardInterrupt):  # noqa: PT012  (it comes some time later)
        _Collected()
        gc.collect()
        time.sleep(10)


@pytest.mark.parametrize("moment", range(3, 15))
def test_while_it_stops_looking_for_one(moment: int) -> None:
    """From its first line on. A lock that the handler takes, and that leaving holds, would never be free again."""
    before, hook, seen = signal.getsignal(signal.SIGINT), sys.unraisablehook, 0

    def interrupting(*_: object) -> Any:
        nonlocal seen
        seen += 1
        if seen == moment:
            signal.raise_signal(signal.SIGINT)
        return interrupting

    def too_long(*_: object) -> None:
        raise TimeoutError

    alarm = signal.signal(signal.SIGALRM, too_long)
    signal.alarm(5)
    interrupts = Interrupts().__enter__()
    try:
        sys.settrace(interrupting)
        interrupts.__exit__()
    except KeyboardInterrupt:
        pass
    finally:
        sys.settrace(None)
        signal.alarm(0)
        signal.signal(signal.SIGALRM, alarm)
    assert signal.getsignal(signal.SIGINT) is before
    assert sys.unraisablehook is hook


def test_without_an_interrupt_errors_of_destructors_are_shown(monkeypatch: pytest.MonkeyPatch) -> None:
    shown: list[object] = []
    monkeypatch.setattr(sys, "unraisablehook", shown.append)
    with Interrupts():
        _HalfMade()
        gc.collect()
    assert len(shown) == 1
