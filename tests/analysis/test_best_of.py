"""The best of three planners exactly, against RATT alone and against plans that all three share."""

from __future__ import annotations

from fractions import Fraction

import pytest

from analysis.ratios.best_of import best_of_three
from analysis.ratios.shared_plan import shared_plan_ratio
from ratt_opt import worst_case_ratio
from ratt_opt.budget import OutOfBudget
from ratt_opt.worst_ratio.witness import RatioQuestion

QUARTER = Fraction(1, 4)


@pytest.mark.parametrize(("n", "alpha_s"), [(2, 0), (2, 1), (3, 0), (3, 2), pytest.param(3, 1, marks=pytest.mark.slow)])
def test_it_is_no_better_than_ratt_alone(n, alpha_s):
    found = best_of_three(n, alpha_s, QUARTER)
    alone = worst_case_ratio(n, alpha_s, 0, curvature=QUARTER, family="nondecreasing")
    assert found.lower == found.upper == alone.exact_upper


@pytest.mark.slow
def test_with_four_robots_of_which_one_is_blinded_it_is_better():
    found = best_of_three(4, 1, QUARTER)
    question = RatioQuestion(n_robots=4, alpha_s=1, alpha_c=0, curvature=QUARTER, family="nondecreasing")
    alone = worst_case_ratio(4, 1, 0, curvature=QUARTER, family="nondecreasing")
    assert found.lower == found.upper == Fraction(63, 88)
    assert alone.exact_upper < found.lower <= shared_plan_ratio(question, range(4)).upper


def test_half_the_programs_prove_nothing():
    with pytest.raises(OutOfBudget):
        best_of_three(4, 1, QUARTER, time_limit=0.2)
