"""The group-size guarantee against what RATT really keeps, by brute force."""

import numpy as np
import pytest

import ratt_opt as ro
from ratt_opt.bounds.group_size import achievable_group_size, group_size_bound
from ratt_opt.errors import InputError
from ratt_opt.solvers.ratt import equivalent_sensing_attacks
from tests.oracles import brute_force_optimum, brute_force_worst_case
from tests.strategies import monotone_table, random_graph, random_objective

FAMILIES = ("coverage", "matroid rank", "facility location", "concave of modular")


def random_problem(rng, *, submodular):
    robots = int(rng.integers(2, 5))
    owners = np.sort(np.concatenate([np.arange(robots), rng.integers(0, robots, int(rng.integers(0, 3)))]))
    if submodular:
        f = ro.reference(str(rng.choice(FAMILIES)), len(owners), rng).function
    else:
        f = (
            random_objective(rng, len(owners))
            if rng.random() < 0.5
            else ro.TableFunction(monotone_table(rng, len(owners)))
        )
    graph = random_graph(rng, robots) if rng.random() < 0.4 else None
    links = robots * (robots - 1) // 2 if graph is None else graph.number_of_edges()
    protected = frozenset(i for i in range(robots) if rng.random() < 0.15)
    return ro.Problem(f, owners, graph, int(rng.integers(0, robots)), int(rng.integers(0, links + 1)), protected)


def check(seeds, *, submodular):
    """Kept share minus promise over random problems; how many had something to keep."""
    useful = 0
    for seed in seeds:
        problem = random_problem(np.random.default_rng([51, submodular, seed]), submodular=submodular)
        optimum = brute_force_optimum(problem)
        if optimum <= 1e-9:
            continue
        useful += 1
        given = (
            {"k": ro.curvature(problem.objective, problem.robot)}
            if submodular
            else {"c": ro.total_curvature(problem.objective, problem.robot)}
        )
        survive = equivalent_sensing_attacks(problem) > 0
        promised = group_size_bound(achievable_group_size(problem), baits_survive=survive, **given)
        kept = brute_force_worst_case(problem, ro.ratt(problem).elements)
        assert kept >= promised * optimum - 1e-9 * max(1.0, optimum), seed
    return useful


@pytest.mark.parametrize("submodular", [True, False])
def test_ratt_keeps_the_group_size_bound(submodular):
    assert check(range(250), submodular=submodular) > 120


@pytest.mark.slow
@pytest.mark.parametrize("submodular", [True, False])
def test_ratt_keeps_the_group_size_bound_on_ten_thousand_problems(submodular):
    assert check(range(1000, 11_000), submodular=submodular) > 5_000


@pytest.mark.parametrize(
    ("given", "bound"),
    [
        ({"g": 1, "k": 1.0}, 1.0),
        ({"g": 2, "k": 0.3}, 0.5),
        ({"g": 0, "c": 1.0}, 1.0),
        ({"g": 1, "c": 1.0}, 1.0),
        ({"g": 3, "c": 0.5}, 0.2),
        ({"g": 3, "c": 1.0}, 0.0),
        ({"g": 2, "k": 1.0, "baits_survive": False}, 0.5),
        ({"g": 1, "k": 0.25, "baits_survive": False}, 0.8),
        ({"g": 1, "c": 0.25, "baits_survive": False}, 0.75),
    ],
)
def test_values(given, bound):
    assert group_size_bound(**given) == pytest.approx(bound)


def test_the_paper_budget_with_one_robot_a_group_makes_ratt_optimal():
    problem = ro.random_scenario(4, 4, alpha_s=2, alpha_c=4, seed=0).problem()
    assert achievable_group_size(problem) == 1
    best = ro.solve_maxmin(problem)
    assert ro.worst_case_attack(problem, ro.ratt(problem).elements).upper == pytest.approx(best.upper, rel=1e-9)


@pytest.mark.parametrize(
    ("given", "text"), [({"g": -1, "k": 0.5}, "g must"), ({"g": 1}, "k, c"), ({"g": 1, "c": 2}, "c must")]
)
def test_bad_input(given, text):
    with pytest.raises(InputError, match=text):
        group_size_bound(**given)
