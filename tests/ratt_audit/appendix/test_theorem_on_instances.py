"""What the ledger proves, measured on random instances: plan, attack and optimum by the library itself."""

import numpy as np
import pytest

from ratt_opt import Problem, TableFunction, exhaustive_optimum, ratt, worst_case_attack
from tests.strategies import random_graph


def coverage(rng: np.random.Generator, n: int) -> np.ndarray:
    """Coverage of 6 weighted points plus a modular part: submodular, non-decreasing, curvature below 1."""
    covers = rng.random((n, 6)) < 0.5
    weights, own = rng.integers(0, 5, 6), rng.integers(1, 5, n)
    members = np.arange(1 << n)[:, None] >> np.arange(n) & 1
    return (members @ covers > 0) @ weights + members @ own


@pytest.mark.parametrize("seed", range(25))
def test_ratt_keeps_one_minus_k_of_the_optimum(seed: int) -> None:
    rng = np.random.default_rng(seed)
    n_robots = int(rng.integers(2, 5))
    owners = np.repeat(np.arange(n_robots), 2)
    table = coverage(rng, len(owners))
    full = len(table) - 1
    k = max(1 - (table[full] - table[full ^ 1 << e]) / table[1 << e] for e in range(len(owners)))
    graph = random_graph(rng, n_robots)
    alpha_s = int(rng.integers(0, n_robots))
    alpha_c = int(rng.integers(0, graph.number_of_edges() + 1))
    problem = Problem(TableFunction(table), owners, graph, alpha_s, alpha_c)
    kept = worst_case_attack(problem, ratt(problem).elements).lower
    assert kept >= (1 - k) * exhaustive_optimum(problem).upper - 1e-9
