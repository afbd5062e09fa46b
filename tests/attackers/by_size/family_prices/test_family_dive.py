"""Families from prices are outcomes of the threat, and mostly the worst one; what is left to choose is counted."""

from __future__ import annotations

from itertools import combinations
from math import comb

import numpy as np
import pytest

from ratt_opt import Problem, worst_case_attack
from ratt_opt.attackers.by_size.annealed_families import Cooling, annealed_from
from ratt_opt.attackers.by_size.family_prices.family_dive import FamilyDive
from ratt_opt.attackers.by_size.family_prices.family_program import Choice, FamilyProgram
from ratt_opt.attackers.by_size.family_prices.set_finder import SetFinder
from ratt_opt.attackers.weakest_set.packed_team import PackedTeam
from ratt_opt.budget import Budget, OutOfBudget
from ratt_opt.graph.survivor_sizes import cheapest_cut
from tests.strategies import OBJECTIVES, information_data

N_ROBOTS = 10
EVERYONE = np.arange(N_ROBOTS)


def dives(name, count):
    """Attacks that leave several groups: few blinded, most links cut."""
    for seed in range(count):
        rng = np.random.default_rng([seed, 11])
        objective = OBJECTIVES[name](*information_data(rng, N_ROBOTS, 3))
        budgets = int(rng.integers(0, 4)), int(rng.integers(comb(N_ROBOTS, 2) // 2, comb(N_ROBOTS, 2) - 2))
        must = frozenset(rng.choice(N_ROBOTS, int(rng.integers(0, 2)), replace=False).tolist())
        problem = Problem(objective, EVERYONE, None, *budgets, protected_robots=must)
        team = PackedTeam.planar(objective, EVERYONE)
        yield problem, team, FamilyDive(team, problem.threat, SetFinder(team, N_ROBOTS - problem.threat.n_blinded))


def assert_is_outcome(groups, problem):
    seeing = frozenset().union(*groups)
    assert sum(map(len, groups)) == len(seeing) == N_ROBOTS - problem.threat.n_blinded
    assert problem.protected_robots <= seeing
    sizes = tuple(sorted(map(len, groups), reverse=True))
    assert cheapest_cut(problem.threat.n_blinded, sizes) <= problem.threat.alpha_c


@pytest.mark.parametrize("name", OBJECTIVES)
def test_dives_end_in_outcomes_and_near_the_worst(name):
    met, ended = 0, 0
    for problem, team, dive in dives(name, 8):
        worst, best = worst_case_attack(problem, EVERYONE).upper, np.inf
        near = 1e-9 * abs(worst) + problem.objective.rounding
        for share in (1.001, 1.0, 1.01, 1.05):
            groups = dive.family(share * worst, Budget())
            if not groups:
                continue
            ended += 1
            assert_is_outcome(groups, problem)
            annealed = annealed_from(
                groups, team, problem.threat, Cooling(1e-3, 10_000), np.random.default_rng(0), Budget()
            )
            assert_is_outcome(annealed, problem)
            values = [max(map(team.value, one)) for one in (groups, annealed)]
            assert values[1] <= values[0] + near
            best = min(best, values[1])
        assert best >= worst - near
        met += best <= worst + near
    assert ended >= 20
    assert met >= 6


def test_what_is_left_to_choose():
    problem, _, _ = next(dives("logdet", 1))
    program = FamilyProgram(problem.threat, is_scaled=True)
    assert program.kept == comb(N_ROBOTS, 2) - problem.alpha_c - comb(problem.alpha_s, 2)
    members = EVERYONE < 3
    after = program.with_choice(Choice(members, is_largest=False))
    assert after.kept == program.kept - 3
    assert after.n_seeing == program.n_seeing - 3
    assert not after.add(EVERYONE == 2, 0.0)  # has a group
    assert after.add(EVERYONE == 3, 0.0)
    last = after.with_choice(Choice(EVERYONE >= N_ROBOTS - 2, is_largest=True))
    assert last.kept == after.kept - 1 - 2 * problem.alpha_s
    assert last.most_links == comb(last.n_seeing, 2)


def test_a_scaled_program_says_how_many_links_are_to_spare():
    for problem, team, _ in dives("trace", 4):
        program, threshold = FamilyProgram(problem.threat, is_scaled=True), 2 * team.value(EVERYONE)
        for size in range(1, N_ROBOTS + 1):
            for one in combinations(range(N_ROBOTS), size):
                program.add(np.isin(EVERYONE, one), team.value(one))
        # Every set is weak: one group of all that see, and the blinded ones with it, keeps every link.
        prices = program.solve(threshold)
        assert -prices.claim == pytest.approx(problem.alpha_c)
        assert sum(share for share, _ in program.shares(threshold)) == pytest.approx(1.0)


def test_a_dive_ends_with_its_time():
    _, team, dive = next(dives("maxeig", 1))
    with pytest.raises(OutOfBudget):
        dive.family(team.value(EVERYONE) / 2, Budget(time_limit=0))
