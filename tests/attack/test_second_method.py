"""The exact attacker of larger teams against a second exact method, at sizes far beyond the definition."""

import numpy as np
import pytest

import ratt_opt as ro
from tests.attack.enumerated_groups import SecondAttacker, list_groups
from tests.oracles import all_attacks, brute_force_worst_case, groups_left
from tests.strategies import OBJECTIVES, random_elements, random_graph, range_bearing

NEAR = 1e-9
"""Relative distance of the thresholds from the value: above what the attacker leaves open (1e-10)."""
FAMILIES = ("dense", "disk-12", "disk-6", "small-world", "hubs")


def small_problem(seed):
    rng = np.random.default_rng(seed)
    n_robots, name = 4 + seed % 3, list(OBJECTIVES)[seed % 3]
    graph = random_graph(rng, n_robots)
    links = sorted((min(link), max(link)) for link in graph.edges)
    held = (
        frozenset(i for i in range(n_robots) if rng.random() < 0.2),
        frozenset(x for x in links if rng.random() < 0.2),
    )
    budgets = int(rng.integers(0, n_robots)), int(rng.integers(0, min(len(links), 6) + 1))
    weights = rng.uniform(0.2, 3, 3)
    objective = OBJECTIVES[name](*range_bearing(rng, n_robots, 3, 2), weights)
    owners = np.repeat(np.arange(n_robots), 2)
    problem = ro.Problem(objective, owners, graph, *budgets, *held)
    return problem, random_elements(rng, problem), name


def check_decisions(problem, plan, name, lower, upper):
    """No attack below the lower end; above the upper end one, which is worth less by the definition."""
    second = SecondAttacker(problem, plan, name)
    assert second.attack_below(lower * (1 - NEAR)) is None
    above = upper * (1 + NEAR) + 1e-12
    found = second.attack_below(above)
    assert found is not None
    blinded = frozenset().union(*(out for _, out in found))
    links = frozenset(problem.communication.links_between(group for group, _ in found))
    assert len(blinded) <= problem.alpha_s
    assert len(links) <= problem.alpha_c
    assert problem.team_value(plan, ro.Attack(blinded, links)) < above


@pytest.mark.parametrize("seed", range(30))
def test_the_second_method_against_the_definition(seed):
    problem, plan, name = small_problem(seed)
    listed = {int(group) for group in list_groups(problem)[0]}
    left = {sum(1 << i for i in group) for _, cut in all_attacks(problem) for group in groups_left(problem, cut)}
    assert listed == left
    value = brute_force_worst_case(problem, plan)
    if value > 0:
        check_decisions(problem, plan, name, value, value)


def check_agreement(n_robots, family, shares, seed, name, **limits):
    budgets = {"alpha_s": shares[0], "alpha_c": shares[1], "seed": seed}
    problem = ro.network_scenario(family, n_robots, 8, **budgets).problem(name)
    plan = ro.ratt(problem).elements
    exact = ro.worst_case_attack(problem, plan, **limits)
    assert limits or exact.stop in {ro.Stop.CLOSED, ro.Stop.EXHAUSTED}
    check_decisions(problem, plan, name, exact.lower, exact.upper)


@pytest.mark.parametrize("family", FAMILIES)
def test_two_exact_methods_agree(family):
    """A tenth of the robots blinded and of the links cut."""
    seed = FAMILIES.index(family)
    check_agreement(21 + seed, family, (0.1, 0.1), seed, list(OBJECTIVES)[seed % 3])


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(6))
@pytest.mark.parametrize("n_robots", [24, 30])
@pytest.mark.parametrize("family", FAMILIES)
def test_two_exact_methods_agree_at_larger_budgets(family, n_robots, seed):
    """A fifth of the robots blinded and 15 % of the links cut, or, half of the time, a seventh and a tenth.

    The second method decides both ends of a bracket that ten seconds leave open, too.
    """
    shares = ((0.2, 0.15), (1 / 7, 0.1))[seed % 2]
    check_agreement(n_robots, family, shares, seed, list(OBJECTIVES)[seed % 3], time_limit=10)
