"""Progress: on a terminal, every step over two seconds, with its time; nowhere else, and nothing stays."""

import fcntl
import os
import pty
import re
import struct
import subprocess
import sys
import termios

import pytest

from ratt_opt.running import progress
from ratt_opt.running.progress import ERASE, Step
from tests.documents import ROOT

SLOW_SEARCH = """
import time, ratt_opt as ro, ratt_opt.running.progress as p
p.PATIENCE, p.PERIOD = p.PATIENCE / 10, 0.05
class Slow(ro.SetFunction):
    n = 3
    def evaluate(self, membership):
        time.sleep(0.5)
        return membership.sum(axis=-1).astype(float)
ro.find_submodularity_violation(Slow())
print("done")
"""


def on_a_terminal(code: str, columns: int = 0) -> tuple[str, str]:
    """Standard output, and what a terminal of so many columns (0: it does not say) on standard error was sent."""
    master, terminal = pty.openpty()
    fcntl.ioctl(terminal, termios.TIOCSWINSZ, struct.pack("HHHH", 24, columns, 0, 0))
    environment = os.environ | {"PYTHONPATH": str(ROOT)}
    process = subprocess.Popen([sys.executable, "-c", code], stdout=subprocess.PIPE, stderr=terminal, env=environment)
    os.close(terminal)
    shown = b""
    try:
        while chunk := os.read(master, 4096):
            shown += chunk
    except OSError:  # what Linux says at the end
        pass
    printed, _ = process.communicate()
    assert process.returncode == 0, shown.decode()
    return printed.decode(), shown.decode()


def test_a_step_over_two_seconds_is_shown_with_its_time_and_then_erased() -> None:
    printed, shown = on_a_terminal(SLOW_SEARCH)
    assert progress.PATIENCE == 2
    assert printed == "done\n"
    assert re.search(r"looking for a violation of submodularity \([01] s\)", shown)
    assert shown.endswith(ERASE)


def test_a_line_fits_the_terminal_that_it_is_erased_on() -> None:
    """Standard output is another one, or none, and says nothing about it."""
    _, shown = on_a_terminal(SLOW_SEARCH, columns=20)
    lines = set(shown.split(ERASE))
    assert lines == {"", "looking for a viola"}


def test_a_step_that_somebody_waits_for_is_shown_at_once() -> None:
    code = "import time, ratt_opt.running.progress as p\np.PERIOD = 0.01\nwith p.Step('writing', 0.0): time.sleep(0.3)"
    assert "writing (0 s)" in on_a_terminal(code)[1]


def test_a_short_step_shows_nothing() -> None:
    assert (
        on_a_terminal("import ratt_opt as ro; ro.caa(5, 3); ro.find_submodularity_violation(ro.Modular([1.0]))")[1]
        == ""
    )


def test_nothing_is_written_where_there_is_no_terminal() -> None:
    code = "import ratt_opt.running.progress as p, time; p.PATIENCE = p.PERIOD = 0\nwith p.Step('x'): time.sleep(0.2)"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True, cwd=ROOT)
    assert done.stdout + done.stderr == ""


@pytest.mark.parametrize("closed", [False, True])
def test_without_standard_error_a_step_is_no_trouble(monkeypatch: pytest.MonkeyPatch, closed: bool) -> None:
    stream = None
    if closed:
        stream = open(os.devnull, "w")  # noqa: SIM115
        stream.close()
    monkeypatch.setattr(sys, "stderr", stream)
    with Step("quiet") as step:
        step.say("still")


def test_a_decorated_function_keeps_its_name_and_recurses(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(progress, "_somebody_looks", lambda: True)
    monkeypatch.setattr(progress, "PERIOD", 60.0)
    depth = []

    @Step("counting")
    def count(n: int) -> int:
        """Count."""
        depth.append(len(progress._SCREEN._steps))
        return 0 if n == 0 else 1 + count(n - 1)

    assert (count(3), count.__name__, count.__doc__) == (3, "count", "Count.")
    assert depth == [1, 2, 3, 4]
    assert progress._SCREEN._steps == []
