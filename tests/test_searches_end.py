"""Every search ends by itself: on weak, huge, tied and useless data, and with too few values for its next step.

An improvement below the rounding of what values were subtracted from once sent exchanges in a circle; a budget too
small for the next step was neither spent nor left.
"""

import networkx as nx
import numpy as np
import pytest

import ratt_opt as ro
from analysis.faults.moments import Square
from tests.oracles import brute_force_optimum, brute_force_worst_case
from tests.strategies import OBJECTIVES
from tests.watchdog import ends_within

SAMPLE, ALL = 36, 1200
"""Cases of a normal run, and of the whole sweep."""
DATA = ("weak", "huge", "tied", "useless", "mixed")
DONE = {ro.Stop.CLOSED, ro.Stop.EXHAUSTED, ro.Stop.GAP}


def information_of(kind: str, rng: np.random.Generator, shape: tuple[int, int], d: int) -> np.ndarray:
    """Rank-one information of elements about targets, of a kind that rounds badly beside a prior of about 1."""
    h = rng.normal(size=(*shape, 1, d))
    if kind == "tied":
        h = h[rng.integers(0, 2, shape[0])]
    scale = {
        "weak": 10.0 ** rng.uniform(-12, -4),
        "huge": 10.0 ** rng.uniform(4, 11),
        "tied": 10.0 ** rng.uniform(-9, 3),
        "useless": 0.0,
        "mixed": 10.0 ** rng.uniform(-10, 8, size=(*shape, 1, 1)),
    }[kind]
    h = h * np.sqrt(scale)
    return np.swapaxes(h, -1, -2) @ h


def drawn(seed: int, most_robots: int) -> ro.Problem:
    """A complete or random network whose data are hard to compare."""
    rng = np.random.default_rng([seed, 61])
    n_robots, targets, d = int(rng.integers(5, most_robots + 1)), int(rng.integers(1, 4)), int(rng.integers(1, 5))
    a = rng.normal(size=(targets, d, d))
    prior = (a @ np.swapaxes(a, -1, -2) + np.eye(d)) * 10.0 ** rng.uniform(-3, 3)
    information = information_of(DATA[seed % len(DATA)], rng, (n_robots, targets), d) / np.abs(prior).max()
    name = sorted(OBJECTIVES)[seed // len(DATA) % len(OBJECTIVES)]
    graph = nx.complete_graph(n_robots) if seed % 3 else nx.gnp_random_graph(n_robots, 0.6, seed=seed)
    links = graph.number_of_edges()
    budgets = int(rng.integers(0, n_robots)), int(rng.integers(0, links + 1))
    return ro.Problem(OBJECTIVES[name](prior, information), np.arange(n_robots), graph, *budgets)


def check_attack(seed: int) -> None:
    problem = drawn(seed, 14)
    plan = np.arange(problem.n_robots)
    with ends_within(20):
        found = ro.worst_case_attack(problem, plan)
    assert found.stop in DONE
    if problem.n_robots <= 5:
        worst = brute_force_worst_case(problem, plan)
        slack = 2 * problem.objective.rounding + 1e-9 * abs(worst)
        assert found.lower <= worst + slack
        assert found.upper >= worst - slack


@pytest.mark.parametrize("seed", range(SAMPLE))
def test_attacks_end_whatever_the_data(seed):
    check_attack(seed)


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(SAMPLE, ALL))
def test_more_attacks_end_whatever_the_data(seed):
    check_attack(seed)


@pytest.mark.parametrize(("seed", "n_robots", "scale"), [(300, 14, 2.8e-8), (1, 20, 1e-9), (2, 30, 1e-10)])
def test_exchanges_on_complete_graphs_end_where_gains_are_rounding(seed, n_robots, scale):
    """The first one never ended, and overran a limit of one second tenfold."""
    rng = np.random.default_rng(seed)
    h = rng.normal(size=(n_robots, 1, 1, 3)) * np.sqrt(scale)
    a = rng.normal(size=(1, 3, 3))
    objective = ro.MaxEigenvalueObjective(a @ np.swapaxes(a, -1, -2) + np.eye(3), np.swapaxes(h, -1, -2) @ h)
    problem = ro.Problem(objective, np.arange(n_robots), None, 9, 40)
    with ends_within(8):
        found = ro.worst_case_attack(problem, np.arange(n_robots), time_limit=2)
    assert found.lower <= found.upper


def check_evaluations(seed: int) -> None:
    rng = np.random.default_rng([seed, 62])
    n_robots = int(rng.integers(3, 6))
    robot = np.sort(np.concatenate([np.arange(n_robots), rng.integers(0, n_robots, int(rng.integers(0, 5)))]))
    graph = nx.gnp_random_graph(n_robots, float(rng.uniform(0.3, 1)), seed=seed)
    objective = Square(rng.integers(0, 4, len(robot)).astype(float))
    alpha_c = int(rng.integers(0, min(4, graph.number_of_edges()) + 1))
    problem = ro.Problem(objective, robot, graph, int(rng.integers(0, 3)), alpha_c)
    best = brute_force_optimum(problem)
    most = int(rng.integers(0, 400))
    with ends_within(10):
        found = ro.solve_maxmin(problem, max_evaluations=most)
        attack = ro.worst_case_attack(problem, found.elements, max_evaluations=most)
    assert found.lower <= best + 1e-9
    assert best <= found.upper + 1e-9
    assert attack.lower <= attack.upper


@pytest.mark.parametrize("seed", range(40))
def test_searches_end_when_values_run_out(seed):
    check_evaluations(seed)


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(40, 1500))
def test_more_searches_end_when_values_run_out(seed):
    check_evaluations(seed)


def test_a_budget_too_small_for_the_next_attack_ends_the_search():
    """Of 128 values 25 were left, the next attack needed more at once, and was tried again and again."""
    graph = nx.Graph([(i, j) for i in (0, 1, 2) for j in (3, 4)])
    objective = Square(np.array([3, 2, 1, 3, 1, 0, 0, 1, 1], float))
    problem = ro.Problem(objective, [4, 3, 1, 1, 0, 2, 2, 2, 1], graph, 1, 3)
    with ends_within(10):
        found = ro.solve_maxmin(problem, max_evaluations=128)
    assert found.stop in DONE | {ro.Stop.EVALUATIONS}
    assert found.lower <= 16 <= found.upper


@pytest.mark.parametrize("value", [-np.inf, np.inf, 0.0, 5.0])
def test_anything_improves_on_what_is_not_known(value):
    """An infinite threshold would keep the first value found from counting."""
    assert np.isfinite(Square(np.ones(2)).least_improvement(value))
