"""A report is never lost: whatever becomes of the certificate, and whenever the user interrupts."""

from __future__ import annotations

import json
import os
from time import monotonic
from typing import TYPE_CHECKING, Any

import pytest

from ratt_opt import InputError, _files, load_scenario, verify_certificate
from ratt_opt.attackers import criticality, survey
from ratt_opt.attackers.link_choice import best_links
from ratt_opt.certificates import write
from ratt_opt.certificates.verifier.work import tick
from ratt_opt.cli import run
from ratt_opt.errors import UndecidedError
from ratt_opt.main_job import bound as main_job
from ratt_opt.report import write as report_files
from ratt_opt.report.write import FILES

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path


def _report(folder: Path) -> Any:
    return json.loads((folder / "report.json").read_text())


def _raise(error: BaseException) -> Callable[..., Any]:
    def fail(*_: Any, **__: Any) -> Any:
        raise error

    return fail


def _once_interrupted(real: Callable[..., Any]) -> Callable[..., Any]:
    calls: list[int] = []

    def once(*given: Any, **named: Any) -> Any:
        calls.append(0)
        if len(calls) == 1:
            raise KeyboardInterrupt
        return real(*given, **named)

    return once


@pytest.mark.parametrize(
    "case",
    [
        (InputError("out", "must be a path that can be written", "x (No space left on device)"), 0, "No space left"),
        (MemoryError(), 0, "not enough memory"),
        (KeyboardInterrupt(), 130, "interrupted"),
    ],
)
def test_a_certificate_that_cannot_be_made_is_a_reason_in_the_report(
    case: tuple[BaseException, int, str], scenario_file: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """This run's report and figures are there; the certificate of an earlier run is still the whole earlier one."""
    error, code, reason = case
    out = tmp_path / "o"
    command = ["bound", str(scenario_file), "--out", str(out)]
    assert run(command) == 0
    earlier = (out / "certificate.json").read_bytes()
    assert _report(out)["certificate"]["verified"] is True
    monkeypatch.setattr(write, "_write_verified", _raise(error))
    assert run(command) == code
    found = _report(out)
    assert found["certificate"]["verified"] is False
    assert reason in found["certificate"]["reason"]
    assert (out / "certificate.json").read_bytes() == earlier
    assert sorted(os.listdir(out)) == sorted(["certificate.json", *FILES])
    assert verify_certificate(out / "certificate.json").lower_proved


@pytest.mark.parametrize("step", ["assess", "solve_maxmin", "total_curvature", "all_guarantees"])
def test_an_interrupt_anywhere_in_the_main_job_leaves_what_is_finished(
    step: str,
    scenario_file: Path,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    """Raised where no search expects it: the report holds valid brackets, and is marked."""
    monkeypatch.setattr(main_job, step, _once_interrupted(getattr(main_job, step)))
    assert run(["bound", str(scenario_file), "--out", str(tmp_path / "o")]) == 130
    assert "interrupted" in capsys.readouterr().err
    found = _report(tmp_path / "o")
    assert found["interrupted"] is True
    assert found["certificate"]["verified"] is False
    monkeypatch.undo()
    whole = main_job.bound(load_scenario(scenario_file))
    assert found["optimum"]["lower"] <= whole.upper * (1 + 1e-9)
    assert whole.optimum.lower <= found["optimum"]["upper"] * (1 + 1e-9)
    assert not (tmp_path / "o" / "certificate.json").exists()


def test_an_interrupt_while_figures_are_drawn_leaves_all_else(
    scenario_file: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """Those of an earlier report do not stay beside the new numbers."""
    out = tmp_path / "o"
    command = ["bound", str(scenario_file), "--out", str(out), "--objective"]
    assert run([*command, "trace"]) == 0
    monkeypatch.setattr(report_files, "plan_figure", _raise(KeyboardInterrupt()))
    assert run([*command, "logdet"]) == 130
    assert len(capsys.readouterr().err.splitlines()) == 1
    found = _report(out)
    assert (found["objective"], found["interrupted"]) == ("logdet", False)
    assert "interrupted" in found["certificate"]["reason"]
    assert sorted(os.listdir(out)) == ["certificate.json", "plan.csv", "report.html", "report.json"]


def test_an_interrupted_report_is_written_without_drawing(
    scenario_file: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(report_files, "plan_figure", _raise(AssertionError()))
    monkeypatch.setattr(main_job, "solve_maxmin", _once_interrupted(main_job.solve_maxmin))
    assert run(["bound", str(scenario_file), "--out", str(tmp_path / "o")]) == 130
    assert sorted(os.listdir(tmp_path / "o")) == ["plan.csv", "report.html", "report.json"]


def test_an_interrupt_before_there_is_a_plan_leaves_the_earlier_files(
    scenario_file: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    command = ["bound", str(scenario_file), "--out", str(tmp_path / "o")]
    assert run(command) == 0
    before = {file.name: file.read_bytes() for file in (tmp_path / "o").iterdir()}
    monkeypatch.setattr(main_job, "bait_and_greedy", _raise(KeyboardInterrupt()))
    assert run(command) == 130
    assert {file.name: file.read_bytes() for file in (tmp_path / "o").iterdir()} == before


def test_a_proof_without_end_keeps_the_limit(
    scenario_file: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The limit covers the certificate, which then says which end is proved."""
    began = monotonic()

    def endless(*_: Any, **__: Any) -> Any:
        try:
            while monotonic() < began + 20:
                tick()
        except UndecidedError:
            return write.ENUMERATED
        raise AssertionError

    monkeypatch.setattr(write, "lower_proof", endless)
    assert run(["bound", str(scenario_file), "--out", str(tmp_path / "o"), "--time-limit", "1"]) == 0
    found = verify_certificate(tmp_path / "o" / "certificate.json")
    assert found.upper > 0
    assert not found.lower_proved


SEARCHES = {
    "attack_survey": survey,
    "criticality_ranking": criticality,
    "breaking_budgets": criticality,
    "links_to_protect": best_links,
    "links_to_add": best_links,
}
"""What ``attack`` asks for, in this order, and where it is."""


@pytest.mark.parametrize("case", [*((step, True) for step in SEARCHES), *((step, False) for step in SEARCHES)])
def test_an_interrupt_of_an_attack_ends_it_with_what_was_found(
    case: tuple[str, bool],
    scenario_file: Path,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    """A search that keeps its bracket is the last one, too; only before the first has one is nothing printed."""
    step, is_caught = case
    asked: list[str] = []

    def watched(name: str, real: Callable[..., Any]) -> Callable[..., Any]:
        def search(*given: Any, **named: Any) -> Any:
            asked.append(name)
            if name != step:
                return real(*given, **named)
            if not is_caught:
                raise KeyboardInterrupt
            named["budget"].interrupt()
            return real(*given, **named)

        return search

    for name, module in SEARCHES.items():
        monkeypatch.setattr(module, name, watched(name, getattr(module, name)))
    plan = tmp_path / "plan.json"
    plan.write_text('{"elements": [0, 12, 24]}')
    wanted = ["--rank", "2", "--below", "1e9", "--protect", "1", "--add", "1", "--json"]
    assert run(["attack", str(scenario_file), "--plan", str(plan), *wanted]) == 130
    printed = capsys.readouterr()
    assert len(printed.err.splitlines()) == 1
    assert "interrupted" in printed.err
    assert asked == list(SEARCHES)[: list(SEARCHES).index(step) + 1]
    if is_caught or step != "attack_survey":
        found = json.loads(printed.out)
        assert found["attacks"]["exact"]["lower"] <= found["attacks"]["exact"]["upper"]
    else:
        assert printed.out == ""


def test_files_that_belong_together_are_replaced_together_or_marked(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def text(word: str) -> Callable[[Path], object]:
        return lambda file: file.write_text(word)

    _files.write_together(tmp_path, {"a": text("old"), "b": text("old")})
    with pytest.raises(InputError, match="No space"):
        _files.write_together(tmp_path, {"a": text("new"), "b": _raise(OSError(28, "No space left on device"))})
    assert {file.name: file.read_text() for file in tmp_path.iterdir()} == {"a": "old", "b": "old"}
    real = _files.Path.replace

    def killed(self: Path, target: Path) -> Path:
        if target.name == "b":
            raise KeyboardInterrupt
        return real(self, target)

    monkeypatch.setattr(_files.Path, "replace", killed)
    with pytest.raises(KeyboardInterrupt):
        _files.write_together(tmp_path, {"a": text("new"), "b": text("new")})
    assert (tmp_path / "a").read_text() == "new"
    assert (tmp_path / "b").read_text() == "old"
    assert "Run the same command again" in (tmp_path / _files.MIXED).read_text()
    monkeypatch.undo()
    _files.write_together(tmp_path, {"a": text("new"), "b": text("new")})
    assert sorted(os.listdir(tmp_path)) == ["a", "b"]


def test_the_report_says_that_its_proof_is_not_finished_until_it_is(
    scenario_file: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """What a kill during the certificate leaves."""
    out, seen = tmp_path / "o", []
    real = write._write_verified

    def look(*given: Any) -> Any:
        seen.append(_report(out)["certificate"])
        return real(*given)

    monkeypatch.setattr(write, "_write_verified", look)
    assert run(["bound", str(scenario_file), "--out", str(out)]) == 0
    assert "not finished when this report was written" in seen[0]["reason"]
    assert _report(out)["certificate"]["verified"] is True
