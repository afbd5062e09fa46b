"""Who pays along the axis of a target is found or ruled out, by all sets, on plain and on degenerate data."""

from __future__ import annotations

from itertools import combinations

import numpy as np
import pytest

from ratt_opt import MaxEigenvalueObjective
from ratt_opt.attackers.by_size.family_prices.paying_sets import PayingSets, Question
from ratt_opt.attackers.weakest_set.packed_team import PackedTeam
from ratt_opt.budget import Budget, OutOfBudget
from tests.strategies import information_data

N_ROBOTS, N_TARGETS = 7, 3
SETS = [list(one) for size in range(1, N_ROBOTS + 1) for one in combinations(range(N_ROBOTS), size)]


def plain(rng):
    return information_data(rng, N_ROBOTS, N_TARGETS)


def rank_one(rng):
    prior, _ = plain(rng)
    axes = rng.normal(size=(N_ROBOTS, N_TARGETS, 2, 1)) * 10.0 ** rng.integers(-2, 3, size=(N_ROBOTS, N_TARGETS, 1, 1))
    return prior, axes @ axes.swapaxes(-1, -2)


def useless_and_identical(rng):
    prior, information = plain(rng)
    information[:2] = 0.0
    information[3] = information[4] = information[5]
    return prior, information


def scaled(rng):
    prior, information = plain(rng)
    return prior, information * 10.0 ** rng.uniform(-10, 8)


def mixed_scales(rng):
    prior, information = rank_one(rng)
    return prior, information * 10.0 ** rng.uniform(-10, 8, size=(N_ROBOTS, 1, 1, 1))


@pytest.mark.parametrize("data", [plain, rank_one, useless_and_identical, scaled, mixed_scales])
def test_who_pays_along_an_axis(data):
    answers = set()
    for seed in range(40):
        rng = np.random.default_rng([seed, 3])
        team = PackedTeam.planar(MaxEigenvalueObjective(*data(rng)), np.arange(N_ROBOTS))
        values = np.array([team.value(one) for one in SETS])
        threshold = float(rng.choice(values) + rng.choice([-1e-6, 1e-6, 0.1]) * values[-1])
        prices = rng.choice([rng.normal(size=N_ROBOTS), np.repeat(rng.normal(), N_ROBOTS)])
        finder = PayingSets(team)
        asked = list(finder.sizes(threshold, N_ROBOTS))
        for size in range(1, N_ROBOTS + 1):
            weak = [one for one, value in zip(SETS, values, strict=True) if len(one) == size and value < threshold]
            if size not in asked:
                assert not weak
                continue
            most = max((prices[one].sum() for one in weak), default=0.0)
            for limit in (most - 0.1, most + 1e-6):
                found = finder.of_size(Question(threshold, prices, float(limit)), size, Budget(), 10**6)
                assert found.is_complete == (not found.found) == (not weak or limit > most)
                answers.add(found.is_complete)
                for members in found.found:
                    assert members.sum() == size
                    assert prices[members].sum() > limit
                    assert team.value(np.flatnonzero(members)) < threshold + 1e-9 * abs(team.baseline)
    assert answers == {False, True}


def test_an_axis_search_cut_short_says_so():
    rng = np.random.default_rng(0)
    team = PackedTeam.planar(MaxEigenvalueObjective(*plain(rng)), np.arange(N_ROBOTS))
    threshold, finder = 0.9 * team.value(range(N_ROBOTS)), PayingSets(team)
    size = max(finder.sizes(threshold, N_ROBOTS))
    question = Question(threshold, np.zeros(N_ROBOTS), 1e-9)
    budget = Budget()
    assert finder.of_size(question, size, Budget(), 10**4).is_complete  # nothing is paid at all
    assert not finder.of_size(question._replace(limit=-1e-9), size, budget, 1).is_complete
    assert budget.nodes == 1
    with pytest.raises(OutOfBudget):
        finder.of_size(question, size, Budget(max_nodes=0), 10)
