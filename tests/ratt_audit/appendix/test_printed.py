"""The printed lines: one for each numbered line that the ledger decides, typeset, and letter for letter the paper's."""

import re
from pathlib import Path
from xml.etree import ElementTree

import pytest
from latex2mathml.converter import convert

from ratt_audit.appendix.entry import EntryKind
from ratt_audit.appendix.printed import Formula, printed_line
from ratt_audit.entries import all_entries

PAPER = Path(__file__).resolve().parents[4] / "shared" / "paper" / "ratt.tex"
LINES = sorted({entry.label for entry in all_entries() if entry.kind is EntryKind.STEP})
LAYOUT = re.compile(r"~?\\label\{.*?\}|\\hspace\{.*?\}|\\nonumber|[&~\s]|[.,;]$")


def letters(text: str) -> str:
    """A formula without layout."""
    text = LAYOUT.sub("", text.strip()).replace(r"\mb{", r"\mathbf{").replace(r"\mc{", r"\mathcal{")
    return re.sub(r"[.,;]$", "", re.sub(r"\\[lr]vert", "|", text))


def test_every_step_has_its_printed_line():
    assert LINES
    assert all(isinstance(printed_line(label), Formula) for label in LINES)
    assert printed_line("no such line") is None


@pytest.mark.parametrize("label", LINES)
def test_it_can_be_typeset_in_a_table(label):
    text = printed_line(label)
    assert "|" not in text
    assert ElementTree.fromstring(convert(text)).tag.endswith("math")


def test_it_is_what_the_paper_prints():
    if not PAPER.exists():
        pytest.skip("the paper's source is not beside the project")
    source = re.sub(r"(?<!\\)%.*", "", PAPER.read_text(encoding="utf-8"))
    found: dict[str, str] = {}
    for block in re.findall(r"\\begin\{(?:align|equation)\}(.*?)\\end\{(?:align|equation)\}", source, re.DOTALL):
        held = ""
        for line in re.split(r"\\\\(?![a-zA-Z])", block):
            held += line
            if named := re.search(r"\\label\{eqn?:(.*?)\}", line):
                found[named[1]], held = letters(held), ""
    assert {label: letters(printed_line(label)) for label in LINES} == {label: found[label] for label in LINES}
