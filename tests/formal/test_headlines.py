"""Every theorem that formal/README.md names is one whose assumptions are printed and checked, and exists."""

import re
from pathlib import Path

from tests.formal.definition_mutants import CHANGES

FORMAL = Path(__file__).parents[2] / "formal"


def test_theorems_named_in_the_readme_are_checked():
    rows = [line for line in (FORMAL / "README.md").read_text().splitlines() if line.startswith("| `")]
    named = {name for row in rows for name in re.findall(r"`(\w+)`", row.split("|")[1])}
    asked = set(re.findall(r"^Print Assumptions (\w+)\.$", (FORMAL / "theories" / "Assumptions.v").read_text(), re.M))
    stated = {
        name
        for path in (FORMAL / "theories").glob("*.v")
        for name in re.findall(r"^(?:Theorem|Lemma) (\w+)", path.read_text(), re.M)
    }
    assert len(named) >= 15
    assert named <= asked <= stated


def test_no_proof_is_left_open():
    words = re.compile(r"\b(Admitted|admit|Axiom|Axioms|Parameter|Parameters|Conjecture|Abort)\b")
    for path in (FORMAL / "theories").glob("*.v"):
        assert not words.search(path.read_text()), path.name


def test_the_readme_counts_the_changes_of_definitions():
    assert f"({len(CHANGES)} changes of" in (FORMAL / "README.md").read_text()
