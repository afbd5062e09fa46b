"""Thresholds by all groups that an attack may leave, on teams small enough for the definition or a table."""

import networkx as nx
import pytest

import ratt_opt as ro
from tests.attack.engine import searched
from tests.brackets import assert_closed, worst_value
from tests.oracles import brute_force_worst_case
from tests.strategies import team_problem


def run_listed(problem, plan, max_nodes=None):
    """From a first attack that is hardly ever the worst: some thresholds are reached, others are not."""
    first = ro.bounded_rational_attack(problem, plan).attack
    return searched("listed columns", problem, plan, first, max_nodes=max_nodes)


@pytest.mark.parametrize("seed", range(120))
def test_against_the_definition(seed):
    problem, plan = team_problem(seed, 3 + seed % 4)
    bracket, _, stop = run_listed(problem, plan)
    assert stop is ro.Stop.CLOSED
    assert_closed(problem, plan, bracket, brute_force_worst_case(problem, plan))


@pytest.mark.parametrize("seed", range(12))
def test_against_a_table_of_thresholds(seed):
    families = (nx.gnp_random_graph(12, 0.35, seed=seed), nx.watts_strogatz_graph(12, 4, 0.2, seed=seed))
    problem, plan = team_problem(seed, 12, graph=families[seed % 2])
    bracket, _, stop = run_listed(problem, plan)
    assert stop is ro.Stop.CLOSED
    assert_closed(problem, plan, bracket, worst_value(problem, plan))


@pytest.mark.parametrize("seed", range(4))
def test_the_bracket_is_valid_at_every_node_count(seed):
    problem, plan = team_problem(seed, 7, graph=nx.gnp_random_graph(7, 0.4, seed=seed))
    expected = worst_value(problem, plan)
    _, nodes, _ = run_listed(problem, plan)
    for limit in [*range(min(nodes, 60)), nodes, nodes + 1]:
        bracket, used, stop = run_listed(problem, plan, limit)
        assert used <= limit
        assert bracket.lower <= expected * (1 + 1e-12) + 1e-12
        assert bracket.upper >= expected * (1 - 2e-10)
        assert problem.team_value(plan, bracket.attack) == bracket.upper
        assert (stop is ro.Stop.NODES) == (limit < nodes)
