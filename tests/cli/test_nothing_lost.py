"""A report is never lost: whatever becomes of the certificate, and whenever the user interrupts."""

import json
import os
from collections.abc import Callable
from pathlib import Path
from time import monotonic
from typing import Any

import pytest

from ratt_opt import InputError, bound, load_scenario, verify_certificate
from ratt_opt.cli import run
from tests.attack.engine import COMMAND
from tests.certificates import engine as certifying
from tests.certificates.engine import UndecidedError
from tests.interrupts import interrupted_at
from tests.main_job.engine import SEARCHES, step


def _report(folder: Path) -> Any:
    return json.loads((folder / "report.json").read_text())


def _raise(error: BaseException) -> Callable[..., Any]:
    def fail(*_: Any, **__: Any) -> Any:
        raise error

    return fail


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
    """This run's report is there, its figures unless it was interrupted; an earlier certificate is still whole."""
    error, code, reason = case
    out = tmp_path / "o"
    command = ["bound", str(scenario_file), "--out", str(out)]
    assert run(command) == 0
    earlier = (out / "certificate.json").read_bytes()
    assert _report(out)["certificate"]["verified"] is True
    certifying.step(monkeypatch, "writing", lambda _: _raise(error))
    assert run(command) == code
    found = _report(out)
    assert found["certificate"]["verified"] is False
    assert reason in found["certificate"]["reason"]
    assert (out / "certificate.json").read_bytes() == earlier
    figures = [] if code else ["plan.png", "plan.svg"]
    assert sorted(os.listdir(out)) == [
        "certificate.json",
        "cuts.json",
        "plan.csv",
        *figures,
        "report.html",
        "report.json",
    ]
    assert verify_certificate(out / "certificate.json").lower_proved


@pytest.mark.parametrize("name", SEARCHES)
def test_an_interrupt_anywhere_in_the_main_job_leaves_what_is_finished(
    name: str,
    scenario_file: Path,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    """Raised where no search expects it: the report holds valid brackets, and is marked."""
    step(monkeypatch, name, lambda real: interrupted_at(1, real))
    assert run(["bound", str(scenario_file), "--out", str(tmp_path / "o")]) == 130
    assert "interrupted" in capsys.readouterr().err
    found = _report(tmp_path / "o")
    assert found["interrupted"] is True
    assert found["certificate"]["verified"] is False
    monkeypatch.undo()
    whole = bound(load_scenario(scenario_file))
    assert found["optimum"]["lower"] <= whole.upper * (1 + 1e-9)
    assert whole.optimum.lower <= found["optimum"]["upper"] * (1 + 1e-9)
    assert not (tmp_path / "o" / "certificate.json").exists()


def test_an_interrupt_while_figures_are_drawn_leaves_all_else(
    scenario_file: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """The certificate too; figures of an earlier report do not stay beside the new numbers."""
    out = tmp_path / "o"
    command = ["bound", str(scenario_file), "--out", str(out), "--objective"]
    assert run([*command, "trace"]) == 0
    step(monkeypatch, "drawing", lambda _: _raise(KeyboardInterrupt()))
    assert run([*command, "logdet"]) == 130
    assert len(capsys.readouterr().err.splitlines()) == 1
    found = _report(out)
    assert (found["objective"], found["interrupted"]) == ("logdet", False)
    assert found["certificate"]["verified"] is True
    assert sorted(os.listdir(out)) == ["certificate.json", "cuts.json", "plan.csv", "report.html", "report.json"]


def test_an_interrupted_report_is_written_without_drawing(
    scenario_file: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    step(monkeypatch, "drawing", lambda _: _raise(AssertionError()))
    step(monkeypatch, "optimum", lambda real: interrupted_at(1, real))
    assert run(["bound", str(scenario_file), "--out", str(tmp_path / "o")]) == 130
    assert sorted(os.listdir(tmp_path / "o")) == ["plan.csv", "report.html", "report.json"]


def test_an_interrupt_before_there_is_a_plan_leaves_the_earlier_files(
    scenario_file: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    command = ["bound", str(scenario_file), "--out", str(tmp_path / "o")]
    assert run(command) == 0
    before = {file.name: file.read_bytes() for file in (tmp_path / "o").iterdir()}
    step(monkeypatch, "planning", lambda _: _raise(KeyboardInterrupt()))
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
                certifying.tick()
        except UndecidedError:
            return certifying.ENUMERATED
        raise AssertionError

    certifying.step(monkeypatch, "lower end", lambda _: endless)
    assert run(["bound", str(scenario_file), "--out", str(tmp_path / "o"), "--time-limit", "1"]) == 0
    found = verify_certificate(tmp_path / "o" / "certificate.json")
    assert found.upper > 0
    assert not found.lower_proved


@pytest.mark.parametrize("case", [(name, is_caught) for name in COMMAND for is_caught in (True, False)])
def test_an_interrupt_of_an_attack_ends_it_with_what_was_found(
    case: tuple[str, bool],
    scenario_file: Path,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    """A search that keeps its bracket is the last one, too; only before the first has one is nothing printed."""
    interrupted, is_caught = case
    asked: list[str] = []

    def watched(name: str, real: Callable[..., Any]) -> Callable[..., Any]:
        def search(*given: Any, **named: Any) -> Any:
            asked.append(name)
            if name != interrupted:
                return real(*given, **named)
            if not is_caught:
                raise KeyboardInterrupt
            named["budget"].interrupt()
            return real(*given, **named)

        return search

    for name, module in COMMAND.items():
        monkeypatch.setattr(module, name, watched(name, getattr(module, name)))
    plan = tmp_path / "plan.json"
    plan.write_text('{"elements": [0, 12, 24]}')
    wanted = ["--rank", "2", "--below", "1e9", "--protect", "1", "--add", "1", "--json"]
    assert run(["attack", str(scenario_file), "--plan", str(plan), *wanted]) == 130
    printed = capsys.readouterr()
    assert len(printed.err.splitlines()) == 1
    assert "interrupted" in printed.err
    assert asked == list(COMMAND)[: list(COMMAND).index(interrupted) + 1]
    if is_caught or interrupted != "attack_survey":
        found = json.loads(printed.out)
        assert found["attacks"]["worst"]["lower"] <= found["attacks"]["worst"]["upper"]
    else:
        assert printed.out == ""


def test_the_report_says_that_its_proof_is_not_finished_until_it_is(
    scenario_file: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """What a kill during the certificate leaves."""
    out, seen = tmp_path / "o", []

    def looking(real: Callable[..., Any]) -> Callable[..., Any]:
        def look(*given: Any) -> Any:
            seen.append(_report(out)["certificate"])
            return real(*given)

        return look

    certifying.step(monkeypatch, "writing", looking)
    assert run(["bound", str(scenario_file), "--out", str(out)]) == 0
    assert "not finished when this report was written" in seen[0]["reason"]
    assert _report(out)["certificate"]["verified"] is True
