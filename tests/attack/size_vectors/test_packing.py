"""Disjoint groups of given sizes below a threshold, the largest first, as by going through all."""

from __future__ import annotations

from itertools import combinations

import numpy as np
import pytest

from ratt_opt import Stop
from ratt_opt.attack.size_vectors.decision import Packer
from ratt_opt.attack.team import Team
from ratt_opt.budget import Budget, OutOfBudget
from tests.strategies import OBJECTIVES, information_data

N_ROBOTS = 8


def exists(team, available, sizes, threshold, must):
    """By definition."""
    if not sizes:
        return not must & available
    sets = (frozenset(one) for one in combinations(sorted(available), sizes[0]))
    return any(
        team.value(group) < threshold and exists(team, available - group, sizes[1:], threshold, must) for group in sets
    )


def question(name, seed):
    rng = np.random.default_rng(seed)
    team = Team.of(OBJECTIVES[name](*information_data(rng, N_ROBOTS, 3)), np.arange(N_ROBOTS))
    robots = rng.permutation(N_ROBOTS).tolist()
    available = frozenset(robots[: int(rng.integers(4, N_ROBOTS + 1))])
    must = frozenset(i for i in robots if rng.random() < 0.2)
    sizes, left = [], len(available)
    while left > 0 and (not sizes or rng.random() < 0.7):
        sizes.append(int(rng.integers(1, min(left, 4) + 1)))
        left -= sizes[-1]
    threshold = team.value(rng.choice(robots, max(sizes), replace=False).tolist()) * float(rng.uniform(0.9, 1.3))
    return team, available, tuple(sorted(sizes, reverse=True)), threshold, must


def search_groups(monkeypatch):
    """The weakest robots in order are no answer, but for robots alone."""
    weakest = Packer._weakest

    def alone(packer, available, sizes, threshold):
        return weakest(packer, available, sizes, threshold) if max(sizes, default=1) == 1 else None

    monkeypatch.setattr(Packer, "_weakest", alone)


@pytest.mark.parametrize("name", OBJECTIVES)
def test_groups_are_found_where_there_are_some(name, monkeypatch):
    search_groups(monkeypatch)
    found = []
    for seed in range(150):
        team, available, sizes, threshold, must = question(name, seed)
        packed = Packer(team, must, Budget()).pack(available, sizes, threshold, effort=10**9)
        assert packed.decided
        assert (packed.groups is not None) == exists(team, available, sizes, threshold, must), seed
        found.append(packed.groups is not None)
        if packed.groups is not None:
            together = frozenset().union(*packed.groups)
            assert sorted(map(len, packed.groups), reverse=True) == list(sizes)
            assert all(team.value(group) < threshold for group in packed.groups)
            assert len(together) == sum(sizes)
            assert must & available <= together <= available
    assert 30 < sum(found) < 120


def test_efforts_and_limits_are_kept(monkeypatch):
    search_groups(monkeypatch)
    for seed in range(40):
        team, available, sizes, threshold, must = question("trace", seed)
        budget = Budget()
        whole = Packer(team, must, budget).pack(available, sizes, threshold, effort=10**9)
        for effort in range(1, budget.nodes + 2):
            part = Budget()
            packed = Packer(team, must, part).pack(available, sizes, threshold, effort)
            assert part.nodes <= effort
            assert packed.groups == whole.groups if packed.decided else packed.groups is None
            limited = Packer(team, must, Budget(max_nodes=effort - 1))
            if budget.nodes and effort == 1:
                with pytest.raises(OutOfBudget) as out:
                    limited.pack(available, sizes, threshold, 10**9)
                assert out.value.stop is Stop.NODES
