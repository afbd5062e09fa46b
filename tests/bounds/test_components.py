"""Teams that are split while they plan, each component with its own number of baits, keep the bounds by group sizes."""

import networkx as nx
import numpy as np

import ratt_opt as ro
from ratt_opt.bounds.group_size import achievable_group_size
from tests.strategies import OBJECTIVES, information_data


def split_team(rng, objective):
    """A complete team of up to five robots; some links are lost before the first message."""
    n = int(rng.integers(2, 6))
    owner = np.repeat(np.arange(n), rng.integers(1, 3, n))
    prior, information = information_data(rng, len(owner), int(rng.integers(1, 3)))
    if rng.random() < 0.4:  # equal elements: ties
        information = information[rng.integers(0, len(owner), len(owner))]
    links = n * (n - 1) // 2
    budgets = int(rng.integers(0, n)), int(rng.integers(0, links + 1))
    problem = ro.Problem(OBJECTIVES[objective](prior, information), owner, nx.complete_graph(n), *budgets)
    side = rng.integers(0, 2, n)
    lost = tuple((0, i, j) for i, j in sorted(problem.communication.links) if side[i] != side[j])
    return problem, ro.decentralised_ratt(problem, faults=ro.Faults(cuts=lost))


def check(objective, seed, share):
    rng = np.random.default_rng(seed)
    problem, plan = split_team(rng, objective)
    g = achievable_group_size(problem)
    kept, best = ro.worst_case_attack(problem, plan).upper, ro.exhaustive_optimum(problem)
    assert kept >= share(problem, g) * best.lower - 1e-9 * (1 + best.upper), seed
    return len(plan.components) > 1, g > 1


def test_submodular_functions_keep_one_of_g():
    met = [check("logdet", seed, lambda _, g: ro.group_size_bound(g, k=1.0)) for seed in range(80)]
    assert np.sum(met, axis=0).min() > 20


def test_non_decreasing_functions_keep_their_share():
    def share(problem, g):
        return ro.group_size_bound(g, c=ro.total_curvature(problem.objective, owners=problem.robot))

    met = [check("trace", seed, share) for seed in range(40)]
    assert np.sum(met, axis=0).min() > 10
