"""What every refusal of the command line looks like."""

import pytest

from ratt_opt.cli import run


def refused(arguments: list[str], capsys: pytest.CaptureFixture[str], text: str) -> None:
    assert run(arguments) == 2
    shown = capsys.readouterr().err
    assert text.lower() in shown.lower()
    assert shown.startswith("error: ")
    assert shown.count("\n") == 1
