"""A stranger's walk: the jobs of the page, their lines of code, and what the walk calls a fault; the gate walks it."""

import os
import sys
from pathlib import Path

import pytest

from analysis import walk

JOBS = {job.name: job for job in walk.jobs_of((walk.ROOT / walk.PAGE).read_text(encoding="utf-8"))}


def test_the_page_has_the_three_jobs_within_their_lines() -> None:
    assert set(JOBS) == set(walk.AIMS) == set(walk.CHECKS)
    for name, job in JOBS.items():
        assert 0 < job.lines <= walk.AIMS[name]
        assert any(file is None for file, _ in job.blocks)


@pytest.mark.parametrize(
    ("code", "lines"),
    [
        ("x = 1\n", 1),
        ('"""A page."""\n\n# a remark\nx = 1  # another\n', 1),
        ("x = [\n    1,\n    2,\n]\n", 1),
        ('def f(x):\n    """What it does."""\n    y = x\n    return y\n', 3),
        ("import dataclasses\n\n\n@dataclasses.dataclass\nclass A:\n    x: int = 1\n", 4),
        ("for i in range(3):\n    print(i)\nelse:\n    print()\n", 4),
    ],
)
def test_code_lines_by_hand(code: str, lines: int) -> None:
    assert walk.code_lines(code) == lines


@pytest.fixture
def commands(tmp_path: Path) -> Path:
    (tmp_path / "bin").mkdir()
    (tmp_path / "bin" / "python").symlink_to(sys.executable)
    return tmp_path / "bin"


def a_job(*blocks: tuple[str | None, str]) -> walk.Job:
    return walk.Job("drones", "Drones", blocks)


def test_a_command_that_fails_is_named_with_its_words(tmp_path: Path, commands: Path) -> None:
    fault = walk.run_job(a_job(("a.py", "raise SystemExit('no boats')\n"), (None, "python a.py\n")), tmp_path, commands)
    assert fault is not None
    assert fault.startswith("failed: python a.py")
    assert "no boats" in fault


def test_too_many_lines_and_wrong_results_are_faults(
    tmp_path: Path, commands: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    long = a_job(("a.py", "x = 1\n" * 13), (None, "python a.py\n"))
    assert walk.run_job(long, tmp_path, commands) == "too many lines"
    short = a_job(("a.py", "x = 1\n"), (None, "python a.py\n"))
    monkeypatch.setitem(walk.CHECKS, "drones", lambda folder: f"no plan in {folder.name}")
    assert walk.run_job(short, tmp_path, commands) == f"no plan in {tmp_path.name}"
    monkeypatch.setitem(walk.CHECKS, "drones", lambda _: None)
    assert walk.run_job(short, tmp_path, commands) is None


def test_programs_do_not_see_the_source_tree(tmp_path: Path, commands: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("PYTHONPATH", os.getcwd())
    monkeypatch.setitem(walk.CHECKS, "drones", lambda _: None)
    job = a_job(("a.py", "import os\nassert 'PYTHONPATH' not in os.environ\n"), (None, "python a.py\n"))
    assert walk.run_job(job, tmp_path, commands) is None


def test_a_clone_that_fails_is_said_and_a_failure(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(walk, "ROOT", tmp_path / "nowhere")
    assert walk.main(["--offline"]) == 1
    assert "git clone" in capsys.readouterr().err
