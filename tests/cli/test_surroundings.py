"""Whatever the machine is like: locales, terminals, streams, homes."""

import fcntl
import json
import os
import pty
import struct
import subprocess
import sys
import termios
from pathlib import Path

import pytest

from ratt_opt import random_scenario, save_scenario

PROGRAM = [sys.executable, "-c", "from ratt_opt.cli import main; main()"]


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A scenario whose names no ASCII locale can print, and a plan."""
    made = tmp_path_factory.mktemp("robots")
    scenario = random_scenario(3, 2, alpha_s=1, alpha_c=1, seed=5)
    named = [robot.replace(name=name) for robot, name in zip(scenario.robots, ("Zoë", "机器人", "[b]"), strict=True)]
    save_scenario(scenario.replace(robots=tuple(named)), made / "scenario.json")
    (made / "plan.json").write_text('{"controls": [0, 1, 2]}')
    return made


@pytest.mark.parametrize("locale", ["C", "tr_TR.ISO-8859-9"])
def test_any_locale(locale: str, folder: Path, tmp_path: Path) -> None:
    encoding = {"PYTHONUTF8": "0", "PYTHONCOERCECLOCALE": "0", "LC_ALL": locale, "LANG": locale}
    command = [*PROGRAM, "bound", str(folder / "scenario.json"), "--out", str(tmp_path / "ö"), "--no-certificate"]
    done = subprocess.run(command, env={**os.environ, **encoding}, capture_output=True, check=False)
    assert done.returncode == 0
    assert b"Traceback" not in done.stderr
    report = json.loads((tmp_path / "ö" / "report.json").read_text(encoding="utf-8"))
    assert report["robot_names"] == ["Zoë", "机器人", "[b]"]
    assert "机器人" in (tmp_path / "ö" / "report.html").read_text(encoding="utf-8")


@pytest.mark.parametrize("columns", [1, 20, 200])
def test_terminals_of_any_width(columns: int, folder: Path) -> None:
    """With a terminal of so many columns: tables, colours and a spinner, and still exit 0."""
    leader, follower = pty.openpty()
    fcntl.ioctl(follower, termios.TIOCSWINSZ, struct.pack("HHHH", 24, columns, 0, 0))
    command = [*PROGRAM, "attack", str(folder / "scenario.json"), "--plan", str(folder / "plan.json")]
    with subprocess.Popen(command, stdin=follower, stdout=follower, stderr=follower, close_fds=True) as process:
        os.close(follower)
        shown = b""
        while True:
            try:
                piece = os.read(leader, 65536)
            except OSError:  # the program has ended, and its terminal with it
                break
            if not piece:
                break
            shown += piece
        assert process.wait(60) == 0
    os.close(leader)
    assert b"Traceback" not in shown
    assert all(word in shown for word in (b"worst", b"greedy", b"random"))


@pytest.mark.parametrize(
    ("closed", "code"), [("<&-", 0), ("2>&-", 0), (">&-", 74), ("<&- >&- 2>&-", 74), ("</dev/null 2>/dev/full", 0)]
)
def test_closed_streams(closed: str, code: int, folder: Path, tmp_path: Path) -> None:
    """The exit code says whether the result arrived, and no file gets what belongs to a stream."""
    out = tmp_path / "new.json"
    numbers = "--robots 2 --targets 1 --sensing-attacks 0 --link-attacks 0 --seed 1 --out"
    command = ["/bin/sh", "-c", f'exec "$0" "$@" {closed}', *PROGRAM, "new", *numbers.split(), str(out)]
    assert subprocess.run(command, cwd=folder, check=False, capture_output=True).returncode == code
    assert json.loads(out.read_text())["format"] == "ratt-opt scenario"


def test_settings_of_figures_for_other_programs_change_nothing(folder: Path, tmp_path: Path) -> None:
    """A backend that is not there, and no place for fonts: no error, no word."""
    settings = {"MPLBACKEND": "nonsense", "MPLCONFIGDIR": "/dev/null/x"}
    command = [*PROGRAM, "bound", str(folder / "scenario.json"), "--out", str(tmp_path), "--no-certificate"]
    done = subprocess.run(command, env={**os.environ, **settings}, capture_output=True, text=True, check=False)
    assert (done.returncode, done.stderr) == (0, "")
    assert (tmp_path / "plan.png").stat().st_size > 1000
