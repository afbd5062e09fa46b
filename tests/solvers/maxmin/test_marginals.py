"""Best plans by marginal gains: against every plan and attack, where robots see few targets."""

from pathlib import Path

import networkx as nx
import numpy as np
import pytest
from flint import fmpq, fmpq_mat

from ratt_opt import (
    LogDetObjective,
    MaxMinResult,
    Problem,
    certify,
    limited_view_scenario,
    solve_maxmin,
    verify_certificate,
)
from ratt_opt.solvers.maxmin.elements import Elements
from ratt_opt.solvers.maxmin.marginal_search import raised_information
from tests.oracles import brute_force_optimum
from tests.solvers.maxmin.engine import MARGINALS_ALONE, by_marginals, marginals
from tests.solvers.maxmin.proofs import proved_upper
from tests.strategies import sparse_problem
from tests.ways import go

CASES = 60


@pytest.fixture(autouse=True)
def by_marginals_alone(monkeypatch: pytest.MonkeyPatch) -> None:
    """No other search runs, and this one however much robots see."""
    go(monkeypatch, MARGINALS_ALONE)


def rounding(problem: Problem) -> float:
    """How wide a bracket may be where nothing is open."""
    return 20 * problem.evaluation_error + 64 * problem.objective.rounding


def check_bracket(problem: Problem, found: MaxMinResult, optimum: float) -> None:
    scale = max(1e-3, problem.objective(range(problem.objective.n)))
    slack = 1e-12 * scale + 2 * problem.evaluation_error
    assert found.lower <= optimum + slack
    assert found.upper >= optimum - slack
    if by_marginals(found):
        assert optimum - slack <= proved_upper(problem, found.proof) <= found.upper + slack


@pytest.mark.parametrize("dimension", [1, 2, 3])
def test_marginal_gains_alone_find_and_prove_the_best_plan(dimension: int, tmp_path: Path):
    proved = 0
    for seed in range(CASES):
        problem = sparse_problem(np.random.default_rng([seed, dimension, 8]), "logdet", dimension)
        optimum = brute_force_optimum(problem)
        found = solve_maxmin(problem)
        check_bracket(problem, found, optimum)
        scale = max(1e-3, problem.objective(range(problem.objective.n)))
        assert found.upper - found.lower <= 2e-9 * scale + rounding(problem)
        if by_marginals(found):
            proved += 1
            certificate = certify(problem, found, tmp_path / "c.json")
            assert certificate.verified.upper <= optimum + 1e-6 * scale
            assert verify_certificate(tmp_path / "c.json").upper >= optimum - 1e-12 * scale
    assert proved > CASES // 5


@pytest.mark.parametrize(
    ("limits", "nodes"),
    [
        *(({"run": 3}, most) for most in (1, 2, 5, 20)),
        ({"run": 3, "recorded": 8}, 100),  # long records are given up
        ({"run": 3, "room": 4}, None),  # a record grows
        *(({"tried": tried}, None) for tried in (0, 1)),
        ({"sets": 1}, None),
    ],
)
def test_brackets_are_true_whatever_is_limited(
    limits: dict[str, int], nodes: int | None, monkeypatch: pytest.MonkeyPatch
):
    """Few nodes, short records, few attacks tried at a node and few kept sets of seers cost time only."""
    go(monkeypatch, marginals(**limits))
    for seed in range(CASES // 3):
        problem = sparse_problem(np.random.default_rng([seed, 2, 8]), "logdet")
        optimum, found = brute_force_optimum(problem), solve_maxmin(problem, max_nodes=nodes)
        check_bracket(problem, found, optimum)
        if "tried" in limits:
            assert found.upper - found.lower <= 2e-9 * max(optimum, 1e-3) + rounding(problem)


@pytest.mark.parametrize("diffuse", [1e6, 1e9])
def test_brackets_are_true_where_the_prior_says_nothing(diffuse: float):
    """Values are off by more than a bracket that counts as closed is wide: what is left open then is true."""
    for seed in range(10):
        rng = np.random.default_rng([seed, 11])
        factor = rng.normal(size=(9, 4, 2, 1)) * (rng.random((9, 4)) < 0.5)[..., None, None]
        objective = LogDetObjective(diffuse * np.eye(2)[None].repeat(4, axis=0), factor @ factor.swapaxes(-1, -2))
        problem = Problem(objective, np.repeat([0, 1, 2], 3), nx.path_graph(3), 1, 0)
        check_bracket(problem, solve_maxmin(problem, max_nodes=50), brute_force_optimum(problem))


def test_raised_information_is_no_less_than_what_it_stands_for_exactly():
    for seed in range(CASES):
        rng = np.random.default_rng([seed, 12])
        axes = rng.normal(size=(3, 2, 3, 1))
        parts = axes @ axes.swapaxes(-1, -2)
        information = np.concatenate([parts, parts * rng.choice([1.0, 1 - 1e-15, 0.5, 0.0]), parts + parts[:1]])
        problem = Problem(LogDetObjective(np.eye(3)[None].repeat(2, axis=0), information), np.zeros(9, int), None, 0, 0)
        elements = Elements(problem)
        for raised, members in zip(raised_information(elements), elements.stands_for, strict=True):
            for target in range(2):
                own = exact(raised[target])
                assert is_positive(own)
                assert all(is_positive(own - exact(information[e, target])) for e in members)
            assert (
                np.allclose(raised, elements.whole.information_objective.information[members[0]], atol=1e-12)
                or len(members) > 1
            )


def is_positive(matrix: fmpq_mat) -> bool:
    """Whether no eigenvalue is negative: the signs of the characteristic polynomial alternate."""
    n = matrix.nrows()
    return all((-1) ** (n - k) * c >= 0 for k, c in enumerate(matrix.charpoly().coeffs()))


def exact(matrix: np.ndarray) -> fmpq_mat:
    return fmpq_mat([[fmpq(*float(x).as_integer_ratio()) for x in row] for row in matrix])


def test_ten_robots_with_log_det_close(tmp_path: Path):
    """Concave relaxations and covers leave 5 % of it after thirty seconds."""
    problem = limited_view_scenario(10, 10, alpha_s=3, alpha_c=8, seed=2, view=57.0).problem("logdet")
    found = solve_maxmin(problem, gap=1e-4)
    assert by_marginals(found)
    assert found.upper - found.lower <= 1e-4 * found.upper
    assert certify(problem, found, tmp_path / "c.json").upper_raised <= 1e-6 * found.upper
