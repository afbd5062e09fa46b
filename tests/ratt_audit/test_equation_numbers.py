"""Lines of the ledger carry the numbers that the paper prints."""

from pathlib import Path

from ratt_audit.appendix.printed import equation_number, numbered, printed_lines

LABELS = (Path(__file__).parent / "appendix_labels.txt").read_text(encoding="utf-8").split()


def test_every_line_of_the_appendix_has_the_next_number() -> None:
    """Each numbered line has a label, so the numbers of the labels in the order of the document have no gap."""
    labels = [label.removeprefix("eq:") for label in LABELS if label.startswith("eq:")]
    assert [equation_number(label) for label in labels] == list(range(10, 10 + len(labels)))
    assert set(printed_lines()) <= set(labels)


def test_the_theorem_s_bounds_are_8_and_9() -> None:
    """Section V prints them after curvature (6) and total curvature (7), before the appendix begins with (10)."""
    assert numbered("eqn:appro_non_descrease") == "eqn:appro_non_descrease (8)"
    assert equation_number("eqn:appro_submodular") == 9
    assert numbered("pattern_free_nd") == "pattern_free_nd"
