"""Sizes, patterns and smallest teams: against direct counts, and verdicts that can change."""

import pytest

from ratt_audit.appendix.readings import SETTINGS
from ratt_audit.engine.decide import Verdict
from ratt_audit.enumeration.arrangement_claims import (
    arrangement_entries,
    arrangements,
    first_occurrence,
    is_pattern1,
    is_pattern2,
    smallest_team_entries,
)
from ratt_audit.enumeration.setting import Setting, caa_groups, counted, splits
from ratt_audit.enumeration.size_claims import size_entries

SIZES = {entry.label: entry for entry in size_entries()}
OCCURS = {entry.label: entry for entry in smallest_team_entries()}


def test_a_printed_size_that_fails_has_a_repair_that_holds() -> None:
    verdicts = {label: entry.enumerate_cases().verdict for label, entry in SIZES.items()}
    refuted = {label for label, verdict in verdicts.items() if verdict is Verdict.REFUTED}
    assert refuted == {"nd_p1d3v1_sizes", "nd_p1d3v1_4_counts", "sub_p2d1v1_sizes", "bound_defined"}
    for label in refuted - {"bound_defined"}:
        assert verdicts[f"{label}_repaired"] is Verdict.PROVED
        assert str(SIZES[label].serves_by) == f"{label}_repaired/claim"


@pytest.mark.parametrize(
    ("label", "smallest"),
    [
        ("nd_p1d1_occurs", (3, 1, 2)),
        ("nd_p1d2_occurs", (3, 1, 2)),
        ("nd_p1d3_occurs", (4, 2, 3)),
        ("nd_p2d1_occurs", (4, 1, 4)),
        ("nd_p2d2_occurs", (4, 1, 4)),
        ("nd_p2d3_occurs", (5, 2, 6)),
        ("nd_p2d2v2_dominance_occurs", SETTINGS[2]),
        ("nd_p2d3v2_dominance_occurs", SETTINGS[3]),
    ],
)
def test_the_smallest_team_of_each_distribution(label: str, smallest: tuple[int, int, int]) -> None:
    """The ledger decides dominance at exactly the smallest team at which its premises hold."""
    found = OCCURS[label].enumerate_cases()
    assert found.verdict is Verdict.PROVED
    n_robots, alpha_s, alpha_c = smallest
    assert f"N = {n_robots}, alpha_s = {alpha_s}, alpha_c = {alpha_c}," in found.detail


def test_what_never_occurs_is_refuted() -> None:
    assert first_occurrence(lambda *_: False).verdict is Verdict.REFUTED


def test_an_enumeration_of_nothing_proves_nothing() -> None:
    assert counted([], "none", "items").verdict is Verdict.UNDECIDED


def test_the_example_of_the_figures_by_hand() -> None:
    """N = 10, alpha_s = 2, alpha_c = 29: n_max = 5, so 7 baits; CAA's groups (5, 5) cut 25 links."""
    setting = Setting(10, 2, 29)
    assert (setting.n_max, setting.alpha_cs, setting.alpha, setting.n_greedy) == (5, 5, 7, 3)
    assert caa_groups(10, 29) == (5, 5)
    assert (5, 5) in splits(10, 25, 5)
    assert splits(10, 24, 5) == []
    assert set(arrangements(setting)) == {((5, 0), (2, 3)), ((4, 1), (3, 2))}
    assert is_pattern1(((5, 0), (2, 3)), setting)
    assert is_pattern2(((4, 1), (3, 2)), setting)


def test_patterns_do_not_cover_all_arrangements() -> None:
    found = next(e for e in arrangement_entries() if e.label == "patterns_cover").enumerate_cases()
    assert found.verdict is Verdict.REFUTED
    assert found.cases[0].endswith("groups 1 bait + 1 greedy, 0 bait + 1 greedy")
