"""The program over coverage functions against the full one, and beyond it."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction

import pytest

from analysis.ratios.coverage_program import coverage_instance
from ratt_opt import ProofError, worst_case_ratio
from ratt_opt.worst_ratio.closed_form import known_ratio
from ratt_opt.worst_ratio.witness import replay


@pytest.mark.parametrize("k", ["1/4", "3/8", "2/5", "1/2", "3/5", "4/5"])
@pytest.mark.parametrize("size", [2, 3])
def test_with_one_blinded_robot_it_finds_the_worst_ratio(size, k):
    ratio, witness = coverage_instance(size, 1, Fraction(k))
    assert ratio == replay(witness) == worst_case_ratio(size + 1, 1, 0, curvature=k, family="submodular").exact_lower
    with pytest.raises(ProofError, match="curvature"):
        replay(replace(witness, curvature=Fraction(k) - Fraction(1, 10)))


@pytest.mark.parametrize(("size", "swapped", "k"), [(5, 1, "2/5"), (4, 2, "2/5"), (5, 2, "1/2")])
def test_six_and_seven_robots_where_the_pattern_free_bound_is_attained(size, swapped, k):
    ratio, witness = coverage_instance(size, swapped, Fraction(k))
    assert ratio == 1 - Fraction(k) == known_ratio(witness).lower


def test_it_is_never_below_a_proof():
    for size, swapped in ((4, 1), (5, 1), (3, 2), (3, 3)):
        for k in (Fraction(1, 2), Fraction(9, 10)):
            found = coverage_instance(size, swapped, k)
            assert found is not None
            assert found[0] >= known_ratio(found[1]).lower
