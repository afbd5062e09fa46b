"""Parameters of bounds: whatever they are, no bound is false."""

from functools import cache

import networkx as nx
import numpy as np
import pytest

import ratt_opt as ro
from ratt_opt import BoundParams
from ratt_opt.bounds.group_size import achievable_group_size
from tests.extremes import at_extremes, places


@cache
def team() -> tuple[ro.Problem, float]:
    """A small team on a network, and its best worst case."""
    problem = ro.random_scenario(5, 3, alpha_s=1, alpha_c=2, seed=3).problem("logdet")
    graph = nx.cycle_graph(5)
    problem = ro.Problem(problem.objective.restricted_to(range(0, 60, 6)), problem.robot[::6], graph, 1, 2)
    return problem, ro.exhaustive_optimum(problem).lower


@pytest.mark.parametrize("place", places(BoundParams()))
def test_no_bound_is_false_at_extremes(place: str) -> None:
    problem, best = team()
    plan = ro.ratt(problem).elements
    worst, k = ro.worst_case_attack(problem, plan).lower, ro.curvature(problem.objective, problem.robot)
    smallest = achievable_group_size(problem)
    for _, params in at_extremes(BoundParams(), place):
        assert achievable_group_size(problem, params=params) >= smallest
        assert worst >= float(ro.instance_bound(problem, plan, k=k, params=params)) * best * (1 - 1e-9)
        attack = ro.worst_case_attack(problem, plan).attack
        assert ro.relaxation_bound(problem, [attack], params=params).upper >= best * (1 - 1e-9)
        assert np.isfinite(best)


def test_parameters_that_are_passed_are_used() -> None:
    problem, _ = team()
    with pytest.raises(ro.InputError, match="problem must leave at most 0 outcomes"):
        next(ro.relaxation_bounds(problem, params=BoundParams(outcomes=0)))
