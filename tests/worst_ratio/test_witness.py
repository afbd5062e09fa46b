"""Families of instances: the limit family against the exact worst-case ratio, both by replay."""

from dataclasses import replace
from fractions import Fraction

import pytest

from ratt_opt import InputError, ProofError, worst_case_ratio
from ratt_opt.worst_ratio.witness import attaining_instance, limit_instance, limit_ratio, replay


@pytest.mark.parametrize(
    ("size", "c"),
    [
        (1, Fraction(1, 3)),
        (2, Fraction(1, 3)),
        (2, Fraction(4, 5)),
        pytest.param(3, Fraction(4, 5), marks=pytest.mark.slow),
        pytest.param(3, Fraction(1, 3), marks=pytest.mark.slow),
    ],
)
def test_the_family_has_its_ratio_and_curvature(size: int, c: Fraction) -> None:
    witness = limit_instance(size, c)
    assert replay(witness) == limit_ratio(size, c)
    with pytest.raises(ProofError, match="curvature"):
        replay(replace(witness, curvature=c - Fraction(1, 1000)))


@pytest.mark.parametrize("size", [1, 2])
def test_the_family_is_the_worst_for_its_size(size: int) -> None:
    c = Fraction(1, 2)
    found = worst_case_ratio(2 * size, size, 0, curvature=c, family="nondecreasing")
    assert found.exact_lower == found.exact_upper == limit_ratio(size, c)


def test_the_family_tends_to_the_pattern_free_bound_from_above() -> None:
    c = Fraction(1, 2)
    ratios = [limit_ratio(size, c) for size in (1, 10, 100, 10_000)]
    assert ratios == sorted(ratios, reverse=True)
    assert 0 < ratios[-1] - (1 - c) ** 2 < Fraction(1, 1000)


@pytest.mark.parametrize(
    ("size", "k"),
    [(1, Fraction(0)), (2, Fraction(1, 3)), (2, Fraction(1, 2)), (3, Fraction(1, 2)), (3, Fraction(2, 3))],
)
def test_one_minus_k_is_attained(size: int, k: Fraction) -> None:
    witness = attaining_instance(size, k)
    assert replay(witness) == 1 - k
    if k:
        with pytest.raises(ProofError, match="curvature"):
            replay(replace(witness, curvature=k - Fraction(1, 1000)))


def test_the_attaining_family_ends_where_its_curvature_would_be_exceeded() -> None:
    with pytest.raises(InputError, match=r"curvature must be in \[0, 1/2\]"):
        attaining_instance(2, Fraction(51, 100))
