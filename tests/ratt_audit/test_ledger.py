"""The ledger: every label, verdicts that are computed, files that others can read."""

import json
import re
from fractions import Fraction
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from ratt_audit import ledger as ledger_module
from ratt_audit.appendix.entry import ClaimEntry, Entry
from ratt_audit.appendix.misprints import MISPRINTS
from ratt_audit.decisions import decide_entry
from ratt_audit.entries import all_entries
from ratt_audit.report.pages import html_report, markdown_report
from ratt_opt import InputError, TableFunction, run_audit

HERE = Path(__file__).parent
PAPER = HERE.parents[2] / "shared" / "paper" / "ratt.tex"
LABELS = (HERE / "appendix_labels.txt").read_text(encoding="utf-8").split()
ENTRIES = list(all_entries())


def find(label: str, kind: str, reading: str = "") -> Entry:
    return next(e for e in ENTRIES if e.label == label and e.kind == kind and e.reading.startswith(reading))


def decided(label: str, kind: str, reading: str = "") -> dict[str, Any]:
    return decide_entry(find(label, kind, reading), quick=True)


def test_the_committed_labels_are_the_paper_s() -> None:
    if not PAPER.exists():
        pytest.skip("the paper's source is not beside the repository")
    appendix = PAPER.read_text(encoding="utf-8").split("\\appendices")[1]
    text = "\n".join(line for line in appendix.splitlines() if not line.lstrip().startswith("%"))
    labels = dict.fromkeys(re.findall(r"\\label\{([^}]*)\}", text))
    assert [label for label in labels if not label.startswith("sec:")] == LABELS


@pytest.mark.parametrize("label", LABELS)
def test_every_label_of_the_appendix_is_an_entry(label: str) -> None:
    name = label.removeprefix("eq:")
    kinds = {entry.kind for entry in ENTRIES if entry.label == name}
    assert kinds
    if label.startswith(("eq:nd", "eq:sub")):
        assert {"step", "cumulative"} <= kinds


def test_both_theorems_and_the_pattern_free_ones_are_entries() -> None:
    labels = {entry.label for entry in ENTRIES}
    theorems = {"eqn:appro_non_descrease", "eqn:appro_submodular", "thm:ratt_run_time"}
    assert theorems | {"pattern_free_nd", "pattern_free_sub"} <= labels


def test_entries_are_told_apart_by_label_kind_and_reading() -> None:
    names = [(entry.label, entry.kind, entry.reading) for entry in ENTRIES]
    assert len(names) == len(set(names))


def test_an_equality_of_the_paper_is_decided_both_ways() -> None:
    entry = find("nd_p1d1vk_3", "step as equality")
    used = find("nd_p1d1vk_3", "step")
    assert isinstance(entry, ClaimEntry)
    assert isinstance(used, ClaimEntry)
    assert len(entry.claims) == 2 * len(used.claims)


@pytest.mark.parametrize(
    ("label", "kind", "reading", "verdict"),
    [
        ("nd_p1d1v1_7", "step", "", "proved"),
        ("nd_p1d1v1_8", "step", "A* hurts RATT", "refuted"),
        ("nd_p1d1v1_8", "step", "A* hurts the optimum", "proved"),
        ("nd_p1d1v1_8", "cumulative", "A* hurts RATT", "proved"),
        ("nd_p1d2v1_8", "step", "", "refuted"),
        ("nd_p1d2v1_9", "cumulative", "", "proved"),
        ("nd_p1d1vk_3", "step as equality", "u*_i is what the optimal plan", "refuted"),
        ("nd_p1d1vk_3", "step as equality", "u*_W is optimal for W", "proved"),
        ("nd_p1d2v1_4", "step as equality", "u*_W is optimal for W", "proved"),
        ("team_subgroup", "step as equality", "A* is the optimum", "proved"),
        ("worst_case_left_side", "claim", "A* is the plan", "proved"),
        ("worst_case_left_side", "claim", "A* is the optimum", "refuted"),
        ("nd_p1_d1", "step", "", "proved"),
        ("nd_p2d1v1", "step", "A* hurts RATT", "proved"),
        ("nd_p2d1v1", "claim", "A* hurts RATT", "refuted"),
        ("nd_p2d2v1", "step", "", "proved"),
        ("nd_p2d2v1", "claim", "", "refuted"),
        ("sub_p2d1v1_10", "step", "A* hurts RATT", "refuted"),
        ("sub_p2d1v1_10_additive", "claim", "", "refuted"),
        ("group_size_sub", "theorem", "", "proved"),
        ("group_size_nd", "theorem", "", "proved"),
        ("survivors_sub", "theorem", "", "proved"),
        ("survivors_nd", "theorem", "", "proved"),
        ("sub_p2d1v2_9", "cumulative", "", "proved"),
        ("nd_p2d2v2_dominance", "claim", "stated reason only; total", "refuted"),
        ("nd_p2d2v2_dominance", "claim", "stated reason only; submodular", "refuted"),
        ("nd_p2d2v2_dominance", "claim", "A* is the worst attack; total", "proved"),
        ("pattern_free_sub", "theorem", "", "proved"),
        ("pattern_free_nd", "theorem", "", "proved"),
        ("caa_largest_group", "claim", "", "proved"),
        ("nd1", "step", "from Patterns 1 and 2 alone", "refuted"),
        ("nd1", "step", "with the omitted patterns", "proved"),
    ],
)
def test_verdicts_that_are_known_by_hand(label: str, kind: str, reading: str, verdict: str) -> None:
    assert decided(label, kind, reading)["verdict"] == verdict


