"""What every refusal of the command line looks like."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ratt_opt.cli import run

if TYPE_CHECKING:
    import pytest


def refused(arguments: list[str], capsys: pytest.CaptureFixture[str], text: str) -> None:
    assert run(arguments) == 2
    shown = capsys.readouterr().err
    assert text.lower() in shown.lower()
    assert shown.startswith("error: ")
    assert shown.count("\n") == 1
