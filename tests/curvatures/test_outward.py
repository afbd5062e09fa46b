"""No end of a curvature or ratio goes beyond the exact value: of rationals, or of balls where values are irrational."""

from fractions import Fraction

import numpy as np
import pytest
from flint import arb

import ratt_opt as ro
from tests.exact_values import ExactValues
from tests.strategies import OBJECTIVES

pytestmark = pytest.mark.usefixtures("exact_balls")


class Covered(ro.SetFunction):
    """A weighted coverage that states nothing of itself; rows of a batch round in different ways."""

    def __init__(self, covers, weights):
        self.covers, self.weights = covers.astype(float), weights

    @property
    def n(self):
        return len(self.covers)

    def evaluate(self, membership):
        return ((membership @ self.covers) > 0) @ self.weights


class Declared(Covered):
    is_submodular = True


def exact_table(n, value):
    """Value of every mask by a function of the set."""
    return [value([e for e in range(n) if mask >> e & 1]) for mask in range(2**n)]


def gains(values, n):
    """Exact marginals: of each element, {mask without it: gain}."""
    return [{s: values[s | 1 << x] - values[s] for s in range(2**n) if not s >> x & 1} for x in range(n)]


def exact_ends(values, n):
    """Total curvature, submodularity ratio and generalised curvature, from their definitions."""
    of = gains(values, n)
    kept = [min(g.values()) / max(g.values()) for g in of if max(g.values()) > 0]
    total = 1 - min([*kept, 1])
    bent = [g[b] / g[a] for g in of for a in g for b in g if a & b == a and g[a] > 0]
    ratio = [
        sum((of[x][s] for x in range(n) if (top & ~s) >> x & 1), 0 * values[0]) / (values[top] - values[s])
        for top in range(2**n)
        for s in range(2**n)
        if s & top == s and values[top] > values[s]
    ]
    return total, min([*ratio, 1]), 1 - min([*bent, 1])


def check(f, values):
    """All three brackets hold the exact values of the table (rationals)."""
    total, ratio, bent = exact_ends(values, f.n)
    for found, exact in (
        (ro.total_curvature(f), total),
        (ro.submodularity_ratio(f), ratio),
        (ro.generalised_curvature(f), bent),
    ):
        assert Fraction(found.lower) <= exact <= Fraction(found.upper)
    return total, ratio, bent


def coverage(rng, whole):
    n, items = int(rng.integers(2, 6)), 7
    weights = rng.integers(0, 5, items).astype(float) if whole else rng.random(items) * 10.0 ** rng.integers(-6, 6)
    covers = rng.random((n, items)) < 0.35
    exact = [Fraction(w) for w in weights.tolist()]
    values = exact_table(n, lambda s: sum((exact[j] for j in range(items) if covers[s, j].any()), Fraction(0)))
    return covers, weights, values


@pytest.mark.parametrize("whole", [True, False])
@pytest.mark.parametrize("seed", range(40))
def test_coverages_are_submodular_and_no_end_excludes_the_exact_value(seed, whole):
    covers, weights, values = coverage(np.random.default_rng([seed, 61]), whole)
    for f in (Covered(covers, weights), Declared(covers, weights), ro.Coverage(covers, weights)):
        assert check(f, values)[1] == 1
        assert ro.submodularity_ratio(f).upper == 1
        assert ro.find_submodularity_violation(f) is None
        if f.is_submodular:
            assert ro.submodularity_ratio(f).lower == 1
    if whole:
        tight = ro.total_curvature(ro.Coverage(covers, weights))
        assert tight.upper - tight.lower <= 4e-15


@pytest.mark.parametrize("seed", range(60))
def test_tables_with_zeros_and_huge_values_have_ends_that_hold(seed):
    rng = np.random.default_rng([seed, 62])
    n = int(rng.integers(1, 5))
    values = rng.random((2,) * n) * 10.0 ** rng.choice([-200, -8, 0, 8, 200], (2,) * n)
    values[rng.random((2,) * n) < 0.3] = 0.0
    for axis in range(n):
        np.maximum.accumulate(values, axis=axis, out=values)
    flat = values.ravel()
    check(ro.TableFunction(flat), [Fraction(v) for v in flat.tolist()])


def criterion(seed):
    """Weak, strong and silent elements, small and large priors of one to three coordinates."""
    rng = np.random.default_rng([seed, 63])
    kind, d, n, targets = ("trace", "logdet", "maxeig")[seed % 3], 1 + seed // 3 % 3, 3, int(rng.integers(1, 3))
    turn = np.linalg.qr(rng.normal(size=(targets, d, d)))[0]
    spread = 10.0 ** rng.uniform(0, rng.choice([0, 2, 6]), (targets, 1, d)) * 10.0 ** rng.uniform(-3, 3)
    prior = (turn * spread) @ np.swapaxes(turn, -1, -2)
    rows = rng.normal(size=(n, targets, int(rng.integers(1, d + 1)), d)) * 10.0 ** rng.uniform(-6, 1, (n, 1, 1, 1))
    information = np.swapaxes(rows, -1, -2) @ rows
    information[rng.random(n) < 0.15] = 0.0
    symmetric = [(x + np.swapaxes(x, -1, -2)) / 2 for x in (prior, information)]
    return OBJECTIVES[kind](*symmetric)