def test_what_is_judged_with_its_stated_reason_alone_is_a_claim_beside_the_step() -> None:
    """Sister lines are judged with the same premises: all of RATT's choices."""
    for label in ("nd_p2d1v1", "nd_p2d2v1", "nd_p2d3v1", "nd_p2d2v2", "nd_p1d3vk"):
        step, whole = find(label, "step"), find(label, "cumulative")
        assert isinstance(step, ClaimEntry)
        assert isinstance(whole, ClaimEntry)
        assert [sized.claim for sized in step.claims] == [sized.claim for sized in whole.claims]


def test_misprints_name_entries_that_differ() -> None:
    for one in MISPRINTS:
        assert one.printed != one.meant
        if one.label:
            assert {entry.label for entry in ENTRIES} >= {one.label, one.repaired}


def test_what_is_left_of_the_subadditivity_step_has_the_factor_known_by_hand() -> None:
    """Two single elements: f(ab) <= f(a) + f(b)/(1-c), attained with f(a) = f(b): factor 2(1-c)/(2-c)."""
    record = decide_entry(find("nd_p1d2v1_8", "step"))
    factors = {Fraction(str(item["curvature"])): item for item in record["best_factors"]}
    for c, item in factors.items():
        assert Fraction(item["factor"]) == 2 * (1 - c) / (2 - c)
        assert item["cannot_exceed_by_1/1000"]
    assert len(factors) == 3


def test_witnesses_replay_from_the_record_alone() -> None:
    """Rebuild the function from the JSON data and test monotonicity and total curvature by definition."""
    record = json.loads(json.dumps(decided("nd_p1d2v1_8", "step")))
    witness = next(claim["witness"] for claim in record["claims"] if claim["witness"])
    table = TableFunction(witness["values"]).table()
    n = len(witness["elements"])
    for x in range(n):
        without = np.array([mask for mask in range(1 << n) if not mask >> x & 1])
        marginals = table[without | 1 << x] - table[without]
        assert marginals.min() >= 0
        assert marginals.min() >= (1 - float(Fraction(witness["curvature"]))) * marginals.max() - 1e-9
    at = {name: 1 << e for e, name in enumerate(witness["elements"])}
    assert table[at["o(b1)"]] + table[at["o(g1)"]] < table[at["o(b1)"] | at["o(g1)"]]


@pytest.fixture(scope="module")
def sample() -> list[Entry]:
    return [
        find("nd_p1d1v1_8", "step", "A* hurts RATT"),
        find("nd_p1d1vk_4", "step"),
        find("nd1", "step", "from Patterns"),
        find("nd_p1d1vk_3", "step as equality"),
        find("tzoumas2018_lemma2", "lemma"),
    ]


def test_a_deleted_ledger_is_reproduced(tmp_path: Path, sample: list[Entry], monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(ledger_module, "all_entries", lambda: iter(sample))
    seen: list[str] = []
    documents = []
    for _ in range(2):
        ledger = run_audit(tmp_path / "out", quick=True, progress=lambda *at: seen.append(at[2]))
        text = (tmp_path / "out" / "audit.json").read_text(encoding="utf-8")
        documents.append(json.loads(text, parse_constant=pytest.fail))
        assert documents[-1]["counts"] == ledger.counts()
        for name in ("audit.json", "audit.html", "audit.md"):
            (tmp_path / "out" / name).unlink()
    for document in documents:
        document.pop("seconds")
        for record in document["entries"]:
            record.pop("seconds")
    assert documents[0] == documents[1]
    assert seen == [entry.label for entry in sample] * 2
    assert {record["verdict"] for record in documents[0]["entries"]} == {"proved", "refuted"}


def test_an_interrupt_keeps_what_is_decided(
    tmp_path: Path, sample: list[Entry], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(ledger_module, "all_entries", lambda: iter(sample))

    def stop(*at: object) -> None:
        if at[0] == 2:
            raise KeyboardInterrupt

    ledger = run_audit(tmp_path, quick=True, progress=stop)
    document = json.loads((tmp_path / "audit.json").read_text(encoding="utf-8"))
    assert not ledger.complete
    assert not document["complete"]
    assert len(document["entries"]) == 2
    assert "interrupted" in (tmp_path / "audit.md").read_text(encoding="utf-8")


def test_a_folder_that_cannot_be_written_is_one_clear_line(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    with pytest.raises(InputError, match="out must be a folder"):
        run_audit(tmp_path / "file")


def test_reports_escape_what_they_print() -> None:
    record = decided("nd_p1d2v1_8", "step")
    record["label"] = "<script>alert(1)</script>|*"
    document = {"complete": True, "seconds": 1.0, "counts": {"proved": 0, "refuted": 1}, "entries": [record]}
    html, markdown = html_report(document), markdown_report(document)
    assert "<script>" not in html
    assert "&lt;script&gt;" in html
    assert "<script>" not in markdown
    assert "\\|\\*" in markdown
    for text in (html, markdown):
        assert "smallest counterexample" in text
