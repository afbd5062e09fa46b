"""The smallest of some numbers come first, whatever is tied or infinite."""

from __future__ import annotations

import numpy as np

from ratt_opt.attackers.weakest_set.selection import move_least_first


def test_the_smallest_come_first_and_the_last_of_them_is_returned():
    rng = np.random.default_rng(0)
    for _ in range(2_000):
        n = int(rng.integers(1, 40))
        values = rng.normal(size=n) if rng.random() < 0.5 else rng.integers(0, 4, n).astype(np.float64)
        values[rng.random(n) < 0.1] = rng.choice([np.inf, -np.inf])
        count, moved = int(rng.integers(1, n + 1)), values.copy()
        last = move_least_first(moved, count)
        rising = np.sort(values)
        assert last == moved[count - 1] == rising[count - 1]
        assert (np.sort(moved[:count]) == rising[:count]).all()
        assert (np.sort(moved) == rising).all()
