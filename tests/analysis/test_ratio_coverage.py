"""Tables of the worst-ratio page and of the paper's budgets: rows by hand, and nothing claimed that is not there."""

from __future__ import annotations

import re
from fractions import Fraction
from pathlib import Path

from analysis.paper_guarantees import row
from analysis.ratio_coverage import TABLES, budgets, row_of, table

ROOT = Path(__file__).parents[2]


def test_every_budget_that_leaves_a_robot_is_in_one_class() -> None:
    for n in range(2, 6):
        members = [pair for budget in budgets(n) for pair in budget.members]
        assert sorted(members) == [(s, c) for s in range(n) for c in range(n * (n - 1) // 2 + 1)]


def test_rows_by_hand() -> None:
    classes = {budget.members[0]: budget for budget in budgets(4)}
    split = row_of("nondecreasing", classes[0, 4])
    assert (split.budget.smallest, split.budget.largest, split.budget.bait) == (2, 3, 2)
    assert (split.status, split.ratio) == ("computed", "3/4")
    whole = row_of("nondecreasing", classes[1, 0])
    assert (whole.status, whole.ratio, whole.found) == ("proved", "15/22", None)
    optimal = row_of("submodular", classes[2, 3], Fraction(1))
    assert (optimal.status, optimal.ratio) == ("proved", "1")
    open_ = row_of("submodular", next(b for b in budgets(5) if b.members[0] == (1, 0)))
    assert (open_.status, open_.ratio) == ("open", "at least 3/4")


def test_tables_are_markdown() -> None:
    for name in ("others", "threes", "planners"):
        head, rule, *rows = table(name, quick=True).splitlines()
        assert rows
        assert {line.count("|") for line in (head, rule, *rows)} == {len(TABLES[name][0]) + 1}


def test_the_paper_s_smallest_budget_with_one_robot_a_group_is_optimal() -> None:
    robots, budget, size, *shares = row((4, 4, 2, 4))
    assert (robots, budget, size) == ("4", "2, 4", "1")
    assert shares[2] == shares[5] == "1"
    assert all(float(share) < 0.5 for share in (shares[0], shares[1], shares[3], shares[4]))


def test_pages_name_the_steps_that_the_ledger_says_fail() -> None:
    """Names stand on three pages; the first is written from the ledger."""
    page = (ROOT / "docs" / "researchers" / "audit.md").read_text(encoding="utf-8")
    outcome = re.search(r"\| fails in every reading \| (\d+) \| (.*?) \|", page)
    assert outcome is not None
    labels = re.sub(r" \(\d+\)", "", outcome[2]).replace("\\", "").split(", ")  # numbers are of equations
    assert len(labels) == int(outcome[1]) > 0
    for name in ("README.md", "docs/researchers/evaluation.md"):
        text = (ROOT / name).read_text(encoding="utf-8")
        assert set(re.findall(r"`((?:nd|sub)_p\w+)`", text)) == set(labels)
