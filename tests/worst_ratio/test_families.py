"""Families of instances on which RATT is as bad as its bounds allow, by replay through the library."""

from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest

from ratt_opt import (
    InputError,
    Problem,
    ProofError,
    TableFunction,
    exhaustive_optimum,
    ratt,
    survivor_bound,
    worst_case_attack,
    worst_case_ratio,
)
from ratt_opt.worst_ratio.closed_form import known_ratio, proved_ratio, sensing_ratio, three_left_ratio
from ratt_opt.worst_ratio.families import link_only_instance, pair_instance, sensing_instance, shared_plan_instance
from ratt_opt.worst_ratio.witness import PLANNERS, attaining_instance, replay

HALF, QUARTER = Fraction(1, 2), Fraction(1, 4)


@pytest.mark.parametrize(
    ("witness", "ratio"),
    [
        (pair_instance(QUARTER), Fraction(25, 32)),
        (pair_instance(Fraction(9, 10)), Fraction(101, 200)),
        (link_only_instance(HALF), HALF),
        (link_only_instance(Fraction(2, 5)), Fraction(3, 5)),
        (sensing_instance(2, 1, QUARTER), Fraction(3, 4)),
        (sensing_instance(3, 1, QUARTER), Fraction(15, 22)),
        (sensing_instance(4, 1, HALF), Fraction(5, 14)),
        (sensing_instance(4, 1, QUARTER), Fraction(99, 148)),
        (sensing_instance(4, 1, Fraction(1, 10)), Fraction(2349, 2710)),
        (sensing_instance(3, 0, QUARTER), Fraction(9, 11)),
    ],
)
def test_the_ratio_is_attained_and_the_curvature_is_no_smaller(witness, ratio) -> None:
    assert replay(witness) == ratio
    with pytest.raises(ProofError, match="curvature"):
        replay(replace(witness, curvature=witness.curvature - Fraction(1, 1000)))


def test_the_survivor_bound_is_the_ratio_only_where_bait_can_replace_enough_greedy_robots() -> None:
    """N = 5, one robot blinded, c = 1/4: with four robots left one swap for bait is not enough."""
    found = worst_case_ratio(5, 1, 0, curvature=QUARTER, family="nondecreasing", use_theorem=False)
    assert found.exact_lower == found.exact_upper == Fraction(99, 148)
    assert found.exact_upper > survivor_bound(4, c=0.25)


@pytest.mark.parametrize(("swapped", "c"), [(-1, QUARTER), (3, QUARTER), (1, Fraction(1))])
def test_what_the_sensing_family_has_no_instance_for(swapped, c) -> None:
    with pytest.raises(InputError, match="must be in"):
        sensing_instance(2, swapped, c)


@pytest.mark.parametrize("curvature", [Fraction(3, 8), Fraction(51, 100)])
def test_the_link_family_ends_where_its_curvature_would_be_exceeded(curvature) -> None:
    with pytest.raises(InputError, match="curvature must be in"):
        link_only_instance(curvature)


@pytest.mark.parametrize("epsilon", [Fraction(1, 10), Fraction(1, 100)])
def test_without_ties_the_order_of_the_elements_does_not_matter(epsilon) -> None:
    witness = attaining_instance(2, HALF, epsilon)
    rng = np.random.default_rng(0)
    ratios = set()
    for _ in range(4):
        order = rng.permutation(2 * witness.n_robots)  # new name of each element
        masks = np.arange(len(witness.values))
        renamed = sum((masks >> e & 1) << int(order[e]) for e in range(len(order)))
        table, owners = np.empty(len(masks)), np.empty(len(order), dtype=np.int64)
        table[renamed] = witness.values
        owners[order] = np.tile(np.arange(witness.n_robots), 2)
        problem = Problem(TableFunction(table), owners, None, witness.alpha_s, 0)
        kept = worst_case_attack(problem, ratt(problem).elements).upper
        ratios.add(Fraction(int(kept), int(exhaustive_optimum(problem).lower)))
    assert ratios == {replay(witness)}
    assert HALF < ratios.pop() <= HALF + Fraction(3, 2) * epsilon


def test_a_written_proof_is_never_above_what_is_attained() -> None:
    for family in ("submodular", "nondecreasing"):
        for alpha_s, alpha_c in ((0, 0), (0, 2), (1, 0), (1, 1), (2, 0), (0, 3)):
            found = worst_case_ratio(3, alpha_s, alpha_c, curvature=HALF, family=family, use_theorem=False)
            assert found.lower_from == "multipliers"
            assert proved_ratio(found.witness) <= found.exact_lower == found.exact_upper


@pytest.mark.parametrize("c", [QUARTER, Fraction(1, 5), Fraction(1, 10)])
def test_the_closed_form_without_links_is_the_ratio(c) -> None:
    """Each is computed by multipliers and by a witness of its own, neither of which knows the formula."""
    found = worst_case_ratio(5, 1, 0, curvature=c, family="nondecreasing", use_theorem=False)
    known = known_ratio(found.witness)
    assert found.exact_lower == found.exact_upper == known.lower == sensing_ratio(4, 1, 1 - c)
    assert known.attained
    assert replay(sensing_instance(4, 1, c)) == known.lower


def test_what_is_known_agrees_with_what_is_computed() -> None:
    for family, c in (("submodular", HALF), ("nondecreasing", QUARTER), ("nondecreasing", HALF)):
        for alpha_s, alpha_c in ((0, 0), (1, 0), (2, 0), (1, 3), (0, 3), (0, 4), (3, 0)):
            found = worst_case_ratio(4, alpha_s, alpha_c, curvature=c, family=family, use_theorem=False)
            known = known_ratio(found.witness)
            assert known.lower <= found.exact_lower == found.exact_upper
            if known.attained:
                assert known.lower == found.exact_upper
            assert known.conjectured in (None, found.exact_upper)


@pytest.mark.parametrize("k", ["3/10", "5/12", "5/8", "9/10", "9/20"])
def test_the_conjecture_for_three_left_meets_values_it_was_not_made_from(k) -> None:
    found = worst_case_ratio(4, 1, 0, curvature=k, family="submodular")
    assert found.exact_lower == found.exact_upper == three_left_ratio(1 - Fraction(k))


def test_more_blinded_bait_than_robots_left_changes_nothing() -> None:
    """Without links only g and min(alpha_s, g) matter, as bait that is blinded may be worth anything."""
    for family in ("submodular", "nondecreasing"):
        fewer, more = (worst_case_ratio(n, n - 2, 0, curvature=HALF, family=family).exact_upper for n in (4, 5))
        assert fewer == more


def test_a_conjecture_fails_at_a_team_it_was_not_made_from() -> None:
    """With links the largest group attacks worth making leave counts, not the smallest: N = 6, alpha_c = 9."""
    found = worst_case_ratio(6, 0, 9, curvature=QUARTER, family="nondecreasing")
    assert found.exact_lower == found.exact_upper == Fraction(13, 20)
    assert float(survivor_bound(4, c=0.25)) == pytest.approx(13 / 20)
    assert survivor_bound(3, c=0.25) > 13 / 20


@pytest.mark.parametrize("size", [1, 2, 3])
def test_three_planners_agree_on_a_plan_that_tends_to_the_pattern_free_bound(size) -> None:
    k = Fraction(1, 3)
    witness = shared_plan_instance(size, k)
    for planner in PLANNERS:
        assert replay(replace(witness, planner=planner)) == (1 + (size - 1) * (1 - k)) / size
    assert len({tuple(plan(witness.problem()).elements) for plan in PLANNERS.values()}) == 1
