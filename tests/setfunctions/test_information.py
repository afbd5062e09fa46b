"""The three criteria against their definitions in plain matrix algebra."""

from itertools import combinations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import ratt_opt as ro
from ratt_opt.setfunctions.information import InformationObjective
from tests.exact_values import is_definite, matrix
from tests.strategies import OBJECTIVES, information_data


def by_definition(kind, prior, information, subset, weights=None):
    """The architecture's definition, one target at a time, by explicit inversion."""
    weights = np.ones(len(prior)) if weights is None else weights
    before, after = [], []
    for j, p in enumerate(prior):
        posterior = np.linalg.inv(p) + sum((information[e, j] for e in subset), np.zeros_like(p))
        if kind == "logdet":
            before.append(-np.linalg.slogdet(p)[1])
            after.append(np.linalg.slogdet(posterior)[1])
        elif kind == "trace":
            before.append(np.trace(p))
            after.append(np.trace(np.linalg.inv(posterior)))
        else:
            before.append(np.linalg.eigvalsh(p)[-1])
            after.append(np.linalg.eigvalsh(np.linalg.inv(posterior))[-1])
    before, after = weights * before, weights * after
    if kind == "maxeig":
        return before.max() - after.max()
    return (after - before).sum() if kind == "logdet" else (before - after).sum()


@pytest.mark.parametrize("kind", OBJECTIVES)
@pytest.mark.parametrize("dimension", [1, 2, 3, 4])
@pytest.mark.parametrize("weighted", [False, True])
def test_values_are_the_definition_s(kind, dimension, weighted):
    rng = np.random.default_rng([dimension, weighted])
    for _ in range(15):
        prior, information = information_data(rng, 6, int(rng.integers(1, 5)), dimension)
        weights = rng.uniform(0.1, 3, len(prior)) if weighted else None
        f = OBJECTIVES[kind](prior, information, weights)
        scale = abs(by_definition(kind, prior, information, range(6), weights)) + 1
        table = f.table()
        for size in range(7):
            for subset in combinations(range(6), size):
                expected = by_definition(kind, prior, information, subset, weights)
                assert abs(f(subset) - expected) < 1e-9 * scale
                assert abs(table[sum(1 << e for e in subset)] - expected) < 1e-9 * scale
        assert f([]) == 0
        assert table[0] == 0


@pytest.mark.parametrize("kind", OBJECTIVES)
def test_marginals_and_batches_are_differences_of_values(kind):
    rng = np.random.default_rng(7)
    for _ in range(30):
        f = OBJECTIVES[kind](*information_data(rng, 8, 3, int(rng.integers(1, 4))))
        members = rng.random((20, 8)) < 0.5
        assert np.allclose(f.evaluate(members), [f(np.flatnonzero(row)) for row in members], atol=1e-10)
        base = np.flatnonzero(members[0])
        candidates = np.setdiff1d(np.arange(8), base)
        expected = [f([*base, e]) for e in candidates]
        assert np.allclose(f.extensions(base, candidates), expected, atol=1e-10)


def test_extreme_scales_keep_their_digits():
    """A diffuse prior and a sharp sensor: the value is the prior's variance less the sensor's."""
    f = ro.TraceObjective([np.eye(2) * 1e6], [[np.eye(2) * 1e8]])
    assert f([0]) == pytest.approx(2e6 - 2e-8, rel=1e-14)
    g = ro.LogDetObjective([np.eye(2) * 1e6], [[np.eye(2) * 1e8]])
    assert g([0]) == pytest.approx(2 * np.log(1e14), rel=1e-12)


@pytest.mark.parametrize("kind", OBJECTIVES)
@pytest.mark.parametrize(
    ("prior", "information", "text"),
    [
        (np.zeros((0, 2, 2)), np.zeros((1, 0, 2, 2)), "prior.*at least one target"),
        ([[[1.0, 0.5], [0.0, 1.0]]], np.zeros((1, 1, 2, 2)), "prior.*symmetric"),
        ([np.diag([1.0, -1.0])], np.zeros((1, 1, 2, 2)), "prior.*positive definite"),
        ([np.diag([1.0, 0.0])], np.zeros((1, 1, 2, 2)), "prior.*positive definite"),
        ([np.eye(2) * np.nan], np.zeros((1, 1, 2, 2)), "prior.*finite"),
        ([np.eye(2)], np.full((1, 1, 2, 2), np.inf), "information.*finite"),
        ([np.eye(2)], [[np.diag([1.0, -1e-3])]], "information.*semidefinite"),
        ([np.eye(2)], np.zeros((1, 2, 2, 2)), "information.*shape"),
        ([np.eye(2)], np.zeros((0, 1, 2, 2)), "information.*at least one element"),
    ],
)
def test_bad_matrices_are_refused(kind, prior, information, text):
    with pytest.raises(ro.InputError, match=text):
        OBJECTIVES[kind](prior, information)


