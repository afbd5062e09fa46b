"""The trace of a part of the state: values, exact attacks, max-min, curvature and certificates."""

from __future__ import annotations

import copy
import json
import pickle

import numpy as np
import pytest

from ratt_opt import (
    InputError,
    Problem,
    ProofError,
    TraceObjective,
    certify,
    exhaustive_optimum,
    solve_maxmin,
    total_curvature,
    verify_certificate,
    worst_case_attack,
)
from ratt_opt.budget import Budget
from tests.oracles import brute_force_optimum, brute_force_worst_case
from tests.setfunctions import oracle
from tests.strategies import information_data, random_elements


def part_problem(rng, n_robots=4, d=4, q=2, controls=3):
    """A small problem whose criterion is the trace of ``q`` outputs of ``d`` states."""
    prior, information = information_data(rng, controls * n_robots, 2, d)
    objective = TraceObjective(prior, information, [1.0, 2.0], output=rng.normal(size=(q, d)))
    owners = np.repeat(np.arange(n_robots), controls)
    return Problem(objective, owners, None, 1, min(3, n_robots * (n_robots - 1) // 2))


@pytest.mark.parametrize("d", [2, 3, 4])
def test_the_identity_gives_the_trace(d: int) -> None:
    prior, information = information_data(np.random.default_rng(d), 6, 3, d)
    plain = TraceObjective(prior, information, [1.0, 2.0, 0.5])
    whole = TraceObjective(prior, information, [1.0, 2.0, 0.5], output=np.eye(d))
    np.testing.assert_allclose(whole.table(), plain.table(), rtol=1e-12, atol=1e-13)
    assert whole.prior_criterion == pytest.approx(plain.prior_criterion)


def test_values_are_those_of_the_definition() -> None:
    rng = np.random.default_rng(0)
    problem = part_problem(rng)
    f = problem.objective
    for subset in ([], [0], [1, 5, 8], range(12)):
        covariance = np.linalg.inv(np.linalg.inv(f.prior) + f.information[list(subset)].sum(axis=0))
        outputs = [np.trace(C @ (P - Q) @ C.T) for C, P, Q in zip(f.output, f.prior, covariance, strict=True)]
        assert f(subset) == pytest.approx(np.dot([1.0, 2.0], outputs), abs=1e-10)
    step = 1e-6 * np.eye(4)[None]
    point = f.posterior_information(np.array([2, 3]))
    slope = np.einsum("mij,mij->", f.gradient(point), np.broadcast_to(step, point.shape))
    assert float(f.value(point + step) - f.value(point - step)) / 2 == pytest.approx(slope, rel=1e-5)


@pytest.mark.parametrize("seed", range(4))
def test_attacks_and_optima_are_exact(seed: int) -> None:
    rng = np.random.default_rng(seed)
    problem = part_problem(rng, q=1 + seed % 2)
    plan = random_elements(rng, problem)
    assert worst_case_attack(problem, plan).upper == pytest.approx(brute_force_worst_case(problem, plan), rel=1e-9)
    found = solve_maxmin(problem)
    assert found.lower == pytest.approx(brute_force_optimum(problem), rel=1e-8)
    assert found.upper == pytest.approx(found.lower, rel=1e-7)


@pytest.mark.parametrize("d", [2, 4])
def test_total_curvature_brackets_every_ratio(d: int) -> None:
    problem = part_problem(np.random.default_rng(d), n_robots=3, d=d, q=1, controls=2)
    f = problem.objective
    found = total_curvature(f)
    assert found.lower - 1e-7 <= oracle.total_curvature(f.table()) <= found.upper + 1e-7


@pytest.mark.parametrize("output", [None, np.eye(3)])
def test_the_largest_marginal_may_need_a_context_that_leaves_two_axes(output) -> None:
    """A look along a well known axis tells little, unless that axis is known anyway: then much of the others."""
    look = np.array([3.0, 100.0, 0.0])
    about = np.outer(look, look) + np.diag([0.0, 0.0, 9.0])
    f = TraceObjective(np.diag([1.0, 0.1, 1.0])[None], [[about], [np.diag([0.0, 1e6, 0.0])]], output=output)
    _, largest = f.marginal_ends(np.arange(2), Budget())
    assert f([0, 1]) - f([1]) > 1.7 > f([0])
    assert f([0, 1]) - f([1]) <= largest[0]


def test_certificates_are_written_and_have_teeth(tmp_path) -> None:
    problem = part_problem(np.random.default_rng(7), n_robots=3)
    result = solve_maxmin(problem)
    path = tmp_path / "certificate.json"
    written = certify(problem, result, path)
    assert written.verified.lower_proved
    assert written.verified.lower <= exhaustive_optimum(problem).lower * (1 + 1e-9)
    good = json.loads(path.read_text())
    for change in ("output", "points", "claim"):
        bad = copy.deepcopy(good)
        if change == "output":
            bad["problem"]["output"][0][0] += 0.5
        elif change == "points":
            bad["upper"]["points"][0][0] = [x + 0.5 for x in bad["upper"]["points"][0][0]]
        else:
            bad["claim"]["upper"] = bad["claim"]["lower"] * 0.99
            bad["claim"]["lower"] = bad["claim"]["upper"] * 0.9
        path.write_text(json.dumps(bad))
        with pytest.raises(ProofError):
            verify_certificate(path)


def test_copies_and_refusals() -> None:
    problem = part_problem(np.random.default_rng(1))
    f = problem.objective
    again = pickle.loads(pickle.dumps(f))
    assert isinstance(again, TraceObjective)
    assert again([1, 2]) == f([1, 2])
    assert f.restricted_to(np.array([1, 2]))([0, 1]) == f([1, 2])
    prior, information = information_data(np.random.default_rng(1), 3, 2, 3)
    for output in (np.eye(2), np.zeros((1, 3)), np.ones((2, 3)), np.ones((3, 1, 3)), np.array([[np.nan, 0, 0]])):
        with pytest.raises(InputError, match="output"):
            TraceObjective(prior, information, output=output)
