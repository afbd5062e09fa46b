"""Submodularity ratio and generalised curvature against their definitions over all pairs."""

import numpy as np
import pytest

import ratt_opt as ro
from tests.curvatures.engine import FEW_PAIRS, SEARCHED
from tests.setfunctions import oracle
from tests.strategies import monotone_table, random_objective


def random_owners(rng, n):
    return rng.integers(0, max(n // 2, 1), n) if rng.random() < 0.5 else None


def gain(f, small, large):
    return f(set(small) | set(large)) - f(small)


def rounding(f):
    """By how much a computed marginal may be off, and is taken to be: tables are rounded once, each of two values."""
    if isinstance(f, ro.TableFunction):
        return 2.0**-52 * np.abs(f.values).max()
    return 2 * ro.Problem(f, np.arange(f.n), None, 0, 0).evaluation_error


def moved(off, whole):
    """How far a quotient of at most 1 is moved outward, and the one here off, if all that it is made of is ``off``."""
    return 2 * off / (whole - off) + 1e-12 if whole > off else 1.0


def check_ratio(f, found, exact):
    """The bracket holds the exact value and its sets attain the upper end."""
    assert found.lower - 1e-9 <= exact <= found.upper + 1e-9
    if found.added:
        assert not set(found.base) & set(found.added)
        total = sum(gain(f, found.base, [w]) for w in found.added)
        whole = gain(f, found.base, found.added)
        rounded = moved(rounding(f) * (len(found.added) + 1), whole)
        assert min(total / whole, 1) == pytest.approx(found.upper, abs=rounded)


def check_curvature(f, found, exact):
    """The bracket holds the exact value and its sets attain the lower end."""
    assert found.lower - 1e-9 <= exact <= found.upper + 1e-9
    if found.element is not None:
        assert set(found.small) <= set(found.large)
        whole = gain(f, found.small, [found.element])
        kept = gain(f, found.large, [found.element]) / whole
        assert 1 - kept == pytest.approx(found.lower, abs=moved(2 * rounding(f), whole))


def test_both_agree_with_their_definitions():
    rng = np.random.default_rng(21)
    for _ in range(250):
        n = int(rng.integers(1, 6))
        f = ro.TableFunction(monotone_table(rng, n))
        owners = random_owners(rng, n)
        ratio = ro.submodularity_ratio(f, owners)
        bent = ro.generalised_curvature(f, owners)
        assert 0 <= ratio.upper - ratio.lower <= 1e-11
        assert 0 <= bent.upper - bent.lower <= 1e-11
        check_ratio(f, ratio, oracle.submodularity_ratio(f.values, owners))
        check_curvature(f, bent, oracle.generalised_curvature(f.values, owners))


@pytest.mark.parametrize("seed", range(12))
def test_brackets_hold_the_exact_value_where_the_domain_is_taken_for_too_large(seed):
    rng = np.random.default_rng([seed, 22])
    f = random_objective(rng, 6, ("trace", "logdet", "maxeig")[seed % 3])
    owners = np.array([0, 0, 1, 1, 2, 3])
    values = f.table()
    exact = oracle.submodularity_ratio(values, owners), oracle.generalised_curvature(values, owners)
    ratio = ro.submodularity_ratio(f, owners, params=FEW_PAIRS)
    check_ratio(f, ratio, exact[0])
    assert ratio.how.startswith("later marginals")
    check_ratio(f, ro.submodularity_ratio(f, owners, params=SEARCHED), exact[0])
    check_curvature(f, ro.generalised_curvature(f, owners, params=SEARCHED), exact[1])


def test_nothing_restricts_a_function_that_never_gains():
    f = ro.TableFunction(np.full(8, 2.0))
    assert ro.submodularity_ratio(f).lower == 1
    assert ro.generalised_curvature(f).upper == 0


def test_a_domain_too_large_for_a_table_has_a_bracket():
    f = ro.reference("modular", 30, np.random.default_rng(0)).function
    ratio, alpha = ro.submodularity_ratio(f), ro.generalised_curvature(f)
    assert ratio.lower <= 1 == ratio.upper
    assert abs(alpha.lower) <= 1e-12
    assert alpha.upper >= 0


@pytest.mark.parametrize("f", [ro.Modular([1.0, 2.0]), ro.TraceObjective([np.eye(2)], [[np.eye(2)]])])
def test_over_no_robots_nothing_is_restricted(f):
    assert [ro.curvature(f, plan=[]).upper, ro.total_curvature(f, plan=[]).upper] == [0, 0]
    assert (ro.submodularity_ratio(f, plan=[]).lower, ro.generalised_curvature(f, plan=[]).upper) == (1, 0)
