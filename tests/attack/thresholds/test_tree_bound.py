"""Tree inequalities weighted by what robots are worth: never above the worst case, on any graph."""

import numpy as np
import pytest

import ratt_opt as ro
from ratt_opt.attack.bounds import first_bound, tree_bound
from ratt_opt.budget import Budget
from ratt_opt.graph.largest_group.spreading import forced_size
from tests.oracles import brute_force_worst_case
from tests.strategies import OBJECTIVES, random_elements, random_problem


@pytest.mark.parametrize("name", OBJECTIVES)
@pytest.mark.parametrize("seed", range(40))
def test_no_attack_leaves_less(name, seed):
    rng = np.random.default_rng([seed, 3])
    problem = random_problem(rng, kind=name)
    plan = random_elements(rng, problem)
    worst, threat = brute_force_worst_case(problem, plan), problem.threat
    slack = 1e-9 * max(abs(worst), 1.0)
    size = forced_size(threat, Budget(), problem.n_robots)
    assert first_bound(problem.objective, plan, threat, size) <= worst + slack
    assert tree_bound(problem.objective, plan, threat, Budget(), np.inf) <= worst + slack


def test_it_is_far_above_the_first_bound_on_a_network():
    problem = ro.network_scenario("small-world", 30, 10, alpha_s=6, alpha_c=13, seed=0).problem()
    plan = ro.ratt(problem).elements
    known = first_bound(problem.objective, plan, problem.threat)
    found = tree_bound(problem.objective, plan, problem.threat, Budget(), np.inf)
    attack = ro.worst_case_attack(problem, plan, max_nodes=1000, brief=True)
    assert 1.1 * known < found <= attack.upper


def test_a_spent_budget_claims_nothing():
    problem = ro.network_scenario("hubs", 24, 5, alpha_s=2, alpha_c=5, seed=3).problem()
    plan = ro.ratt(problem).elements
    assert tree_bound(problem.objective, plan, problem.threat, Budget.inside(None, 0.0), np.inf) == -np.inf