def test_rounding_below_zero_is_accepted_and_indices_are_checked():
    f = ro.TraceObjective([np.eye(2)], [[np.diag([1.0, -1e-10])]])
    assert f([0]) == pytest.approx(0.5)
    assert (f.repaired, f.information[0, 0, 1, 1]) == (0, -1e-10)  # slight beside the prior: ends account for it
    for bad in ([1], [-1], [0, 0], [0.5]):
        with pytest.raises(ro.InputError):
            f(bad)


@pytest.mark.parametrize("kind", OBJECTIVES)
def test_individual_values_are_kept_and_those_of_these_elements(kind, monkeypatch):
    """Four planners and the search asked for them anew: two seconds with a thousand robots, whatever the limit."""
    prior, information = information_data(np.random.default_rng(3), 6, 3, 2)
    f = OBJECTIVES[kind](prior, information)
    f.singletons()[:] = 0.0  # whoever changes the answer changes nothing else
    for one in (f, f.restricted_to(np.array([4, 1])), f.with_information(2 * information[::-1])):
        assert one.singletons() == pytest.approx([one([e]) for e in range(one.n)], rel=1e-12)
    calls, asked = [], InformationObjective.extensions
    problem = ro.Problem(OBJECTIVES[kind](prior, information), np.repeat(np.arange(3), 2), None, 1, 1)
    monkeypatch.setattr(
        InformationObjective,
        "extensions",
        lambda self, base, some: (calls.append(len(base)), asked(self, base, some))[1],
    )
    for planner in (ro.ratt, ro.greedy, ro.myopic):
        planner(problem)
    assert calls.count(0) == 1


@given(st.integers(-9, 3), st.integers(16, 24))
def test_a_prior_that_is_only_badly_scaled_is_refused_by_its_condition(low: int, decades: int) -> None:
    prior = np.diag([10.0 ** (low + decades), 10.0**low])
    with pytest.raises(ro.InputError, match=r"prior\[0\] must have a condition below 4.5e15: rescale"):
        ro.TraceObjective([prior], np.zeros((1, 1, 2, 2)))


@given(st.floats(1.5e-9, 9e-7), st.floats(0.01, 100))
def test_float32_information_is_repaired_with_a_warning(defect: float, size: float) -> None:
    given_matrix = np.diag([size, -defect * size]).astype(np.float32)
    with pytest.warns(UserWarning, match="float32 rounding repaired in 1 matrices"):
        f = ro.TraceObjective([np.eye(2)], np.array([[given_matrix]]))
    np.testing.assert_allclose(f.information[0, 0], np.diag([given_matrix[0, 0], 0]), atol=1e-12 * size)
    with pytest.raises(ro.InputError, match="positive semidefinite"):
        ro.TraceObjective([np.eye(2)], [[given_matrix.astype(np.float64)]])


@given(st.floats(1.1e-13, 9.9e-10), st.floats(1e-3, 1e3))
def test_negative_eigenvalues_that_would_count_are_set_to_zero_with_a_warning(defect: float, size: float) -> None:
    prior, matrix = np.diag([1e-2, 1e-3 / defect]) / size, np.diag([size, -defect * size])
    with pytest.warns(UserWarning, match="negative eigenvalues set to 0 in 2 matrices"):
        f = ro.TraceObjective([prior], [[matrix], [matrix]])
    assert f.repaired == 2
    assert f.information.tolist() == [[np.diag([size, 0.0]).tolist()]] * 2
    assert f.with_information(np.zeros((1, 1, 2, 2))).repaired == 0
    assert ro.find_monotonicity_violation(f) is None


def test_a_prior_that_is_definite_by_rounding_only_is_refused():
    """Its smallest eigenvalue is computed as 6e-16 to 2e-15, and is below 0 in some of them."""
    rng, refused = np.random.default_rng(8), 0
    for _ in range(300):
        turn = np.linalg.qr(rng.normal(size=(3, 3)))[0]
        prior = (turn * [1.0, 0.5, 4e-16]) @ turn.T
        prior = (prior + prior.T) / 2
        try:
            f = ro.TraceObjective([prior], np.zeros((1, 1, 3, 3)))
        except ro.InputError:
            refused += 1
        else:
            assert is_definite(matrix(f.prior[0].tolist()))
    assert 0 < refused < 300


@pytest.mark.parametrize("entry", [1e60, 1e-60])
def test_outputs_whose_squares_are_no_floats_are_refused(entry: float) -> None:
    with pytest.raises(ro.InputError, match="output must have rows whose largest entry has a size in"):
        ro.TraceObjective([np.eye(2)], np.zeros((1, 1, 2, 2)), output=[[entry, 0.0]])
