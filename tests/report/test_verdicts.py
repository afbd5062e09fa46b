"""Tables of claims and verdicts: what they show, and that no verdict is typed by hand."""

import numpy as np
import pytest

from ratt_opt import InputError
from ratt_opt.report.verdicts import VerdictTable


def test_each_row_says_whether_its_claim_holds() -> None:
    shown = repr(VerdictTable(("one | two", 1, True), ("f > g", "3 and 4", np.float64(3) > 4)))
    assert shown.splitlines() == [
        "| claim | computed | verdict |",
        "| --- | --- | --- |",
        r"| one \| two | 1 | holds |",
        "| f > g | 3 and 4 | does not hold |",
    ]


def test_markdown_shows_stars_as_they_are() -> None:
    assert r"| A\* | 1 | holds |" in VerdictTable(("A*", 1, True))._repr_markdown_()


@pytest.mark.parametrize("verdict", ["holds", 1, None])
def test_a_verdict_is_computed(verdict: object) -> None:
    with pytest.raises(InputError, match="holds must be True or False"):
        VerdictTable(("claim", 1, verdict))
