"""Checks of properties against their definitions over all pairs of sets."""

import time
from contextlib import suppress

import numpy as np
import pytest

import ratt_opt as ro
from ratt_opt import (
    InputError,
    LogDetObjective,
    NotFound,
    SetFunction,
    TableFunction,
    TraceObjective,
    find_modularity_violation,
    find_monotonicity_violation,
    find_negativity,
    find_normalisation_violation,
    find_subadditivity_violation,
    find_submodularity_violation,
)
from tests.setfunctions.oracle import pair_slack, worst_slack
from tests.strategies import information_data, monotone_table

CHECKS = {
    "non-negative": find_negativity,
    "non-decreasing": find_monotonicity_violation,
    "submodular": find_submodularity_violation,
    "modular": find_modularity_violation,
    "subadditive": find_subadditivity_violation,
}


def random_table(rng):
    """Any table: integers with ties, non-monotone and non-normalised; monotone; or modular plus noise now and then."""
    n = int(rng.integers(0, 8))
    kind = rng.integers(0, 5)
    if kind == 0:
        return rng.integers(-3, 4, 2**n).astype(float)
    if kind == 1:
        return rng.normal(size=2**n)
    if kind == 2:
        return monotone_table(rng, n)
    masks = np.arange(2**n)
    members = masks[:, None] >> np.arange(n) & 1
    weights = rng.integers(0, 4, n)
    if kind == 3:
        return np.sqrt(members @ weights) if rng.random() < 0.7 else (members @ weights).astype(float)
    cover = np.bitwise_or.reduce(members * rng.integers(0, 64, n), axis=1) if n else np.zeros(1, dtype=int)
    return np.array([int(c).bit_count() for c in cover], dtype=float)


@pytest.mark.parametrize("rule", sorted(CHECKS))
def test_checks_agree_with_the_definition(rule):
    rng = np.random.default_rng(1)
    outcomes = set()
    for _ in range(600):
        values = random_table(rng)
        f = TableFunction(values)
        found = CHECKS[rule](f)
        worst = worst_slack(values, rule)
        outcomes.add(found is None)
        scale = np.abs(values).max(initial=0.0)
        assert (found is None) == (worst >= -1e-9 * scale)
        if found is not None:
            assert found.slack == pytest.approx(pair_slack(f, found), abs=1e-12 * scale)
            assert found.slack < -found.tolerance
            if rule not in {"submodular", "modular", "non-decreasing"}:
                # The local forms need not find the globally worst pair, only some pair; the others do.
                assert found.slack == pytest.approx(worst, abs=1e-12 * scale)
    assert outcomes == {True, False}


def test_local_checks_return_the_worst_neighbours():
    rng = np.random.default_rng(2)
    for _ in range(200):
        n = int(rng.integers(2, 6))
        values = rng.normal(size=2**n)
        worst = min(
            values[s | 1 << i] + values[s | 1 << j] - values[s | 1 << i | 1 << j] - values[s]
            for s in range(2**n)
            for i in range(n)
            for j in range(i)
            if not (s >> i & 1 or s >> j & 1)
        )
        found = find_submodularity_violation(TableFunction(values))
        assert (worst >= 0) == (found is None)
        if found:
            assert found.slack == pytest.approx(worst)


def test_normalisation():
    assert find_normalisation_violation(TableFunction([0.0, 1.0])) is None
    found = find_normalisation_violation(TableFunction([-0.5, 1.0]))
    assert found.slack == -0.5
    assert found.inequality == "f({}) = 0"


def test_tolerance_is_relative_to_the_scale():
    values = np.array([0.0, 1.0, 1.0, 1.0 - 1e-6])
    for scale in (1e-12, 1.0, 1e12):
        f = TableFunction(scale * values)
        assert find_monotonicity_violation(f, tolerance=1e-5) is None
        found = find_monotonicity_violation(f, tolerance=1e-7)
        assert found.slack == pytest.approx(-1e-6 * scale)
        assert found.tolerance == pytest.approx(1e-7 * scale)


def test_trace_is_not_submodular_and_log_det_is():
    """The example found by search: two skewed measurements of a stretched prior help each other under the trace."""
    prior = [np.diag([10.0, 1.0])]
    information = [[np.outer(u, u)] for u in ([0, 3], [1, 3])]
    trace = TraceObjective(prior, information)
    found = find_submodularity_violation(trace)
    assert {found.a, found.b} == {(0,), (1,)}
    assert found.slack == pytest.approx(trace([0]) + trace([1]) - trace([0, 1]))
    assert found.slack < -2.9
    assert find_submodularity_violation(LogDetObjective(prior, information)) is None


def test_log_det_is_submodular_and_all_criteria_are_non_decreasing():
    rng = np.random.default_rng(3)
    for _ in range(30):
        prior, information = information_data(rng, 6, 2)
        assert find_submodularity_violation(LogDetObjective(prior, information)) is None
        assert find_monotonicity_violation(TraceObjective(prior, information)) is None


