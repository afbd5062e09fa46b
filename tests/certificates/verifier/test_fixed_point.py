"""Bounds in integers against the criteria themselves: never above, and hardly below."""

from __future__ import annotations

import numpy as np
import pytest
from flint import fmpq

from ratt_opt import problem_document, random_scenario
from ratt_opt.certificates.verifier.fixed_point import FixedPoint
from ratt_opt.certificates.verifier.statement import Statement
from tests.strategies import OBJECTIVES


@pytest.mark.parametrize("kind", OBJECTIVES)
@pytest.mark.parametrize("seed", range(8))
def test_a_set_is_worth_its_value_and_no_more(kind: str, seed: int) -> None:
    rng = np.random.default_rng([4, seed])
    scenario = random_scenario(6, 4, alpha_s=1, alpha_c=2, seed=seed)
    weights = [float(w) for w in rng.choice([1.0, 0.3, 2.5], len(scenario.targets))]
    targets = [target.replace(weight=w) for target, w in zip(scenario.targets, weights, strict=True)]
    problem = scenario.replace(targets=tuple(targets)).problem(kind)
    objective, plan = problem.information_objective, [int(rng.choice(own)) for own in problem.choices]
    eigenvalue = objective.prior_eigenvalue
    prior_range = [] if kind != "maxeig" else [eigenvalue * (1 - 1e-15), eigenvalue * (1 + 1e-15)]
    about = Statement(problem_document(problem), plan, prior_range)
    quick = FixedPoint(about, about.inverse)
    inside, others = [0, 3], [1, 2, 4, 5]
    sums = quick.start
    for i in inside:
        sums = quick.plus(sums, i)
    assert_is(quick, sums, [quick.none], 1, objective([plan[i] for i in inside]))
    for count in (1, 2, 3):
        base = objective.posterior_information(np.array([plan[i] for i in inside]))
        worths = sorted(float(objective.value(base + count * objective.information[plan[i]])) for i in others)
        worth = float(np.mean(worths[:count]))
        assert_is(quick, sums, [quick.copies(i, count) for i in others], count, worth)


def assert_is(quick: FixedPoint, sums: list, more: list, count: int, worth: float) -> None:
    """The bound is the value but for rounding of either."""
    for share, expected in ((1e-12, True), (-1e-12, False)):
        lower = fmpq(*(worth * (1 - share)).as_integer_ratio())
        assert quick.are_worth(sums, more, count, lower) is expected


def test_what_is_not_positive_definite_is_not_decided() -> None:
    problem = random_scenario(3, 2, alpha_s=0, alpha_c=0, seed=0).problem("trace")
    about = Statement(problem_document(problem), [int(own[0]) for own in problem.choices], [])
    quick = FixedPoint(about, about.inverse)
    nothing = [(0, 0, 0)] * 2
    assert not quick.are_worth(nothing, [nothing], 1, fmpq(-(10**9)))
    assert not quick.are_worth([(-1, 0, -1)] * 2, [nothing], 1, fmpq(-(10**9)))
