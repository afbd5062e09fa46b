"""Equal and dominated elements are no loss: values, optima and attacks stay as they were."""

from dataclasses import replace
from itertools import product

import numpy as np
import pytest

import ratt_opt as ro
from tests.oracles import brute_force_worst_case
from tests.strategies import OBJECTIVES, random_graph


def limited_team(seed):
    """Few robots; elements see some targets, some are equal, some tell less about everything than another."""
    rng = np.random.default_rng([seed, 3803])
    n_robots, n_targets, d = int(rng.integers(1, 5)), int(rng.integers(1, 4)), int(rng.integers(1, 4))
    owners = np.sort(np.concatenate([np.arange(n_robots), rng.integers(n_robots, size=n_robots * 3)]))
    factors = rng.normal(size=(len(owners), n_targets, d, int(rng.integers(1, d + 1))))
    factors *= rng.random((len(owners), n_targets, 1, 1)) < 0.5
    information = factors @ np.swapaxes(factors, -1, -2)
    for e in np.flatnonzero(rng.random(len(owners)) < 0.4):
        twin = rng.choice(np.flatnonzero(owners == owners[e]))
        information[e] = information[twin] * rng.choice([1.0, 0.5])
    objective = OBJECTIVES[str(rng.choice(list(OBJECTIVES)))](np.stack([np.eye(d) * 3] * n_targets), information)
    graph = None if rng.random() < 0.5 else random_graph(rng, n_robots)
    links = n_robots * (n_robots - 1) // 2 if graph is None else graph.number_of_edges()
    alphas = int(rng.integers(0, n_robots + 1)), int(rng.integers(0, links + 1))
    return ro.Problem(objective, owners, graph, *alphas)


@pytest.mark.parametrize("seed", range(150))
def test_the_best_worst_case_stays(seed):
    problem = limited_team(seed)
    reduced = ro.undominated(problem)
    information, kept = problem.objective.information, set(reduced.kept.tolist())
    for e in set(range(problem.objective.n)) - kept:
        better = [f for f in kept if problem.robot[f] == problem.robot[e]]
        lowest = np.linalg.eigvalsh(information[better] - information[e])[..., 0]
        assert (lowest > -1e-9).all(axis=1).any(), "what is dropped is dominated by something that is kept"
    values = [brute_force_worst_case(reduced, plan) for plan in product(*(c.tolist() for c in reduced.choices))]
    assert max(values) == pytest.approx(ro.exhaustive_optimum(problem).lower, abs=1e-9)
    plan = np.array([choice[-1] for choice in reduced.choices])
    assert brute_force_worst_case(reduced, plan) == pytest.approx(
        brute_force_worst_case(problem, reduced.kept[plan]), abs=1e-12
    )
    again = ro.undominated(reduced)
    assert again.kept.tolist() == list(range(len(kept)))


def test_of_equal_elements_the_first_is_kept():
    information = np.array([1.0, 2.0, 2.0, 0.0, 0.0])[:, None, None, None]
    problem = ro.Problem(ro.TraceObjective([[[1.0]]], information), [0, 0, 0, 1, 1], None, 1, 0)
    reduced = ro.undominated(problem)
    assert reduced.kept.tolist() == [1, 3]
    assert replace(reduced, alpha_s=0).kept.tolist() == [1, 3]


def test_cameras_that_turn_have_few_elements_that_matter():
    problem = ro.limited_view_scenario(10, 10, alpha_s=3, alpha_c=8, seed=0).problem()
    reduced = ro.undominated(problem)
    assert problem.objective.n == 160
    assert len(reduced.kept) < 80
    start = ro.solve_maxmin(reduced, max_nodes=3)
    assert ro.worst_case_attack(problem, reduced.kept[start.elements]).upper >= start.lower - 1e-9


def test_what_is_no_criterion_is_refused():
    with pytest.raises(ro.InputError, match="objective must be a criterion of information matrices"):
        ro.undominated(ro.Problem(ro.Modular([1.0, 2.0]), [0, 1], None, 0, 0))
    with pytest.raises(ro.InputError, match="problem must be a Problem"):
        ro.undominated(None)
