"""The linter of the English of pages, docstrings and messages: it finds what it should, and nothing is left."""

import json
from pathlib import Path

import pytest

from analysis import prose

LONG = " ".join(["word"] * prose.LONGEST)


def advice(folder: Path, name: str, text: str) -> list[str]:
    file = folder / name
    file.write_text(text, encoding="utf-8")
    return [finding.advice for finding in prose.findings([file])]


def test_nothing_is_left_to_say_plainly() -> None:
    assert [str(finding) for finding in prose.findings(prose.readable_files())] == []


@pytest.mark.parametrize(
    "sentence",
    [
        "Sequences than which another is nowhere worse are dropped.",
        "Robots that are no unicycles come in another way.",
        "A checker that believes nobody reads it.",
        "The whole belief, whose belief lives on, is used.",
        "So many robots as there are links.",
        "A value, where none is known, is left out.",
        "It is large, where such words help.",
        "It is None where there is none.",
        "What the plan keeps is shown.",
        "No planner keeps more than that.",
        "Groups of three seeing robots.",
        "Whoever calls it is asked for a number.",
        "The search is over but for one case.",
        f"{LONG} more.",
        "If a holds, and if b holds, then c holds unless d does.",
    ],
)
@pytest.mark.parametrize("kind", ["page.md", "module.py", "message.py"])
def test_words_and_long_sentences_are_found(sentence: str, kind: str, tmp_path: Path) -> None:
    text = {
        "page.md": f"# Title\n\n{sentence}\n",
        "module.py": f'"""{sentence}"""\n',
        "message.py": f'x = "{sentence}"\n',
    }
    counted = sentence.startswith(("word", "If a"))
    assert bool(advice(tmp_path, kind, text[kind])) is not (counted and kind == "message.py")


@pytest.mark.parametrize(
    "text",
    [
        '"""What a plan keeps."""',
        'def _f():\n    """Whether it is so."""',
        'A = 1\n"""Of the time left, a share."""',
        "# Those that are left\nx = 1",
        "x = 1  # How far it is",
    ],
)
def test_docstrings_and_comments_that_begin_with_a_fragment_are_found(text: str, tmp_path: Path) -> None:
    assert len(list(prose.fragments(text, tmp_path))) == 1


@pytest.mark.parametrize(
    "text",
    [
        '"""Value of a plan."""\n# Choose the plan\n# of largest value\nx = 1',
        "# Only one is left here, and\n# What begins a later line of a comment does not count\nx = 1",
        'x = "What it says"',
    ],
)
def test_complete_phrases_are_left_alone(text: str, tmp_path: Path) -> None:
    assert list(prose.fragments(text, tmp_path)) == []


@pytest.mark.parametrize(
    "text",
    [
        "Drop dominated sequences.",
        "The page says where the proof is.",
        "`None where there is none` is code.",
        "[a link](so-many/where-none.md) leads there.",
        "```python\nso_many = 'than which'\n```",
        f"{LONG}: {LONG}.",
        f"| {LONG} | {LONG} |",
        "A closed form.",
    ],
)
def test_plain_sentences_code_and_links_pass(text: str, tmp_path: Path) -> None:
    assert advice(tmp_path, "page.md", f"{text}\n") == []


def test_a_house_word_passes_on_a_page_that_explains_it(tmp_path: Path) -> None:
    (found,) = advice(tmp_path, "page.md", "All brackets are closed.\n")
    assert "say what it means" in found
    assert advice(tmp_path, "page.md", "All brackets are closed.\n\n*Closed*: both ends meet.\n") == []
    assert advice(tmp_path, "page.md", "All are closed ([glossary](glossary.md)).\n") == []
    assert advice(tmp_path, "module.py", '"""All brackets are closed."""\n') == []


def test_findings_name_the_line(tmp_path: Path) -> None:
    file = tmp_path / "page.md"
    file.write_text("# Title\n\nGood.\nStill good,\nbut so many words.\n\n| a | b |\n| - | - |\n| so many | b |\n")
    assert [finding.line for finding in prose.findings([file])] == [5, 9]


def test_private_docstrings_and_messages_are_read(tmp_path: Path) -> None:
    text = 'def _f():\n    """Drop so many."""\n    raise ValueError("so many more")\n'
    assert len(advice(tmp_path, "module.py", text)) == 2


def test_the_command_prints_places_and_fails(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "page.md").write_text("So many.\n", encoding="utf-8")
    assert prose.main([str(tmp_path / "page.md")]) == 1
    assert 'page.md:1: "So many"' in capsys.readouterr().out
    (tmp_path / "page.md").write_text("Many.\n", encoding="utf-8")
    assert prose.main([str(tmp_path / "page.md")]) == 0


def test_cells_of_text_in_a_notebook_are_read(tmp_path: Path) -> None:
    cells = [
        {"cell_type": "code", "source": ["x = 'so many'\n"]},
        {"cell_type": "markdown", "source": ["# Title\n", "\n", "So many words.\n"]},
    ]
    (tmp_path / "a.ipynb").write_text(json.dumps({"cells": cells}, indent=1), encoding="utf-8")
    (found,) = prose.findings([tmp_path / "a.ipynb"])
    assert found.advice.startswith('"So many"')
    text = (tmp_path / "a.ipynb").read_text(encoding="utf-8").split("\n")
    assert "So many words" in text[found.line - 1]
