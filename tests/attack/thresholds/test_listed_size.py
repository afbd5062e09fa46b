"""The forced size by listed columns, and weakest sets of fewer robots, against the definition."""

from __future__ import annotations

import networkx as nx
import numpy as np
import pytest

import ratt_opt as ro
from ratt_opt.attack.stages.listed_columns import ListedSize
from ratt_opt.attack.staging import without_stages
from ratt_opt.budget import Budget
from ratt_opt.graph.group_list import groups_of
from tests.brackets import worst_value
from tests.oracles import brute_force_worst_case
from tests.strategies import team_problem


def counted(seed):
    """A team whose robots are all alike, on a random network, some of it protected."""
    rng = np.random.default_rng(seed)
    robots = int(rng.integers(3, 7))
    graph = nx.gnp_random_graph(robots, 0.6, seed=seed)
    blinded, cut = int(rng.integers(0, robots)), int(rng.integers(0, 4))
    cut = min(cut, graph.number_of_edges())
    alike = ro.LogDetObjective(np.ones((1, 1, 1)), np.ones((robots, 1, 1, 1)))
    protected = {"protected_robots": {0}, "protected_links": set(list(graph.edges)[:1])} if seed % 3 == 0 else {}
    return ro.Problem(alike, np.arange(robots), graph, blinded, cut, **protected)


@pytest.mark.parametrize("seed", range(40))
def test_some_group_keeps_exactly_so_many_robots(seed):
    problem = counted(seed)
    truth = round(np.expm1(brute_force_worst_case(problem, np.arange(problem.n_robots))))
    groups, budget = groups_of(problem.threat), Budget()
    assert groups.has_listed(10_000, budget)
    size = ListedSize(problem.threat, ro.AttackParams())
    size.run(groups, 0, budget)
    assert size.least == truth


@pytest.mark.parametrize("seed", range(30))
def test_weakest_sets_bound_the_worst_case(seed):
    problem, plan = team_problem(seed, 7, graph=nx.gnp_random_graph(7, 0.6, seed=seed))
    forced = without_stages(
        "thresholds", "every attack", "listed columns", "branch and bound", "dual prices", "size vectors"
    )
    with forced:
        found = ro.worst_case_attack(problem, plan)
    truth = worst_value(problem, plan)
    assert found.lower <= truth * (1 + 1e-9) + 1e-12
    assert found.upper >= truth * (1 - 1e-9)
