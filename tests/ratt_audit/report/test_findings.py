"""The summary says what the records say: counts by hand on a small ledger, and no dangling references."""

from typing import Any

import pytest

from ratt_audit.appendix.entry import EntryName
from ratt_audit.entries import all_entries
from ratt_audit.report.findings import findings, line_outcomes
from ratt_audit.report.pages import html_report, markdown_report
from ratt_opt import run_audit


def record(label: str, kind: str, verdict: str, reading: str = "", **more: Any) -> dict[str, Any]:
    head = {"label": label, "kind": kind, "verdict": verdict, "reading": reading, "chain": "a", "statement": "s"}
    return {**head, "sizes": "two robots", "hypotheses": "h", "claims": [], "decided_by": "d", "seconds": 0.0, **more}


PLAN, OPTIMUM = "A* is the plan's worst attack", "A* is the optimum's worst attack"
FACTOR = {"curvature": "1/2", "factor": "2/3", "cannot_exceed_by_1/1000": True}
RECORDS = [
    record("eqn:appro_non_descrease", "theorem", "proved"),
    record("eqn:appro_submodular", "theorem", "proved"),
    record("x_1", "step", "proved"),
    record("x_1", "step as equality", "refuted", weaker_step_that_serves={"entry": "x_1/step", "verdict": "proved"}),
    record("x_1", "cumulative", "proved"),
    record("x_2", "step", "refuted", PLAN, best_factors=[FACTOR]),
    record("x_2", "step", "proved", OPTIMUM),
    record("x_3", "step", "proved", PLAN),
    record("x_3", "step", "refuted", OPTIMUM, conclusion_without_it={"entry": "x_3/cumulative", "verdict": "proved"}),
    record("x_4", "step", "refuted", follows_from="x_2"),
    record("x_4", "cumulative", "refuted"),
    record("worst_case_left_side", "claim", "refuted", OPTIMUM, best_factors=[]),
    record("x_5", "step", "proved", "as printed"),
    record("x_5", "step", "refuted", "for every set", best_factors=[]),
    record("x_5", "step as equality", "refuted", "one meaning", best_factors=[]),
    record("x_5", "step as equality", "proved", "another meaning"),
]


def document(records: list[dict[str, Any]]) -> dict[str, Any]:
    counts = {v: sum(r["verdict"] == v for r in records) for v in ("proved", "refuted")}
    return {"entries": records, "counts": counts, "seconds": 1.0, "complete": True}


def test_every_section_by_hand() -> None:
    sections = {section.heading: section for section in findings(document(RECORDS))}
    assert "Both bounds of Theorem 1 hold" in sections["Does the theorem survive?"].sentences[0]
    lines = sections["Which steps hold?"]
    assert {row[0]: row[1:] for row in lines.table[1:]} == {
        "holds in every reading": ("1", "all others"),
        "depends on whose worst attack A* is": ("2", "x_2, x_3"),
        "depends on another reading": ("1", "x_5"),
        "fails in every reading": ("1", "x_4"),
        "is printed with =, which holds in some reading only": ("1", "x_5"),
        "is printed with =, but holds with >= only": ("1", "x_1"),
    }
    assert line_outcomes(RECORDS)["fails in every reading"] == ["x_4"]
    assert lines.sentences[0] == "Of 5 numbered lines, 1 follow from the line before in every reading, 1 in none."
    assert "these lines fail in every reading: x_4" in lines.sentences[-1]
    readings = sections["Whose worst attack is A*?"]
    assert readings.table[1:] == (("x_2", "refuted", "proved", "-"), ("x_3", "proved", "refuted", "-"))
    assert readings.sentences[-2] == "So no single reading of A* makes every step hold."
    assert readings.sentences[-1].endswith("(worst_case_left_side) is refuted.")
    table = sections["Refuted, and what serves instead"].table
    repairs = {row[0].split(",")[0]: row[2:] for row in table[1:] if row[0] < "x_5" and row[0] > "x"}
    assert repairs == {
        "x_1": ("x_1, step (proved)", "-"),
        "x_2": ("factor 2/3 at curvature 1/2", "-"),
        "x_3": ("nothing weaker found", "proved"),
        "x_4": ("follows directly from x_2 (proved)", "-"),
    }


WHOLE = {"n_robots": 4, "alpha_s": 1, "alpha_c": 4, "curvature": "c = 1/2", "line": "f(a) >= 0", "violation": "2"}


def whole(label: str, worst_for: str, *teams: tuple[str, str]) -> dict[str, Any]:
    named = [{"team": f"N = {team[0]}, alpha_s = 1, alpha_c = 4; A*", "verdict": team[1]} for team in teams]
    found = WHOLE if any(verdict == "refuted" for _, verdict in teams) else None
    return {"label": label, "kind": "step", "worst_for": worst_for, "teams": named, "instance": found}


def test_whole_instances_are_counted_once_for_each_meaning_of_the_attack() -> None:
    records = [
        whole("x_2", "RATT's plan", ("3", "proved"), ("4", "not decidable here"), ("4", "refuted")),
        whole("x_2", "the optimum", ("3", "proved"), ("5", "not decidable here")),
        whole("x_3", "the optimum"),
    ]
    sections = {s.heading: s for s in findings({**document(RECORDS), "whole_instances": records})}
    section = sections["Which lines fail in whole instances?"]
    assert section.sentences[1:3] == (
        "If A* is a worst attack on RATT's plan, 1 step fails in whole instances (x_2).",
        "If A* is a worst attack on the optimum, 0 steps fail in whole instances.",
    )
    held = "holds in whole instances at (N, alpha_s, alpha_c) = (3, 1, 4)"
    assert section.table[1:] == (
        (
            "x_2, step",
            f"{held}; fails at (4, 1, 4), c = 1/2: f(a) >= 0 lacks 2",
            f"{held}; not decided at (5, 1, 4)",
        ),
        ("x_3, step", "-", "no team of the searched sizes has the pattern"),
    )


def test_a_refuted_theorem_is_not_said_to_hold() -> None:
    broken = [record("eqn:appro_non_descrease", "theorem", "refuted"), *RECORDS[1:]]
    assert findings(document(broken))[0].sentences == ()


def test_one_good_reading_is_not_said_to_be_missing() -> None:
    kept = [r for r in RECORDS if r["label"] != "x_3"]
    section = next(s for s in findings(document(kept)) if s.heading.startswith("Whose"))
    assert not any(sentence.startswith("So no single") for sentence in section.sentences)


def test_both_reports_carry_the_summary_escaped() -> None:
    marked = [{**r, "label": f"<{r['label']}>"} if r["label"] == "x_2" else r for r in RECORDS]
    for text in (html_report(document(marked)), markdown_report(document(marked))):
        assert "Which steps hold?" in text
        assert "no single reading of A" in text
        assert "<x_2>" not in text


def test_every_entry_named_as_survivor_or_stand_in_exists() -> None:
    entries = list(all_entries())
    names = {name for entry in entries for name in entry.names}
    for entry in entries:
        for name in (entry.survives_by, entry.serves_by):
            assert name is None or name in names, f"{entry.label} names {name}"
            assert name is None or EntryName.parse(str(name)) == name


@pytest.mark.slow
def test_every_refuted_step_has_something_that_serves(tmp_path: Any) -> None:
    ledger = run_audit(tmp_path)
    assert ledger.complete
    assert ledger.counts()["not decidable here"] == 0
    section = next(s for s in findings(ledger.document()) if s.heading.startswith("Refuted"))
    for name, _, instead, without in section.table[1:]:
        assert without == "proved", name
        assert "(proved)" in instead, name
