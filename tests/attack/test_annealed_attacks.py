"""Quick attacks on one plan after the other, on any graph."""

import numpy as np
import pytest

import ratt_opt as ro
from ratt_opt.attack.annealing import AnnealedAttacks
from ratt_opt.budget import Budget
from tests.oracles import brute_force_worst_case
from tests.strategies import OBJECTIVES, random_elements, random_problem


@pytest.mark.parametrize("seed", range(20))
def test_attacks_are_within_the_budgets_and_no_milder_than_what_they_start_from(seed):
    rng = np.random.default_rng(seed)
    problem = random_problem(rng, 5, kind=list(OBJECTIVES)[seed % 3])
    attacks = AnnealedAttacks.of(problem, Budget())
    for _ in range(3):
        plan = random_elements(rng, problem)
        known = ro.random_attack(problem, plan, seed=seed).attack
        exact = brute_force_worst_case(problem, plan)
        for first in (None, known):
            attack = problem.check_attack(attacks.attack(problem, plan, 50, first))
            assert problem.team_value(plan, attack) >= exact - 1e-12
        assert problem.team_value(plan, attack) <= problem.team_value(plan, known) + 1e-12


def test_no_attack_after_the_time():
    problem = ro.network_scenario("disk-6", 16, 3, alpha_s=3, alpha_c=6, seed=0).problem()
    attacks = AnnealedAttacks.of(problem, Budget(0))
    assert attacks.attack(problem, ro.greedy(problem).elements, 50) is None


def test_criteria_without_compiled_code_are_attacked_otherwise():
    class Own(ro.TraceObjective):
        native_kernel = None  # as in a criterion of one's own

    scenario = ro.network_scenario("disk-6", 16, 3, alpha_s=3, alpha_c=6, seed=0)
    shown = scenario.problem()
    problem = ro.Problem(
        Own(shown.objective.prior, shown.objective.information), shown.robot, shown.graph, shown.alpha_s, shown.alpha_c
    )
    assert AnnealedAttacks.of(problem, Budget()) is None
