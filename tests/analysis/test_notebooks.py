"""Notebooks against what is stored: what counts as another output, and what all of them have."""

import json

import pytest

from analysis.notebooks import FOLDER, HEAD, Agreement, differences, outputs

NOTEBOOKS = sorted(FOLDER.glob("*.ipynb"))


def printed(*texts: str, name: str = "stdout") -> list[tuple[int, str, str]]:
    streams = [{"output_type": "stream", "name": name, "text": text} for text in texts]
    return list(outputs({"cells": [{"outputs": streams}]}))


@pytest.mark.parametrize(
    ("stored", "found", "is_same"),
    [
        ("1.5 m\n", "1.5 m\n", True),
        ("1.5000001 m\n", "1.5 m\n", True),
        ("1.5 m\n", "1.6 m\n", False),
        ("12 of 12 cases\n", "11 of 12 cases\n", False),
        ("| a | 1 | holds |", "| a | 1 | does not hold |", False),
        ("-1e-3", "1e-3", False),
    ],
)
def test_words_agree_exactly_and_numbers_closely(stored: str, found: str, is_same: bool) -> None:
    assert (differences(printed(stored), printed(found), Agreement()) == []) is is_same


def test_a_slow_machine_prints_in_pieces() -> None:
    assert printed("one\n", "two\n") == printed("one\ntwo\n")


def test_reading_outputs_leaves_them_as_they_are() -> None:
    streams = [{"output_type": "stream", "name": "stdout", "text": text} for text in ("one\n", "two\n")]
    notebook = {"cells": [{"outputs": streams}]}
    assert list(outputs(notebook)) == list(outputs(notebook)) == [(0, "stdout", "one\ntwo\n")]


def test_progress_does_not_count() -> None:
    assert printed("7 of 10 trials", name="stderr") == []


def test_a_picture_that_is_missing_is_named() -> None:
    picture = {"cells": [{"outputs": [{"output_type": "display_data", "data": {"image/png": "x"}}]}]}
    assert "differ in kind" in differences(list(outputs(picture)), [], Agreement())[0]


@pytest.mark.parametrize("file", NOTEBOOKS, ids=lambda file: file.stem)
def test_each_is_stored_with_its_verdicts_and_imports_no_study(file) -> None:
    notebook = json.loads(file.read_text(encoding="utf-8"))
    shown = list(outputs(notebook))
    assert any(text.startswith(f"| {' | '.join(HEAD)} |") for _, _, text in shown), "no verdicts"
    code = ["".join(cell["source"]) for cell in notebook["cells"] if cell["cell_type"] == "code"]
    assert not [source for source in code if "from analysis" in source or "import analysis" in source]
    assert not [text for cell, _, text in shown if "Traceback" in text]
