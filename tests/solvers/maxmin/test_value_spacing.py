"""Values that coverage teams can have, against all plans and attacks of small teams."""

from itertools import product

import numpy as np
import pytest

from ratt_opt import Problem, TraceObjective, certify, exhaustive_optimum, solve_maxmin, worst_case_attack
from ratt_opt.solvers.maxmin.elements import Task
from ratt_opt.solvers.maxmin.value_spacing import ValueSpacing
from tests.solvers.maxmin.proofs import proved_upper


def coverage_team(rng: np.random.Generator, *, robots: int, paths: int, targets: int, lost: int) -> Problem:
    """Robots whose paths see some targets each, all about as well."""
    seen = rng.random((robots * paths, targets)) < rng.uniform(0.1, 0.5)
    information = np.where(seen, 10.0 ** rng.uniform(4, 6), 0.0) * rng.uniform(0.5, 2, seen.shape)
    weights = rng.choice([1.0, 7.5]) * np.ones(targets)
    objective = TraceObjective(np.ones((targets, 1, 1)), information[..., None, None], weights=weights)
    return Problem(objective, np.repeat(np.arange(robots), paths), None, lost, 0)


@pytest.mark.parametrize("seed", range(20))
def test_each_value_of_a_plan_lies_in_an_interval_and_none_between(seed: int) -> None:
    rng = np.random.default_rng([80, seed])
    problem = coverage_team(rng, robots=3, paths=3, targets=8, lost=1)
    spacing = ValueSpacing.of(Task.of(problem), 2)
    assert spacing is not None
    values = [worst_case_attack(problem, np.array(plan)).upper for plan in product(*problem.choices)]
    for upper in rng.uniform(0, 1.1 * max(values) + 1e-3, 200):
        below, above = spacing.below(upper), spacing.next_above(upper)
        assert below <= upper
        assert not any(below < value <= upper for value in values)
        assert not any(upper < value < above for value in values)


def test_there_is_none_if_intervals_meet() -> None:
    information = np.array([[1e6, 0.0], [0.0, 0.3], [1e6, 0.3]])[..., None, None]
    problem = Problem(TraceObjective(np.ones((2, 1, 1)), information), np.array([0, 1, 1]), None, 0, 0)
    assert ValueSpacing.of(Task.of(problem), 2) is None


@pytest.mark.parametrize("seed", range(8))
def test_a_search_with_spacing_ends_at_the_exhaustive_optimum(seed: int) -> None:
    rng = np.random.default_rng([81, seed])
    problem = coverage_team(rng, robots=5, paths=4, targets=25, lost=1 + seed % 2)
    result, best = solve_maxmin(problem, gap=1e-3), exhaustive_optimum(problem).lower
    assert result.lower * (1 - 1e-12) <= best <= result.upper * (1 + 1e-12)
    assert result.upper <= result.lower * (1 + 1.1e-3)
    proved, spacing = proved_upper(problem, result.proof), result.proof.spacing
    assert spacing is not None
    assert spacing.below(proved) <= result.upper * (1 + 1e-9)


def test_a_certificate_proves_what_spacing_closes(tmp_path: object) -> None:
    problem = coverage_team(np.random.default_rng(3), robots=6, paths=5, targets=40, lost=2)
    result = solve_maxmin(problem, gap=1e-3)
    assert result.proof is not None
    assert result.proof.spacing is not None
    made = certify(problem, result, f"{tmp_path}/best.json")
    assert made.verified.upper <= result.upper * (1 + 1e-7)
