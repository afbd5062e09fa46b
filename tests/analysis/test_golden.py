"""The golden corpus: its comparison notices what it is for, and a sample of it is answered as it was."""

import pytest

from analysis.golden.comparison import apart, compared, lost, read_rows
from analysis.golden.corpus import PARTS, cases, get_case
from analysis.golden.measure import measured
from analysis.golden.sample import sample
from analysis.tables import append_csv
from tests.documents import ROOT

RECORD = ROOT / "tests" / "golden"
SECONDS = 20.0
"""Of the record of the sample that is asked again."""


def row(case="a", *, part="plans", asked="plan", lower=1.0, upper=1.0, cpu_s=1.0, plan="p", nodes=3):
    ends = {"lower": str(lower), "upper": str(upper), "stop": "gap", "nodes": "9", "cpu_s": str(cpu_s)}
    limited = {"limited_lower": "0.5", "limited_upper": "2.0", "limited_nodes": str(nodes)}
    proof = {"proof_bytes": "", "write_s": "", "verify_s": ""}
    return {(part, case): {"part": part, "case": case, "asked": asked, "plan": plan, **ends, **limited, **proof}}


def test_brackets_with_no_value_in_common_are_found():
    then = row(lower=1.0, upper=2.0) | row("b", lower=1.0, upper=2.0)
    now = row(lower=2.5, upper=3.0) | row("b", lower=2.0, upper=3.0)
    assert apart(then, now) == [("plans", "a")]
    assert apart(now, then) == [("plans", "a")]


def test_attacks_on_another_plan_are_no_contradiction():
    then = row(asked="attack", lower=1.0, upper=2.0)
    now = row(asked="attack", lower=3.0, upper=4.0, plan="q")
    assert apart(then, now) == []
    assert compared(then, now)[0]["other_plan"] == 1


def test_what_is_lost_gained_and_slower_is_counted():
    then = row("lost", cpu_s=1.0) | row("gained", lower=0.5, cpu_s=4.0) | row("open", lower=0.5) | row("gone")
    now = row("lost", lower=0.75, cpu_s=4.0) | row("gained", cpu_s=1.0, nodes=4) | row("open", lower=0.75)
    (line,) = compared(then, now)
    assert lost(then, now) == [("plans", "lost")]
    assert (line["cases"], line["closed_then"], line["closed_now"], line["lost"]) == (3, 1, 1, 1)
    assert line["seconds_ratio"] == pytest.approx(1.0)
    assert line["gap_ratio"] == pytest.approx((0.25 / 1e-6 * 1e-6 / 0.5 * 0.25 / 0.5) ** (1 / 3))
    assert line["same_nodes"] == "2 of 3"
    assert line["proof_ratio"] == ""


def test_rows_are_read_as_they_were_written_and_the_last_one_counts(tmp_path):
    first, second = row(cpu_s=1.0), row(cpu_s=2.0)
    for rows in (first, second):
        append_csv(tmp_path / "plans.csv", rows["plans", "a"])
    assert read_rows(tmp_path, PARTS) == second


def test_names_are_unique_and_the_record_knows_every_case():
    names = [(case.part, case.name) for case in cases()]
    assert len(set(names)) == len(names)
    assert set(read_rows(RECORD, PARTS)) == set(names)


def test_a_sample_is_answered_as_it_was():
    """Brackets share a value with those recorded, and what was closed long before its limit is closed."""
    recorded = read_rows(RECORD, PARTS)
    chosen = set(sample([(case.part, case.name) for case in cases()], recorded, SECONDS))
    assert {part for part, _ in chosen} == set(PARTS)
    now = {}
    for case in cases():
        if (case.part, case.name) in chosen:
            found = measured(case)
            now[case.part, case.name] = {name: str(value) for name, value in found.items()}
    for key in lost(recorded, now):  # its first run may have loaded modules within its limit
        now[key] = {name: str(value) for name, value in measured(get_case(*key)).items()}
    assert not apart(recorded, now)
    assert not lost(recorded, now)
