"""Exact covers by few columns, against all choices of columns; of teams of one word of robots, and of two."""

from itertools import combinations

import numpy as np
import pytest

from ratt_opt.attack.thresholds.exact_cover import ExactCover, packed
from ratt_opt.budget import Budget

PARTS, COLUMNS = 5, 12


def covers_of(groups, costs, most):
    """All choices of columns that have each part once, within what a cover may cost."""
    chosen = (one for k in range(1, PARTS + 1) for one in combinations(range(COLUMNS), k))
    once = (one for one in chosen if (groups[list(one)].sum(axis=0) == 1).all())
    return {one for one in once if (costs[list(one)].sum(axis=0) <= most).all()}


@pytest.mark.parametrize("robots", [5, 30, 100])
@pytest.mark.parametrize("seed", range(40))
def test_every_cover_is_found_once(seed, robots):
    rng = np.random.default_rng(seed)
    parts = rng.permutation(np.arange(robots) % PARTS)
    masks = rng.choice(np.arange(1, 2**PARTS), size=COLUMNS, replace=False)
    groups = (masks[:, None] >> np.arange(PARTS) & 1).astype(np.bool_)
    costs = rng.integers(0, 4, (COLUMNS, 3))
    costs = costs[np.argsort(costs[:, 0], kind="stable")]
    most = tuple(rng.integers(1, 7, 3).tolist())
    search = ExactCover(robots, packed(groups[:, parts]), costs, most)
    found, steps = [], int(rng.integers(1, 20))
    while (one := search.next(Budget(), steps)) is not False:
        if one is not None:
            found.append(tuple(sorted(one)))
    assert len(found) == len(set(found))
    assert set(found) == covers_of(groups, costs, most)


def test_no_columns_cover_nothing():
    assert ExactCover(3, np.zeros((0, 1), np.uint64), np.zeros((0, 3), np.int64), (1, 1, 1)).next(Budget(), 10) is False
