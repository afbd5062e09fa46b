"""Why the attack that minimises the largest group is the worst at four paper budgets and never at the fifth."""

from itertools import combinations_with_replacement

import pytest

from ratt_audit.enumeration.setting import splits
from ratt_opt import caa
from ratt_opt.graph.survivor_sizes import non_dominated_sizes

SETTINGS = ((4, 4, 1, 3), (4, 4, 2, 4), (10, 15, 3, 11), (10, 15, 5, 15), (10, 15, 6, 22))
"""(robots, targets, sensing attacks, link attacks) of the paper's Section VI."""


def seeing(groups, blinded):
    """Sizes of what sees once so many robots of groups of these sizes are blinded, in every way."""
    for hit in combinations_with_replacement(range(len(groups)), blinded):
        left = [size - hit.count(k) for k, size in enumerate(groups)]
        if min(left) >= 0:
            yield tuple(sorted(filter(None, left), reverse=True))


@pytest.mark.parametrize("setting", SETTINGS)
def test_its_sizes_are_those_worth_making_but_at_six_blinded_of_ten(setting):
    n, _, alpha_s, alpha_c = setting
    even = {sizes for groups in splits(n, alpha_c, caa(n, alpha_c).n_max) for sizes in seeing(groups, alpha_s)}
    worth = set(non_dominated_sizes(n, alpha_s, alpha_c))
    if (alpha_s, alpha_c) == (6, 22):
        assert worth == {(2, 1, 1)}
        assert (2, 2) in even
        assert (2, 1, 1) not in even
    else:
        assert worth <= even
