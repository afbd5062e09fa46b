"""Weak subsets of a group when so many of its robots are blinded, against all of them."""

from __future__ import annotations

from itertools import combinations

import numpy as np
import pytest

from ratt_opt.attack.links import Links
from ratt_opt.attackers.by_prices.groups import blinding
from ratt_opt.attackers.by_prices.groups.blinding import ABSENT, WEAK, may_be_weak, weak_subset
from ratt_opt.attackers.by_prices.team import PricedTeam
from tests.strategies import team_problem


@pytest.mark.parametrize("seed", range(12))
def test_weak_subsets_against_all_of_them(seed):
    problem, plan = team_problem(seed, 8)
    team, links = PricedTeam.of(problem.objective, plan), Links.of(problem.threat)
    group = np.random.default_rng(seed).random(8) < 0.8
    members = np.flatnonzero(group).tolist()
    free = [i for i in members if not links.seeing[i]]
    for blinded in range(len(free) + 1):
        values = [problem.objective([plan[i] for i in members if i not in out]) for out in combinations(free, blinded)]
        least = min(values)
        for threshold in (least * 0.999, least * 1.001) if least > 1e-6 else (1e-3,):
            found = np.zeros(8, dtype=np.bool_)
            answer = weak_subset(team, links.seeing, group, blinded, threshold, 10**6, found)
            assert answer == (WEAK if least < threshold else ABSENT)
            if answer == WEAK:
                left = [plan[i] for i in members if not found[i]]
                assert found.sum() == blinded
                assert problem.objective(left) < threshold


@pytest.mark.parametrize("seed", range(12))
def test_weak_subsets_in_pieces_are_those_in_one(seed, monkeypatch):
    """Of 53 robots and targets of four coordinates one piece took 1.9 s, which no limit and no interrupt ended."""
    problem, plan = team_problem(seed, 9)
    team, rng, asked = PricedTeam.of(problem.objective, plan), np.random.default_rng(seed), []
    group, nobody = rng.random(9) < 0.8, np.zeros(9, dtype=np.bool_)
    most = problem.objective([plan[i] for i in np.flatnonzero(group)])
    for blinded in range(int(group.sum()) + 1):
        for threshold, limit in zip(rng.uniform(0, 1.1, 8) * most, (1, 2, 5, 6, 20, 100, 10**4, 10**4), strict=True):
            monkeypatch.setattr(blinding, "AT_ONCE", 10**6)
            whole = weak_subset(team, nobody, group, blinded, threshold, limit, nobody.copy()) != ABSENT
            for pieces in (1, 3, 10**6):
                monkeypatch.setattr(blinding, "AT_ONCE", pieces)
                found = may_be_weak(team, group, blinded, threshold, limit, lambda: asked.append(1))
                assert found == whole
    assert len(asked) > 9 * 8 * 3 // 2
