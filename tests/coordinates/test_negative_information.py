"""Brackets where information is semidefinite only up to rounding, or to what the input rule admits."""

import warnings

import numpy as np
import pytest
from flint import arb

import ratt_opt as ro
from tests.exact_values import ExactValues, holds
from tests.strategies import OBJECTIVES

pytestmark = pytest.mark.usefixtures("exact_balls")

DEFECTS = (0.0, 1e-16, 1e-13, 1e-11, 0.9e-9)
"""Most negative eigenvalues, as a share of the largest."""


def drawn_problem(seed):
    """Three robots of two elements, blinded from none to all; ``None`` if the input rule refuses the information."""
    rng = np.random.default_rng([seed, 61])
    kind, d, targets = ("trace", "logdet", "maxeig")[seed % 3], int(rng.integers(1, 4)), int(rng.integers(1, 3))
    turns = np.linalg.qr(rng.normal(size=(targets, d, d)))[0] if rng.random() < 0.5 else np.eye(d)
    prior = (turns * 10.0 ** rng.uniform(-3, 6, (targets, 1, d))) @ np.swapaxes(turns, -1, -2)
    rows = rng.normal(size=(6, targets, int(rng.integers(1, d + 1)), d))
    rows *= 10.0 ** rng.uniform(-3, 2, (6, targets, 1, 1))
    values, vectors = np.linalg.eigh(np.swapaxes(rows, -1, -2) @ rows)
    if d > 1:
        values[..., 0] -= rng.choice(DEFECTS) * values[..., -1] * rng.random(values.shape[:-1])
    information = (vectors * values[..., None, :]) @ np.swapaxes(vectors, -1, -2)
    output = {"output": rng.normal(size=(1, d))} if kind != "logdet" and rng.random() < 0.3 else {}
    prior, information = ((x + np.swapaxes(x, -1, -2)) / 2 for x in (prior, information))
    try:
        with warnings.catch_warnings():
            warnings.filterwarnings("ignore", "information: negative eigenvalues")
            f = OBJECTIVES[kind](prior, information, **output)
    except ro.InputError:
        return None
    return ro.Problem(f, np.repeat(np.arange(3), 2), None, int(rng.integers(0, 4)), int(rng.integers(0, 2)))


def check(seed):
    """Every end holds the exact value of the matrices in ``objective.information``; 0 only if it is exact."""
    problem = drawn_problem(seed)
    if problem is None:
        return 0
    exact, plan = ExactValues(problem), np.array([0, 2, 4])
    attacked, best = ro.worst_case_attack(problem, plan), ro.solve_maxmin(problem)
    assert holds(attacked.lower, exact.worst_case(plan), attacked.upper)
    assert exact.team(plan, attacked.attack) <= arb(attacked.upper) + arb(10) ** -40
    assert holds(best.lower, exact.optimum(), best.upper)
    everything = ro.bounded_rational_attack(problem, plan)
    assert holds(-np.inf, exact.team(plan, everything.attack), everything.upper)
    return 1


@pytest.mark.parametrize("seed", range(45))
def test_every_end_holds_the_exact_value(seed):
    check(seed)


@pytest.mark.slow
@pytest.mark.parametrize("block", range(10))
def test_every_end_holds_the_exact_value_of_many(block):
    assert sum(check(1000 + 100 * block + k) for k in range(100)) > 50


def case(robots):
    """All robots alike: what they do not see has a variance of 1e7, and an eigenvalue of -0.9e-9 of the largest."""
    information = np.stack([np.diag([1.0, -0.9e-9])] * robots)[:, None]
    with pytest.warns(UserWarning, match=f"set to 0 in {robots} matrices"):
        return ro.TraceObjective([np.diag([1.0, 1e7])], information)


@pytest.mark.parametrize(("robots", "blinded"), [(3, 3), (3, 1), (3, 0), (12, 2), (130, 1)])
def test_repaired_information_takes_nothing_away(robots, blinded):
    """What k robots see is worth 1 - 1 / (1 + k), of the matrices without their negative eigenvalues."""
    problem = ro.Problem(case(robots), np.arange(robots), None, blinded, 0)
    true = 1 - 1 / (1 + robots - blinded)
    attacked, best = ro.worst_case_attack(problem, np.arange(robots)), ro.solve_maxmin(problem)
    assert attacked.lower <= true <= attacked.upper
    assert best.lower <= true <= best.upper
    assert best.upper - best.lower <= 1e-5
    assert attacked.upper - attacked.lower <= 1e-4 * 1e7
    if blinded == robots:
        assert (attacked.lower, attacked.upper) == (0.0, 0.0)
    elif robots < 20:
        assert ro.find_monotonicity_violation(problem.objective) is None


def test_a_difference_that_is_computed_as_zero_is_no_exact_zero():
    """An attack leaves a robot that sees: what it adds vanishes beside the prior, and is positive."""
    f = ro.TraceObjective([np.diag([1e8, 1e8])], np.diag([1e-30, 0.0])[None, None])
    problem = ro.Problem(f, [0], None, 0, 0)
    found = ro.worst_case_attack(problem, [0])
    assert found.lower <= 1e-14 <= found.upper
    assert ro.solve_maxmin(problem).upper > 0
