"""The passes over all sets, against their definitions; parts of a pass; and what C may not read."""

from itertools import product

import numpy as np
import pytest

from ratt_opt import InputError, _blocks
from ratt_opt.budget import Budget
from ratt_opt.setfunctions import lattice


def tables(rng, n):
    """Values with ties, with none, and of both signs of zero."""
    yield rng.integers(-2, 3, 1 << n).astype(float)
    yield rng.normal(size=1 << n)
    yield np.where(rng.random(1 << n) < 0.5, 0.0, -0.0)


def without(n, *elements):
    """Numbers of the sets that have none of some elements."""
    sets = np.arange(1 << n)
    return sets[(sets & sum(1 << i for i in elements)) == 0]


@pytest.mark.parametrize("n", [*range(11), 13, 16])
def test_first_and_second_differences_are_those_of_the_definition(n):
    """Of few elements, where lanes are not full, and of many."""
    for values in tables(np.random.default_rng(n), n):
        ends, second = lattice.marginal_ends(values, n), lattice.second_differences(values, n, Budget())
        assert (ends.shape, second.shape) == ((2, n), (n, n))
        for i in range(n):
            sets = without(n, i)
            marginals = values[sets | 1 << i] - values[sets]
            assert ends[:, i].tolist() == [marginals.min(), marginals.max()]
            for j in range(n):
                sets = without(n, i, j)
                with_i, with_j = values[sets | 1 << i], values[sets | 1 << j]
                slack = (with_i - values[sets | 1 << i | 1 << j]) - (values[sets] - with_j)
                assert second[i, j] == (slack.min() if i < j else 0.0)


@pytest.mark.parametrize("n", range(7))
def test_slacks_are_those_of_the_definition(n):
    for values in tables(np.random.default_rng(n), n):
        pairs = list(product(range(1 << n), repeat=2))
        slack = {(a, b): values[a] + values[b] - values[a | b] for a, b in pairs}
        least, a, b = lattice.overlapping_slack(values, Budget())
        assert least == min(slack.values()) == slack[a, b]
        least, a, b = lattice.disjoint_slack(values, Budget())
        assert least == min(slack[one] for one in pairs if one[0] & one[1] == 0) == slack[a, b]
        assert a & b == 0


@pytest.mark.parametrize("sizes", [(), (1,), (2,), (1, 3), (3, 2), (2, 2, 2), (3, 1, 2, 3), (4, 3, 3)])
def test_the_gain_ratio_is_that_of_the_definition(sizes):
    rng = np.random.default_rng(len(sizes))
    for values in (rng.random(sizes), rng.integers(0, 3, sizes).astype(float), np.zeros(sizes)):
        ratios = {}
        for top in product(*map(range, sizes)):
            axes = [a for a in reversed(range(len(sizes))) if top[a]]
            for mask in range((1 << len(axes)) - 1):
                kept = {a for bit, a in enumerate(axes) if mask >> bit & 1}
                base = tuple(option if a in kept else 0 for a, option in enumerate(top))
                each = [
                    values[tuple(top[a] if a == new else option for a, option in enumerate(base))] - values[base]
                    for new in set(axes) - kept
                ]
                if values[top] > values[base]:
                    ratios[top, mask] = sum(each) / (values[top] - values[base])
        flat = np.ravel(values)
        found = lattice.smallest_gain_ratio(flat, np.array(sizes, dtype=np.int64), Budget())
        ratio, top, mask = found.upper, found.top, found.part
        assert found.lower == ratio  # without noise
        assert ratio == pytest.approx(min(ratios.values(), default=np.inf), rel=1e-12)
        where = tuple(int(k) for k in np.unravel_index(top, sizes)) if sizes else ()
        assert not ratios or ratios[where, mask] == pytest.approx(ratio, rel=1e-12)


def test_parts_of_a_pass_are_the_whole(monkeypatch):
    """And the clock is looked at between them."""
    rng = np.random.default_rng(5)
    values, sizes = rng.normal(size=1 << 16), np.full(8, 2)
    small = values[:256].copy()

    def found(budget):
        return (
            lattice.marginal_ends(values, 16).tolist(),
            lattice.second_differences(values, 16, budget).tolist(),
            lattice.disjoint_slack(small, budget),
            lattice.overlapping_slack(small, budget),
            lattice.smallest_gain_ratio(small, sizes, budget),
        )

    whole, looks = found(Budget()), []
    monkeypatch.setattr(Budget, "check", lambda _: looks.append(None))
    monkeypatch.setattr(_blocks, "STEPS", 1 << 12)
    assert found(Budget()) == whole
    assert len(looks) == 16 * 15 // 2 + 256 // 16 + 256


def test_what_c_may_not_read_is_refused():
    values, sizes, budget = np.zeros(8), np.array([2, 2, 2]), Budget()
    calls = (
        lambda values: lattice.marginal_ends(values, 3),
        lambda values: lattice.second_differences(values, 3, budget),
        lambda values: lattice.disjoint_slack(values, budget),
        lambda values: lattice.overlapping_slack(values, budget),
        lambda values: lattice.smallest_gain_ratio(values, sizes, budget),
    )
    other = [values.astype(np.float32), values.tolist(), values[:, None], np.zeros(16)[::2]]
    for call in calls:
        call(values)
        for bad in other:
            with pytest.raises(InputError):
                call(bad)
    for call in (*calls[:2], calls[4]):
        with pytest.raises(InputError):
            call(np.zeros(7))
    for bad in (sizes.astype(np.int32), sizes.tolist(), np.array([4, 4, 0]), np.array([-2, -4, 1]), np.array([2, 5])):
        with pytest.raises(InputError):
            lattice.smallest_gain_ratio(values, bad, budget)