def test_large_ground_sets_are_sampled_and_say_so():
    rng = np.random.default_rng(4)
    prior, information = information_data(rng, 30, 2)
    prior = prior + np.diag([50.0, 0.0])
    trace = TraceObjective(prior, information)
    found = find_submodularity_violation(trace, trials=4000)
    assert found
    assert pair_slack(trace, found) == pytest.approx(found.slack)
    assert find_submodularity_violation(LogDetObjective(prior, information)) is None
    nothing = find_negativity(trace, trials=500)
    assert isinstance(nothing, NotFound)
    assert not nothing
    assert nothing.trials >= 500
    assert nothing.smallest_slack >= 0
    assert find_monotonicity_violation(trace) is None


def test_one_bad_set_in_a_large_table_is_found():
    n = 14
    members = np.arange(2**n)[:, None] >> np.arange(n) & 1
    values = np.sqrt(members.sum(axis=1))
    values[0b10110100101101] -= 0.5
    f = TableFunction(values)
    assert find_monotonicity_violation(f).slack < -0.3
    assert find_submodularity_violation(f).slack < -0.3


class Broken(SetFunction):
    """Not a number on the sets with element 0."""

    def __init__(self, n, value):
        self.size, self.value = n, value

    @property
    def n(self):
        return self.size

    def evaluate(self, membership):
        return np.where(membership[:, 0], self.value, membership.sum(axis=1))


@pytest.mark.parametrize("n", [5, 30])
@pytest.mark.parametrize("value", [np.nan, np.inf])
def test_values_that_are_no_numbers_are_refused(n, value):
    for check in CHECKS.values():
        with pytest.raises(InputError, match="f must have finite values"):
            check(Broken(n, value))


def test_bad_tolerances_and_trials_are_refused():
    f = TableFunction([0.0, 1.0])
    for check in (*CHECKS.values(), find_normalisation_violation):
        for tolerance in (-1.0, np.nan, "small"):
            with pytest.raises(InputError, match="tolerance must be a finite number >= 0"):
                check(f, tolerance=tolerance)
    with pytest.raises(InputError, match="trials"):
        find_negativity(Broken(30, 0.0), trials=0)


def test_tiny_ground_sets():
    for values in ([2.0], [0.0, 3.0]):
        for check in CHECKS.values():
            assert check(TableFunction(values)) is None
    assert find_monotonicity_violation(TableFunction([1.0, 0.0])).slack == -1.0


def huge_functions(size):
    """One of each class, of values or weights of so large a size."""
    yield TableFunction, [0.0, size, -size, size]
    yield ro.Modular, [size, size]
    yield ro.ConcaveOfModular, [size, size]
    yield lambda weights: ro.Coverage(np.eye(2, dtype=bool), weights), [size, size]
    yield ro.FacilityLocation, [[size, size], [size, 0.0]]
    yield lambda weights: ro.PartitionMatroidRank(weights, [0, 0], [2]), [size, size]
    yield ro.Cut, [[0.0, size], [size, 0.0]]


class Multiple(SetFunction):
    """The number of elements, times a size."""

    n = 3

    def __init__(self, size):
        self.size = size

    def evaluate(self, membership):
        return membership.sum(axis=1) * self.size


def test_huge_values_are_refused_in_one_line_and_large_ones_overflow_nowhere():
    """Warnings are errors here: of 1e308 nothing but the rule is said."""
    for make, data in huge_functions(1.7e308):
        with pytest.raises(InputError, match=r"at most 1e\+300"):
            make(data)
    for f in [Multiple(2e307), Multiple(1e308)]:
        for check in CHECKS.values():
            with pytest.raises(InputError, match=r"f must have (finite values|values of size at most 1e\+300)"):
                check(f)
    for f in [make(data) for make, data in huge_functions(1e299)] + [Multiple(1e299)]:
        for measure in (*CHECKS.values(), ro.total_curvature, ro.submodularity_ratio, ro.generalised_curvature):
            with suppress(InputError):  # a function that falls has no curvature
                measure(f)


class Slow(SetFunction):
    """A function of 24 elements in plain Python: a table takes ten minutes."""

    n = 24

    def evaluate(self, membership):
        return np.array([float(sum(sum(map(bool, row)) for _ in range(40))) ** 0.5 for row in membership])


def test_a_table_that_cannot_be_completed_is_not_begun():
    began = time.process_time()
    found = find_monotonicity_violation(Slow(), trials=500)
    assert isinstance(found, NotFound)
    assert found.trials >= 500
    assert time.process_time() - began < 3  # half a minute of the default minute went into the table


def test_what_rounding_may_explain_is_neither_found_nor_excluded():
    """The trace of sensors so weak that second differences are rounding of the prior's criterion."""
    rng = np.random.default_rng(3)
    rows = rng.normal(size=(4, 1, 1, 2)) * 1e-8
    f = TraceObjective([np.eye(2) * 3.0], np.swapaxes(rows, -1, -2) @ rows)
    found = find_submodularity_violation(f, tolerance=0.0)
    assert not found
    if found is not None:
        assert -found.tolerance <= found.smallest_slack < 0
    assert find_monotonicity_violation(f, tolerance=0.0) is None
