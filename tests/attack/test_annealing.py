"""Annealed attacks are what they say they are, and find what a plain annealing finds."""

from __future__ import annotations

import numpy as np
import pytest

import ratt_opt as ro
from ratt_opt.attack.annealing import Starts
from ratt_opt.attack.params.groups import AnnealingParams
from ratt_opt.attack.team import Links, Team
from ratt_opt.budget import Budget, OutOfBudget
from tests.oracles import brute_force_worst_case
from tests.strategies import team_problem


def starts_of(problem, plan, **options):
    return Starts(
        Team.of(problem.objective, plan), Links.of(problem.threat), problem.threat, AnnealingParams(), **options
    )


@pytest.mark.parametrize("seed", range(60))
def test_attacks_are_allowed_and_their_values_are_those_of_the_groups(seed):
    problem, plan = team_problem(seed, 4 + seed % 7)
    starts = starts_of(problem, plan, seed=seed, moves=100)
    for _ in range(6):
        found = starts.next(Budget())
        attack = problem.check_attack(found.attack(problem.threat))
        assert found.blind.sum() == problem.threat.n_blinded
        labels = (np.flatnonzero((found.group == g) & ~found.blind) for g in range(len(plan)))
        largest = max(problem.objective(plan[members]) for members in labels)
        assert found.value == pytest.approx(largest, rel=1e-9, abs=1e-9)
        assert problem.team_value(plan, attack) <= largest * (1 + 1e-9) + 1e-9


@pytest.mark.parametrize("seed", range(40))
def test_a_few_starts_find_the_worst_attacks_of_small_teams(seed):
    problem, plan = team_problem(seed, 3 + seed % 4)
    starts = starts_of(problem, plan, moves=500)
    for _ in range(12):
        starts.next(Budget())
    assert starts.best.value == pytest.approx(brute_force_worst_case(problem, plan), rel=1e-9, abs=1e-9)


@pytest.mark.parametrize(("seed", "n_blinded", "n_cut", "known"), [(0, 10, 31, 402.893), (1, 5, 30, 414.989)])
def test_hubs_where_soft_link_budgets_and_norms_end_at_milder_attacks(seed, n_blinded, n_cut, known):
    """Those ended at 405.4 and 418.7 after as many starts."""
    problem = ro.network_scenario("hubs", 30, 25, alpha_s=n_blinded, alpha_c=n_cut, seed=seed).problem()
    starts = starts_of(problem, ro.greedy(problem).elements)
    for _ in range(18):
        starts.next(Budget())
    assert starts.best.value < 1.001 * known


def test_starts_become_longer(monkeypatch):
    problem, plan = team_problem(1, 6)
    starts, made = starts_of(problem, plan, moves=10), []
    plain = Starts._anneal

    def counted(starts, *given):
        made.append(given[3])
        return plain(starts, *given)

    monkeypatch.setattr(Starts, "_anneal", counted)
    for _ in range(3 * AnnealingParams().longer + 1):
        starts.next(Budget())
    assert sorted(made) == made
    assert (made[0], made[-1]) == (10, 10 * AnnealingParams().longest)


def test_no_start_after_the_time():
    problem, plan = team_problem(1, 6)
    starts = starts_of(problem, plan)
    with pytest.raises(OutOfBudget):
        starts.next(Budget(0))
    assert starts.best is None
