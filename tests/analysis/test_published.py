"""Published tables: designs and their bounds against all choices, and a page of few rows."""

from __future__ import annotations

from itertools import combinations

import numpy as np
import pytest

from analysis.published.designs import best_design, entropy_design
from analysis.published.page import page_text


@pytest.mark.parametrize("seed", range(60))
def test_entropy_lies_between_a_choice_and_its_bound(seed):
    rng = np.random.default_rng(seed)
    n, s = 7, int(rng.integers(1, 8))
    half = rng.normal(size=(n, n))
    covariance = half @ half.T + 0.1 * np.eye(n)
    best = max(np.linalg.slogdet(covariance[np.ix_(one, one)])[1] for one in combinations(range(n), s))
    found = entropy_design(covariance, s, rounds=200)
    assert found.lower <= best + 1e-9
    assert best <= found.upper + 1e-9
    chosen = list(found.chosen)
    assert len(set(chosen)) == s
    assert found.lower == pytest.approx(np.linalg.slogdet(covariance[np.ix_(chosen, chosen)])[1])


@pytest.mark.parametrize("seed", range(30))
def test_designs_lie_between_a_choice_and_their_bound(seed):
    rng = np.random.default_rng(seed)
    rows, s, start = rng.normal(size=(8, 3)), int(rng.integers(1, 8)), 0.5 * np.eye(3)
    every = combinations(range(8), s)
    best = max(np.linalg.slogdet(start + rows[list(one)].T @ rows[list(one)])[1] for one in every)
    found = best_design(start, rows, s, rounds=200)
    assert found.lower <= best + 1e-9
    assert best <= found.upper + 1e-9


def test_the_page_says_where_we_are_behind_and_what_is_absent(tmp_path):
    head = "row,published,ours from,ours to,HiGHS from,HiGHS to,s,HiGHS s\n"
    rows = "pmed1 0,5819,5800.0,5819.0,5819.0,5819.0,1.0,2.0\npmed1 1,,5000.0,5010.0,4000.0,6000.0,1.0,2.0\n"
    (tmp_path / "facilities.csv").write_text(head + rows, encoding="utf-8")
    page = page_text(tmp_path, 10.0)
    assert "has the published optimum on 1 of 1" in page
    assert "We are behind on 1 rows (pmed1 0)" in page
    assert page.count("No row is made yet.") == 4
