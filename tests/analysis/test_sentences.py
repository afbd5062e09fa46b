"""The table of Section VI's sentences is made from the tables of its page."""

from __future__ import annotations

import pytest

from analysis.paper.sentences import PAGE, SENTENCES, refreshed

TEXT = PAGE.read_text(encoding="utf-8")


def test_the_page_shows_what_its_tables_say() -> None:
    assert refreshed(TEXT) == TEXT


def test_a_changed_claim_changes_its_sentence_and_a_missing_one_is_named() -> None:
    claim = next(line for line in TEXT.splitlines() if "RATT is close to OPT" in line)
    assert "+0.152 [+0.0988, +0.206] %" in claim
    changed = TEXT.replace(
        claim, claim.replace("+0.152 [+0.0988", "+0.175 [+0.111").replace("confirmed", "contradicted")
    )
    row = next(line for line in refreshed(changed).splitlines() if "RATT performs close to OPT" in line)
    assert row.endswith("| trace +0.175 [+0.111, +0.206] % | contradicted |")
    with pytest.raises(ValueError, match="0 claims like"):
        refreshed(TEXT.replace(claim + "\n", ""))


def test_every_sentence_has_a_row() -> None:
    assert all(sum(line.startswith(f"| {one.paper} |") for line in TEXT.splitlines()) == 1 for one in SENTENCES)
