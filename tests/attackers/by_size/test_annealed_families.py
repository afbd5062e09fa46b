"""Annealed families are outcomes of the threat, and hardly ever miss the worst one of a small team."""

from __future__ import annotations

from math import comb

import numpy as np
import pytest

from ratt_opt import Problem, worst_case_attack
from ratt_opt.attackers.by_size import annealed_families as module
from ratt_opt.attackers.by_size import size_vector_search
from ratt_opt.attackers.by_size.annealed_families import AnnealedFamilies
from ratt_opt.attackers.weakest_set.packed_team import PackedTeam
from ratt_opt.budget import Budget
from ratt_opt.graph.survivor_sizes import cheapest_cut
from tests.brackets import attains
from tests.strategies import OBJECTIVES, information_data

N_ROBOTS = 9


def teams(name, count):
    for seed in range(count):
        rng = np.random.default_rng(seed)
        objective = OBJECTIVES[name](*information_data(rng, N_ROBOTS, 3))
        budgets = int(rng.integers(0, 5)), int(rng.integers(5, comb(N_ROBOTS, 2)))
        must = frozenset(rng.choice(N_ROBOTS, int(rng.integers(0, 3)), replace=False).tolist())
        problem = Problem(objective, np.arange(N_ROBOTS), None, *budgets, protected_robots=must)
        yield problem, PackedTeam.planar(objective, np.arange(N_ROBOTS))


@pytest.mark.parametrize("name", OBJECTIVES)
def test_families_are_outcomes_and_near_the_worst(name, monkeypatch):
    monkeypatch.setattr(module, "FIRST_MOVES", module.CHUNK)
    met = 0
    for problem, team in teams(name, 6):
        worst = worst_case_attack(problem, np.arange(N_ROBOTS))
        values = [np.inf]
        annealed = AnnealedFamilies(team, problem.threat)
        for groups in (annealed.start(Budget()) for _ in range(2)):
            seeing = frozenset().union(*groups)
            assert sum(map(len, groups)) == len(seeing) == N_ROBOTS - problem.threat.n_blinded
            assert problem.protected_robots <= seeing
            sizes = tuple(sorted(map(len, groups), reverse=True))
            assert cheapest_cut(problem.threat.n_blinded, sizes) <= problem.threat.alpha_c
            values.append(max(map(team.value, groups)))
        assert min(values) >= worst.upper - 1e-9 * abs(worst.upper) - problem.objective.rounding
        met += min(values) <= worst.upper + 1e-9 * abs(worst.upper) + problem.objective.rounding
    assert met >= 5


def test_nothing_is_left_of_a_team_all_blinded():
    rng = np.random.default_rng(0)
    objective = OBJECTIVES["trace"](*information_data(rng, N_ROBOTS, 3))
    problem = Problem(objective, np.arange(N_ROBOTS), None, N_ROBOTS, 0)
    team = PackedTeam.planar(objective, np.arange(N_ROBOTS))
    assert AnnealedFamilies(team, problem.threat).start(Budget()) == ()


def test_none_is_begun_when_the_time_is_up():
    problem, team = next(teams("trace", 1))
    assert AnnealedFamilies(team, problem.threat).start(Budget(time_limit=0)) == ()


@pytest.mark.parametrize("name", OBJECTIVES)
def test_too_many_vectors_leave_a_valid_bracket(name, monkeypatch):
    n_robots, rng = 14, np.random.default_rng(3)
    objective = OBJECTIVES[name](*information_data(rng, n_robots, 3))
    problem = Problem(objective, np.arange(n_robots), None, 1, 65)
    exact = worst_case_attack(problem, np.arange(n_robots))
    monkeypatch.setattr(module, "FIRST_MOVES", module.CHUNK)
    monkeypatch.setattr(size_vector_search, "MOST_VECTORS", 0)
    found = worst_case_attack(problem, np.arange(n_robots), time_limit=1.0)
    assert found.lower <= exact.upper <= found.upper
    assert attains(problem, np.arange(n_robots), found)
    assert found.upper <= exact.upper + 1e-9 * abs(exact.upper)
