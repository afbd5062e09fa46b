"""What is made of all studies, when some of them are run again."""

import sys
from dataclasses import replace
from pathlib import Path

import pytest

from ratt_opt.studies import Case, Entry, Study, main

ONE = Study(
    name="one",
    cases=(Case(n_robots=2, n_targets=1, alpha_s=1, alpha_c=0),),
    planners=("greedy",),
    attackers=("none",),
    metrics=("value",),
)
ENTRIES = [Entry(ONE), Entry(replace(ONE, name="two"))]


def test_claims_are_renewed_with_the_tables_they_speak_of(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    seen = []

    def after(out: Path) -> None:
        seen.append([len((out / name / "table.csv").read_text().splitlines()) - 1 for name in ("one", "two")])

    def command(*given: str) -> None:
        monkeypatch.setattr(sys, "argv", ["study", "--out", str(tmp_path), "--workers", "1", *given])
        assert main("Two studies.", ENTRIES, trials=1, after=after) == 0

    command("--only", "one")
    assert not seen
    assert "waits for two" in capsys.readouterr().err
    command()
    command("--only", "one", "--trials", "3")
    assert seen == [[1, 1], [3, 1]]
