"""Intervals and verdicts."""

import math

import numpy as np
import pytest

from ratt_opt.studies.statistics import Estimate, Verdict, column, estimate, judge, select


def test_interval_is_student_t() -> None:
    # Four trials: mean 2.5, standard error sqrt(5/3)/2, and t(0.975, 3) = 3.182446.
    result = estimate([1, 2, 3, 4])
    half = 3.182446305284263 * math.sqrt(5 / 3) / 2
    assert (result.mean, result.n) == (2.5, 4)
    assert result.low == pytest.approx(2.5 - half)
    assert result.high == pytest.approx(2.5 + half)


def test_interval_covers_the_mean_as_often_as_it_says() -> None:
    rng = np.random.default_rng(0)
    hits = [abs(e.mean) <= e.high - e.mean for e in (estimate(rng.standard_normal(10)) for _ in range(2000))]
    assert 0.93 < np.mean(hits) < 0.97


def test_one_trial_proves_nothing() -> None:
    alone = estimate([-5.0])
    assert judge([alone], alone) is Verdict.NOT_CONFIRMED
    assert judge([alone, estimate([5.0])], alone) is Verdict.NOT_CONFIRMED


def test_intervals_of_many_cases_are_wider() -> None:
    one = estimate([1, 2, 3, 4])
    assert one.among(1) == one
    # The quantile t(1 - 0.025 / 5, 3) is 5.840909.
    assert (one.among(5).high - 2.5) / (one.high - 2.5) == pytest.approx(5.840909 / 3.182446, rel=1e-6)
    assert one.among(5).low + one.among(5).high == pytest.approx(5)


@pytest.mark.parametrize(
    ("intervals", "average", "verdict"),
    [
        ([(-2, -1), (-3, -0.1)], (-2, -1), Verdict.CONFIRMED),
        ([(-2, -1), (-1, 1)], (-1, -0.5), Verdict.ON_AVERAGE),
        ([(-2, -1), (-1, 1)], (-1, 0.5), Verdict.NOT_CONFIRMED),
        ([(-2, -1), (0, 0)], (-1, 0), Verdict.NOT_CONFIRMED),
        ([(-2, -1), (0.9, 1)], (-2, -1), Verdict.CONTRADICTED),
        ([(-2, -1), (0.001, 1)], (-2, -1), Verdict.ON_AVERAGE),  # one of two cases: not yet a contradiction
    ],
)
def test_verdict_weighs_every_case(
    intervals: list[tuple[float, float]], average: tuple[float, float], verdict: Verdict
) -> None:
    cases = [Estimate((low + high) / 2, low, high, 10) for low, high in intervals]
    assert judge(cases, Estimate(sum(average) / 2, *average, 10)) is verdict


def test_select_and_column_keep_the_order() -> None:
    rows = [{"case": c, "trial": str(t), "x": str(t * 1.5)} for c in "ab" for t in range(3)]
    assert column(select(rows, case="b"), "x").tolist() == [0, 1.5, 3]
    assert len(select(rows, case="b", trial=1)) == 1
