"""Underestimators that bound every set of a size, in each listed group."""

from __future__ import annotations

from itertools import combinations

import numpy as np
import pytest

from ratt_opt.attack.least_sets.packed_team import PackedTeam
from ratt_opt.attackers.by_partition.group_floors import UnderestimatorsOfSizes, least_in_groups
from ratt_opt.budget import Budget
from ratt_opt.graph.separable_groups import separable_groups
from tests.attackers.by_partition.test_split_search import team_problem
from tests.strategies import OBJECTIVES


@pytest.mark.parametrize("seed", [seed for seed in range(12) if list(OBJECTIVES)[seed % 3] != "maxeig"])
def test_underestimators_of_sizes_hold_in_every_group(seed):
    problem, elements = team_problem(1998 + seed, 7, density=0.4)
    team, groups = PackedTeam.planar(problem.objective, elements), separable_groups(problem.threat, 100_000)
    underestimators, members = (
        UnderestimatorsOfSizes(team),
        [groups.members(group).tolist() for group in range(len(groups.masks))],
    )
    for size in range(6, 0, -1):
        rows = np.array([row for row, robots in enumerate(members) if len(robots) >= size], dtype=np.int64)
        least = np.array([min(team.value(robots) for robots in combinations(members[row], size)) for row in rows])
        threshold = float(np.median(least)) if len(least) else 1.0
        for underestimator in (underestimators.rough(size), underestimators.sharper(size, threshold, Budget())):
            if underestimator is not None:
                assert np.all(least_in_groups(underestimator, groups, rows, size) <= least + 1e-9 * abs(least))
        assert underestimators.of(size) is not None