def check_criterion(seed):
    """Exact marginals are balls: an end is false if it lies surely beyond; gains that may be 0 restrict nothing."""
    f = criterion(seed)
    exact = ExactValues(ro.Problem(f, np.arange(f.n), None, 0, 0))
    of = gains(exact_table(f.n, exact), f.n)
    tiny = arb(10) ** -40
    total = ro.total_curvature(f)
    rounding = 2 * arb(ro.Problem(f, np.arange(f.n), None, 0, 0).evaluation_error)
    assert not any(max_of(of[x].values()) > rounding for x in total.useless)  # they count as adding nothing
    counted = [g for x, g in enumerate(of) if x not in total.useless]
    surely = [min_of(g.values()) / max_of(g.values()) for g in counted if max_of(g.values()) > tiny]
    if surely:
        assert not any(min_of(g.values()) < -rounding for g in of)  # information is semidefinite up to rounding
        curved = min_of([1 - min_of(surely), arb(1)])
        assert not curved < arb(total.lower) - tiny
        assert not curved > arb(total.upper) + tiny
    alone = [min_of(g.values()) / g[0] for g in of if g[0] > tiny]
    if f.is_submodular:
        assert not 1 - min_of([*alone, arb(1)]) < arb(ro.curvature(f).lower) - tiny
        assert (ro.submodularity_ratio(f).lower, ro.submodularity_ratio(f).upper) == (1, 1)
    assert ro.find_monotonicity_violation(f) is None
    assert f.name != "logdet" or ro.find_submodularity_violation(f) is None
    return total


def min_of(balls):
    balls = list(balls)
    best = balls[0]
    for ball in balls[1:]:
        best = best.min(ball)
    return best


def max_of(balls):
    return -min_of([-ball for ball in balls])


@pytest.mark.parametrize("seed", range(60))
def test_criteria_have_ends_that_hold(seed):
    check_criterion(seed)


@pytest.mark.slow
@pytest.mark.parametrize("block", range(20))
def test_criteria_have_ends_that_hold_for_many(block):
    found = [check_criterion(1000 + 100 * block + k) for k in range(100)]
    assert sum(total.upper - total.lower < 1e-6 for total in found) > 30


@pytest.mark.parametrize("seed", range(40))
def test_a_worst_axis_that_nobody_sees_is_no_fall(seed):
    """Every robot sees the same line of a target with an isotropic prior: the criterion stays, up to rounding."""
    rng = np.random.default_rng(seed)
    d, n, targets = int(rng.integers(2, 5)), int(rng.integers(1, 5)), int(rng.integers(1, 3))
    h = rng.normal(size=(targets, 1, d))
    information = np.stack([np.swapaxes(h, 1, 2) @ h * rng.uniform(0.5, 3) for _ in range(n)])
    prior = np.stack([np.eye(d) * rng.choice([1.0, 4.0, 100.0, 0.3]) for _ in range(targets)])
    f = ro.MaxEigenvalueObjective(prior, information)
    assert ro.find_monotonicity_violation(f) is None
    assert ro.total_curvature(f).lower == 0
    assert (ro.submodularity_ratio(f).upper, ro.generalised_curvature(f).lower) == (1, 0)


class MutualInformation(ro.SetFunction):
    """``I(S; rest)`` of a Gaussian: submodular, symmetric, not monotone beyond half of the elements."""

    def __init__(self, covariance):
        self.covariance = covariance

    @property
    def n(self):
        return len(self.covariance)

    def evaluate(self, membership):
        return np.array([self._one(row) for row in membership])

    def _one(self, row):
        parts = (self.covariance[np.ix_(some, some)] for some in (row, ~row, row | ~row))
        inside, outside, whole = (np.linalg.slogdet(part)[1] for part in parts)
        return (inside + outside - whole) / 2


@pytest.mark.parametrize("n", [6, 30])
def test_a_function_that_falls_is_refused_however_large_it_is(n):
    places = np.random.default_rng(1).random((n, 2))
    near = np.exp(-((places[:, None] - places) ** 2).sum(axis=-1) / 0.1) + 0.1 * np.eye(n)
    f = MutualInformation(near)
    for measure in (ro.total_curvature, ro.curvature, ro.generalised_curvature, ro.submodularity_ratio):
        with pytest.raises(ro.InputError, match="f must be non-decreasing; got adding"):
            measure(f)


def test_one_rule_says_what_is_a_fall():
    """A table that falls by 1e-12 of its values is no violation, and is measured; one that falls by 1e-8 is both."""
    for size in (1.0, 1e-6, 1e9):
        slight, real = (ro.TableFunction(size * np.array([0.0, 1.0, 1.0, 1.0 - fall])) for fall in (1e-12, 1e-8))
        level = ro.TableFunction(size * np.array([1.0, 1.0 - 1e-12]))
        for f in (slight, level):
            assert ro.find_monotonicity_violation(f) is None
            assert ro.total_curvature(f).upper in (0.0, 1.0)
        assert ro.find_monotonicity_violation(real)
        with pytest.raises(ro.InputError, match="non-decreasing"):
            ro.total_curvature(real)


def test_a_declaration_is_refuted_by_a_witness():
    class Squared(Declared):
        def evaluate(self, membership):
            return membership.sum(axis=1).astype(float) ** 2

    f = Squared(np.eye(4, dtype=bool), np.ones(4))
    with pytest.raises(ro.InputError, match="f must be submodular, as it states; got"):
        ro.submodularity_ratio(f)
    assert ro.find_submodularity_violation(f)
