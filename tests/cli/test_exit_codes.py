"""What programs rely on: exit codes, closed and full outputs, faults of the program, text that is only text."""

import io
import json
import os
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from rich.table import Table

from ratt_opt import InputError, LogDetObjective, Problem, certify, solve_maxmin
from ratt_opt.cli import run
from ratt_opt.cli.terminal import print_tables
from ratt_opt.errors import printable

PROGRAM = [sys.executable, "-c", "from ratt_opt.cli import main; main()"]


@pytest.fixture(scope="module")
def certificate(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A certificate of two robots with two elements each."""
    path = tmp_path_factory.mktemp("certificate") / "c.json"
    problem = Problem(LogDetObjective([[[2.0]]], [[[[k]]] for k in (1.0, 2.0, 3.0, 4.0)]), [0, 0, 1, 1], None, 1, 0)
    certify(problem, solve_maxmin(problem), path)
    return path


def test_verify_tells_proved_refuted_unreadable_half_proved_and_undecided_apart(
    certificate: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    document = json.loads(certificate.read_text())

    def code(changed: dict[str, Any], *options: str) -> int:
        path = tmp_path / "x.json"
        path.write_text(json.dumps(changed))
        return run(["verify", str(path), *options])

    assert code(document) == 0
    assert code(document | {"claim": document["claim"] | {"upper": document["claim"]["upper"] / 2}}) == 1
    assert code(document | {"version": 7}) == 2
    assert code(document | {"lower": {"conclusion": "enumerated"}}) == 3
    capsys.readouterr()
    assert code(document, "--time-limit", "1e-9") == 4
    assert capsys.readouterr().err == "error: not decided within 1e-09 s\n"
    assert code(document, "--time-limit", "0") == 2


@pytest.fixture
def full_output() -> Iterator[Any]:
    if not os.path.exists("/dev/full"):
        pytest.skip("no full device here")
    with open("/dev/full", "w") as stream:
        yield stream


def test_an_output_that_takes_nothing_is_no_verdict(certificate: Path, full_output: Any) -> None:
    """Neither 0 (proved), 1 (refuted), 2 nor 3: the verdict did not arrive."""
    read, wrote = os.pipe()
    os.close(read)
    command = [*PROGRAM, "verify", str(certificate)]
    for stdout in (wrote, full_output):
        done = subprocess.run(command, stdout=stdout, stderr=subprocess.PIPE, text=True, check=False)
        assert done.returncode == 74
        assert done.stderr.startswith("error: standard output does not take the result")
        assert done.stderr.count("\n") == 1
    os.close(wrote)


class _Full(io.StringIO):
    def flush(self) -> None:
        raise OSError(28, "No space left on device")


@pytest.mark.parametrize("words", [[], ["--help"], ["bound", "--help"], ["--version"], ["schema"]])
def test_what_no_output_takes_was_not_said(
    words: list[str], monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """Help too, which the library that parses the words would print in its own way."""
    assert run(words) == (0 if words else 2)
    assert capsys.readouterr().out
    for stream in (_Full(), None):
        with monkeypatch.context() as patch:
            patch.setattr(sys, "stdout", stream)
            assert run(words) == 74
        shown = capsys.readouterr().err
        assert shown.startswith("error: standard output ")
        assert shown.count("\n") == 1


def test_no_command_is_help_and_one_line(capsys: pytest.CaptureFixture[str]) -> None:
    assert run([]) == 2
    shown = capsys.readouterr()
    assert shown.out.startswith("Usage: ratt-opt")
    assert shown.err == "error: command must be given; got none\n"


def test_without_any_stream_the_exit_code_is_all_there_is(certificate: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sys, "stderr", None)
    assert run(["verify", "none"]) == 2
    monkeypatch.setattr(sys, "stdout", None)
    assert run(["verify", str(certificate)]) == 74


def test_a_fault_of_the_program_is_one_line_and_a_file(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    def faulty(*_: Any, **__: Any) -> Any:
        raise ZeroDivisionError("some\nlines")

    monkeypatch.setattr("ratt_opt.scenario.files.load_input", faulty)
    assert run(["bound", "x.json", "--out", str(tmp_path)]) == 70
    shown = capsys.readouterr().err
    assert shown.startswith("error: unexpected ZeroDivisionError: some lines; this is a fault of ratt-opt")
    assert shown.count("\n") == 1
    (kept,) = tmp_path.iterdir()
    assert str(kept) in shown
    assert "in faulty" in kept.read_text()


def test_an_interrupt_that_another_error_hides_is_an_interrupt(monkeypatch: pytest.MonkeyPatch) -> None:
    """Imports turn a KeyboardInterrupt into errors of their own."""
    import signal

    def hidden(*_: Any, **__: Any) -> Any:
        try:
            signal.raise_signal(signal.SIGINT)
        except KeyboardInterrupt:
            raise AttributeError("half an import") from None

    monkeypatch.setattr("ratt_opt.scenario.files.load_input", hidden)
    assert run(["bound", "x.json", "--out", "o"]) == 130


def test_text_from_users_is_shown_as_text(capsys: pytest.CaptureFixture[str]) -> None:
    table = Table("label")
    for label in ("[red]stop[/red]", "[/]", ":smile:", "[link=x]"):
        table.add_row(label)
    print_tables([table])
    shown = capsys.readouterr().out
    assert all(label in shown for label in ("[red]stop[/red]", "[/]", ":smile:", "[link=x]"))
    assert printable("a\x1b[31m\u202eb\ud800\x00\n c") == "a\\x1b[31m\\u202eb\\ud800\\x00 c"
    for error in (InputError("\x1b[2J", "must be", "x"), InputError("x", "must be", "\u200f\ud8ff")):
        assert str(error).isprintable()


@pytest.mark.parametrize(
    ("value", "shown"),
    [
        *((text, f"'{text}'") for text in ("1", "1.5e3", "NaN", "True", " a", "")),
        *((value, str(value)) for value in ("a1", "3 rows", "none", 1, None, ["1"])),
    ],
)
def test_text_that_reads_as_another_value_is_quoted(value: object, shown: str) -> None:
    assert str(InputError("x", "must be", value)) == f"x must be; got {shown}"


def test_names_of_files_are_shown_as_text(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    for name in ("\x1b[2Jx", "\u202ex", "\udc80x", "[/b]x", "a\0b"):
        assert run(["bound", str(tmp_path / name), "--out", str(tmp_path / "o")]) == 2
        shown = capsys.readouterr().err
        assert shown.count("\n") == 1
        assert shown[:-1].isprintable()
