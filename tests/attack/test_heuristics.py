import networkx as nx
import numpy as np
import pytest

import ratt_opt as ro
from tests.brackets import attains
from tests.strategies import random_elements, random_problem


def modular(weights):
    masks = np.arange(2 ** len(weights))[:, None] >> np.arange(len(weights)) & 1
    return ro.TableFunction(masks @ np.asarray(weights, dtype=float))


@pytest.mark.parametrize("seed", range(80))
def test_attacks_are_allowed_and_their_values_are_recomputed(seed):
    rng = np.random.default_rng(seed)
    problem = random_problem(rng)
    elements = random_elements(rng, problem)
    exact = ro.worst_case_attack(problem, elements)
    for result in (
        ro.bounded_rational_attack(problem, elements),
        ro.greedy_attack(problem, elements),
        ro.random_attack(problem, elements, seed=seed),
    ):
        problem.check_attack(result.attack)
        assert attains(problem, elements, result)
        assert result.upper >= exact.upper - 1e-12
        assert result.lower == problem.objective(())
        assert result.stop is ro.Stop.HEURISTIC


def test_bounded_rational_follows_the_order_of_individual_values():
    problem = ro.Problem(modular([1, 5, 3, 5, 2]), np.arange(5), None, 2, 4 + 3)
    result = ro.bounded_rational_attack(problem, np.arange(5))
    assert result.attack.sensing == {1, 3}
    assert result.attack.links == {(0, 2), (1, 2), (2, 3), (2, 4), (0, 4), (1, 4), (3, 4)}
    assert result.upper == 3.0


def test_bounded_rational_stays_within_the_link_budget():
    """The paper would isolate alpha_cs = 2 robots here, which takes 3 + 2 links, not 4."""
    problem = ro.Problem(modular([4, 3, 2, 1]), np.arange(4), None, 0, 4)
    assert ro.caa(4, 4).alpha_cs == 2
    assert ro.bounded_rational_attack(problem, np.arange(4)).attack.links == {(0, 1), (0, 2), (0, 3)}


def test_bounded_rational_passes_over_what_is_protected():
    problem = ro.Problem(modular([4, 3, 2, 1]), np.arange(4), None, 1, 3, frozenset([0]), frozenset([(0, 3)]))
    result = ro.bounded_rational_attack(problem, np.arange(4))
    assert result.attack.sensing == {1}
    assert result.attack.links == {(0, 2), (1, 2), (2, 3)}


def test_greedy_takes_the_hub():
    graph = nx.star_graph(4)
    problem = ro.Problem(modular([0, 1, 1, 1, 1]), np.arange(5), graph, 0, 4)
    result = ro.greedy_attack(problem, np.arange(5))
    assert result.upper == 1.0
    assert len(result.attack.links) == 4


def test_random_attack_spends_the_budget_and_repeats():
    problem = ro.Problem(modular([1] * 6), np.arange(6), None, 2, 5)
    attacks = [ro.random_attack(problem, np.arange(6), seed=seed).attack for seed in range(20)]
    assert all(len(a.sensing) == 2 and len(a.links) == 5 for a in attacks)
    assert len(set(attacks)) > 10
    assert attacks[3] == ro.random_attack(problem, np.arange(6), seed=3).attack
    with pytest.raises(ro.InputError, match="seed"):
        ro.random_attack(problem, np.arange(6), seed=-1)


def test_ties_go_to_the_lowest_robot():
    problem = ro.Problem(modular([1] * 5), np.arange(5), None, 2, 4)
    assert ro.bounded_rational_attack(problem, np.arange(5)).attack.sensing == {0, 1}
    assert ro.greedy_attack(problem, np.arange(5)).attack.sensing == {0, 1}
