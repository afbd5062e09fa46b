"""Files are written whole or not at all."""

import os
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest

from ratt_opt import InputError
from ratt_opt._files import output_directory, write_atomically, write_json, write_together


def test_a_failed_write_leaves_the_old_file(tmp_path: Path) -> None:
    target = tmp_path / "report.json"
    write_json(target, {"a": 1})
    with pytest.raises(ValueError, match="not JSON compliant"):
        write_json(target, {"a": float("nan")})
    assert target.read_text() == '{\n "a": 1\n}\n'
    assert os.listdir(tmp_path) == ["report.json"]


def test_an_interrupted_write_leaves_nothing(tmp_path: Path) -> None:
    def interrupted(file: Path) -> None:
        file.write_text("half")
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        write_atomically(tmp_path / "x.txt", interrupted)
    assert os.listdir(tmp_path) == []


def test_unwritable_places_are_refused(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    with pytest.raises(InputError, match="out must be a folder"):
        output_directory(tmp_path / "file")
    with pytest.raises(InputError, match="out must be a path"):
        write_json(tmp_path / "missing" / "x.json", {})


def test_files_that_belong_together_are_replaced_together_or_marked(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def text(word: str) -> Callable[[Path], object]:
        return lambda file: file.write_text(word)

    def full_disk(_: Path) -> object:
        raise OSError(28, "No space left on device")

    write_together(tmp_path, {"a": text("old"), "b": text("old")})
    monkeypatch.chdir(tmp_path)  # messages shorten long paths
    with pytest.raises(InputError, match="No space"):
        write_together(Path(), {"a": text("new"), "b": full_disk})
    assert {file.name: file.read_text() for file in tmp_path.iterdir()} == {"a": "old", "b": "old"}
    real = Path.replace

    def killed(self: Path, target: Path) -> Path:
        if target.name == "b":
            raise KeyboardInterrupt
        return real(self, target)

    monkeypatch.setattr(Path, "replace", killed)
    with pytest.raises(KeyboardInterrupt):
        write_together(tmp_path, {"a": text("new"), "b": text("new")})
    assert (tmp_path / "a").read_text() == "new"
    assert (tmp_path / "b").read_text() == "old"
    assert "Run the same command again" in (tmp_path / "incomplete.txt").read_text()
    monkeypatch.undo()
    write_together(tmp_path, {"a": text("new"), "b": text("new")})
    assert sorted(os.listdir(tmp_path)) == ["a", "b"]


KILLED = """
import os, pathlib, sys
from ratt_opt._files import write_atomically, write_together

def killed(file):
    file.write_text("half")
    os.kill(os.getpid(), 9)

folder = pathlib.Path(sys.argv[1])
if sys.argv[2] == "one":
    write_atomically(folder / "a", killed)
write_together(folder, {"a": killed})
"""


@pytest.mark.skipif(sys.platform == "win32", reason="a process cannot be asked whether it runs")
def test_what_killed_runs_left_is_swept(tmp_path: Path) -> None:
    for kind in ("one", "several"):
        subprocess.run([sys.executable, "-c", KILLED, str(tmp_path), kind], check=False)
    assert len(list(tmp_path.glob(".writing-*"))) == 2
    write_together(output_directory(tmp_path), {"a": lambda file: file.write_text(_others(tmp_path))})
    assert os.listdir(tmp_path) == ["a"]
    assert (tmp_path / "a").read_text() == "1"


def _others(folder: Path) -> str:
    """How many half-written files a second run leaves alone."""
    output_directory(folder)
    return str(len(list(folder.glob(".writing-*"))))
