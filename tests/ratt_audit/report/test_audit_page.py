"""The page on the audit: numbers from the ledger and the library, and no page from half a ledger."""

import json
import re
from fractions import Fraction
from pathlib import Path
from typing import Any

import pytest

from analysis import audit_page
from analysis.audit_page import main, page, ratio_table, realistic_table, record, theorem1
from ratt_audit.whole.recorded import recorded_lines
from ratt_opt import theorem1_bound
from tests.documents import ROOT


def refuted(label: str, **found: Any) -> dict[str, Any]:
    head = {"label": label, "kind": "step", "reading": "", "verdict": "refuted", "chain": "a", "statement": "s"}
    realistic = {"objective": "trace", "section_vi_instances": 40, "section_vi_violations": 3, **found}
    return {**head, "sizes": "z", "hypotheses": "h", "claims": [], "realistic": realistic}


BROKEN = refuted("x_1", worst={"relative_violation": 0.25, "violated_exactly": True})
KEPT = refuted("x_2", section_vi_violations=0, worst={"relative_violation": -0.5, "violated_exactly": False})


def document(**more: Any) -> dict[str, Any]:
    counts = {"proved": 0, "refuted": 2}
    return {"entries": [BROKEN, KEPT], "counts": counts, "seconds": 1.0, "complete": True, "quick": False, **more}


def test_the_realistic_table_reads_the_records() -> None:
    table = realistic_table(document()).table
    assert table[1:] == (
        ("x_1, step", "trace", "3 of 40", "broken by 0.25"),
        ("x_2, step", "trace", "0 of 40", "not broken, margin 0.5"),
    )


def test_the_ratio_table_holds_exact_values_known_by_hand() -> None:
    """Three robots, one blinded, submodular with k = 1/2: 5/8 ; Theorem 1 gives 1/3."""
    row = ratio_table((("submodular", 3, 1, 0),)).table[1]
    assert row[:5] == ("submodular", "3", "1", "0", "5/8")
    assert row[-2:] == ("1/3", "1/2")


def test_the_page_is_written_from_the_ledger(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(audit_page, "CASES", (("submodular", 2, 1, 0),))
    (tmp_path / "audit.json").write_text(json.dumps(document()), encoding="utf-8")
    main(["--ledger", str(tmp_path), "--out", str(tmp_path / "page.md"), "--figure", "curves.png"])
    text = (tmp_path / "page.md").read_text(encoding="utf-8")
    assert "2 entries: 0 proved, 2 refuted" in text
    assert "broken by 0.25" in text
    assert "(curves.png)" in text
    assert page(document(), ratio_table(()), "").count("curves.png") == 0


@pytest.mark.parametrize("state", [{"quick": True}, {"complete": False}])
def test_no_page_from_half_a_ledger(tmp_path: Path, state: dict[str, bool], capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "audit.json").write_text(json.dumps(document(**state)), encoding="utf-8")
    with pytest.raises(SystemExit):
        main(["--ledger", str(tmp_path), "--out", str(tmp_path / "page.md")])
    assert "quick or interrupted" in capsys.readouterr().err
    assert not (tmp_path / "page.md").exists()


def test_pages_name_the_steps_that_the_ledger_says_fail() -> None:
    """Names stand on three pages; the first is written from the ledger."""
    text = (ROOT / "docs" / "researchers" / "audit.md").read_text(encoding="utf-8")
    outcome = re.search(r"\| fails in every reading \| (\d+) \| (.*?) \|", text)
    assert outcome is not None
    labels = re.sub(r" \(\d+\)", "", outcome[2]).replace("\\", "").split(", ")  # numbers are of equations
    assert len(labels) == int(outcome[1]) > 0
    for name in ("README.md", "docs/researchers/evaluation.md"):
        text = (ROOT / name).read_text(encoding="utf-8")
        assert set(re.findall(r"`((?:nd|sub)_p\w+)`", text)) == set(labels)


@pytest.mark.parametrize("alpha_cs", [0, 1, 2, 5])
@pytest.mark.parametrize("value", [Fraction(0), Fraction(3, 10), Fraction(1)])
def test_theorem_1_as_the_library_states_it(alpha_cs: int, value: Fraction) -> None:
    assert float(theorem1("submodular", value, alpha_cs)) == pytest.approx(theorem1_bound(alpha_cs, k=float(value)))
    assert float(theorem1("nondecreasing", value, alpha_cs)) == pytest.approx(theorem1_bound(alpha_cs, c=float(value)))


def test_decisions_are_recorded_as_they_are_read(tmp_path: Path) -> None:
    lines: list[Any] = [
        line
        | {
            "instance": None if line["values"] is None else {"values": line["values"]},
            "teams": [{"team": team, "verdict": verdict} for team, verdict in line["teams"]],
        }
        for line in recorded_lines()
    ]
    record(lines, tmp_path / "recorded.json")
    assert json.loads((tmp_path / "recorded.json").read_text(encoding="utf-8")) == list(recorded_lines())
