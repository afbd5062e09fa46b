"""The command that tests the wheel on every Python: what it looks for, and what it calls a failure."""

import re
import subprocess
import sys
from pathlib import Path

import pytest

from analysis import pythons


def test_it_finds_this_interpreter_and_no_other_version() -> None:
    version = f"{sys.version_info.major}.{sys.version_info.minor}"
    assert pythons.find_python(version, ["no such program", sys.executable]) == sys.executable
    assert pythons.find_python("3.0", [sys.executable]) is None


def test_the_oldest_dependencies_are_those_that_the_project_states() -> None:
    pins = pythons.lower_bounds()
    stated = (pythons.ROOT / "pyproject.toml").read_text(encoding="utf-8")
    assert all(re.fullmatch(r"[\w\[\]-]+==[\d.]+", pin) for pin in pins)
    assert all(f'"{pin.replace("==", ">=")}"' in stated for pin in pins)
    names = {pin.partition("==")[0] for pin in pins}
    assert {"numpy", "python-flint", "pytest", "distributed"} <= names
    assert "ratt-opt" not in names
    assert [environment.name for environment in pythons.environments()] == ["3.11", "3.12", "3.13", "3.11-oldest"]
    assert f'requires-python = ">={pythons.PYTHONS[0]}"' in stated


@pytest.fixture
def no_work(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(pythons, "COPIED", ())
    monkeypatch.setattr(pythons, "_build", lambda folder: folder)


@pytest.mark.usefixtures("no_work")
def test_a_python_that_is_missing_is_named_and_a_failure(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(pythons, "find_python", lambda version, _: "x" if version == "3.11" else None)
    monkeypatch.setattr(pythons, "_tried", lambda *_: ("passed", "all"))
    assert pythons.main([]) == 1
    shown = capsys.readouterr().out
    assert [line.split()[:2] for line in shown.splitlines()] == [
        ["3.11", "passed"], ["3.12", "missing"], ["3.13", "missing"], ["3.11-oldest", "passed"],
    ]  # fmt: skip
    assert "pyenv install" in shown
    assert pythons.main(["--available"]) == 0
    assert pythons.main(["--only", "3.11"]) == 0


@pytest.mark.usefixtures("no_work")
def test_tests_that_fail_are_a_failure(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    def run(command: list[object], _: Path) -> str:
        if "pytest" in command:
            raise subprocess.CalledProcessError(1, "pytest", "1 failed", "")
        return "numpy==2.0\n"

    monkeypatch.setattr(pythons, "_run", run)
    monkeypatch.setattr(pythons, "find_python", lambda *_: "x")
    assert pythons.main(["--available", "--only", "3.11-oldest"]) == 1
    assert capsys.readouterr().out == "3.11-oldest  failed   1 failed\n"
