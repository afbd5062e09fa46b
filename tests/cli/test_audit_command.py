"""``ratt-opt audit`` as a stranger uses it: files, progress on a terminal, an interrupt that keeps what was decided."""

import json
import os
import pty
import re
import signal
import subprocess
import sys
from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path

import pytest

from ratt_audit import ledger
from ratt_audit.entries import all_entries
from ratt_opt.cli import run

LABELS = ("nd_p1d1v1_7", "nd_p1d1v1_8", "nd1")


@pytest.fixture
def short(monkeypatch: pytest.MonkeyPatch) -> None:
    entries = [entry for entry in all_entries() if entry.label in LABELS]
    monkeypatch.setattr(ledger, "all_entries", lambda: iter(entries))


@pytest.mark.usefixtures("short")
def test_audit_writes_three_files_and_prints_counts(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert run(["audit", "--out", str(tmp_path / "a"), "--quick"]) == 0
    assert sorted(path.name for path in (tmp_path / "a").iterdir()) == ["audit.html", "audit.json", "audit.md"]
    shown = capsys.readouterr()
    document = json.loads((tmp_path / "a" / "audit.json").read_text(encoding="utf-8"))
    assert document["complete"]
    assert {entry["label"] for entry in document["entries"]} == set(LABELS)
    assert "refuted" in shown.out
    assert "Whose worst attack is A*? A* is worst within the group of the line here" in shown.out
    assert shown.err == ""  # progress is for terminals
    assert "\x1b" not in shown.out


@pytest.mark.usefixtures("short")
def test_audit_as_json(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert run(["audit", "--out", str(tmp_path), "--quick", "--json"]) == 0
    printed = json.loads(capsys.readouterr().out)
    assert sum(printed["counts"].values()) == printed["entries"]


def test_ctrl_c_keeps_what_is_decided(tmp_path: Path) -> None:
    command = [sys.executable, "-c", "from ratt_opt.cli import main; main()", "audit", "--quick", "--out", "o"]
    folder = tmp_path / "o"
    master, terminal = pty.openpty()
    with subprocess.Popen([*command[:-1], str(folder)], stdout=subprocess.PIPE, stderr=terminal) as process:
        os.close(terminal)
        shown = ""
        while not (at := re.findall(r"(\d+)/\d+ ", shown)) or int(at[-1]) < 8:
            shown += os.read(master, 1000).decode()
        process.send_signal(signal.SIGINT)
        rest = "".join(read_rest(master))
    assert process.returncode == 130
    assert "interrupted after" in rest
    assert "Traceback" not in rest
    document = json.loads((folder / "audit.json").read_text(encoding="utf-8"))
    assert not document["complete"]
    assert len(document["entries"]) >= 7


def read_rest(master: int) -> Iterator[str]:
    """What is still written to a terminal until the program ends."""
    with suppress(OSError):  # Linux says so where others say end of file
        while chunk := os.read(master, 1000):
            yield chunk.decode()
