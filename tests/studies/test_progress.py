"""Progress: a bar with the time left on a terminal, plain lines when piped."""

import io

import pytest

from ratt_opt.studies import progress
from ratt_opt.studies.progress import Progress


class _Terminal(io.StringIO):
    def isatty(self) -> bool:
        return True


def test_plain_lines_say_what_is_left(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    clock = iter([0.0, 5.0, 12.0, 18.0, 20.0])
    monkeypatch.setattr(progress.time, "monotonic", lambda: next(clock))
    with Progress().task("toy", total=6, done=3) as advance:
        for _ in range(3):
            advance()
    # After 12 s two of three new trials are done; a line comes every 10 s at most, and none at the end but the last.
    assert capsys.readouterr().err.splitlines() == [
        "toy: 3/6 trials were already there",
        "toy: 5/6 trials, about 6 s left",
        "toy: 6/6 trials, 20.0 s",
    ]


def test_a_terminal_gets_a_bar_with_the_time_left(monkeypatch: pytest.MonkeyPatch) -> None:
    terminal = _Terminal()
    monkeypatch.setattr("sys.stderr", terminal)
    monkeypatch.setenv("TERM", "xterm")
    monkeypatch.setenv("COLUMNS", "100")
    with Progress().task("toy", total=4, done=1) as advance:
        for _ in range(3):
            advance()
    shown = terminal.getvalue()
    assert "toy" in shown
    assert "4/4" in shown
    assert "left" in shown
