"""Parts of set functions against their definition: values, marginals and modular bounds over all sets."""

import pickle
from fractions import Fraction
from itertools import product

import numpy as np
import pytest
from scipy.optimize import linprog

import ratt_opt as ro
from ratt_opt.setfunctions.information import InformationObjective
from tests.setfunctions import oracle

CRITERIA = (ro.TraceObjective, ro.LogDetObjective, ro.MaxEigenvalueObjective)


def subsets(k):
    return np.array(list(product([False, True], repeat=k)), dtype=np.bool_).reshape(2**k, k)


def criterion(kind, rng, n=6, targets=3, d=2, **output):
    """Elements that tell about some targets, of any rank, with anisotropic priors and weights."""
    factor = rng.normal(size=(n, targets, d, int(rng.integers(1, d + 1)))) * rng.exponential(size=(n, targets, 1, 1))
    factor *= rng.random((n, targets, 1, 1)) < 0.7
    root = rng.normal(size=(targets, d, d)) + 2 * np.eye(d)
    information = factor @ np.swapaxes(factor, -1, -2)
    return kind(root @ np.swapaxes(root, -1, -2), information, rng.uniform(0.5, 2, targets), **output)


class Saturating(ro.SumFunction):
    """Each part counts its elements up to two: submodular, and no maximum."""

    is_submodular = is_non_decreasing = True

    def __init__(self, n, touches):
        super().__init__(n, len(touches), np.arange(1.0, len(touches) + 1))
        self.touches = touches

    def touching(self, part):
        return np.array(self.touches[part])

    def part_values(self, part, membership):  # noqa: ARG002
        return np.minimum(membership.sum(axis=1), 2.0)


class RootTrace(InformationObjective):
    """A formula of its own: its parts are those of the formula."""

    def criterion(self, posterior_information):
        return self.weights * (np.linalg.eigvalsh(posterior_information) ** -0.5).sum(axis=-1)

    def gradient(self, posterior_information):
        eigenvalues, vectors = np.linalg.eigh(posterior_information)
        scaled = vectors * (0.5 * eigenvalues**-1.5)[..., None, :]
        return self.weights[:, None, None] * (scaled @ np.swapaxes(vectors, -1, -2))


def sums(rng):
    """One function of every kind that is a sum, on nine elements at most."""
    yield ro.FacilityLocation(rng.integers(0, 5, (7, 4)) * rng.random())
    yield ro.FacilityLocation(rng.random((9, 3)) * (rng.random((9, 3)) < 0.6))
    yield ro.Coverage(rng.random((8, 5)) < 0.4, rng.random(5))
    table = np.maximum.accumulate(rng.random(8))
    root = ro.Part([1, 3, 6], lambda membership: np.sqrt(membership @ np.array([1.0, 2.0, 4.0])), weight=0.5)
    yield ro.SumFunction(7, [ro.Part([5, 0, 2], table, weight=2.0), root, ro.Part([], [0.25])])
    yield Saturating(9, [[0, 1, 2], [3, 4, 5, 6, 7, 8], list(range(9))])


def functions(seed):
    rng = np.random.default_rng(seed)
    yield from sums(rng)
    for kind in CRITERIA:
        yield criterion(kind, rng, d=int(rng.integers(1, 4)))
        yield criterion(RootTrace, rng)
        if kind is not ro.LogDetObjective:
            yield criterion(kind, rng, d=3, output=rng.normal(size=(2, 3)))


def test_a_function_is_the_sum_or_the_least_of_its_parts():
    for f in functions(1):
        parts, sets = f.decomposition(), subsets(f.n)
        values = np.array([parts.part_values(j, sets[:, parts.touching(j)]) for j in range(parts.n_parts)])
        whole = parts.weights @ values if parts.is_sum else values.min(axis=0)
        assert whole == pytest.approx(f.evaluate(sets), abs=1e-12 * np.abs(values).max())
        assert parts.is_sum != isinstance(f, ro.MaxEigenvalueObjective)


@pytest.mark.parametrize("seed", range(4))
def test_no_element_adds_more_to_a_part_than_its_bound(seed):
    for f in functions(seed):
        parts = f.decomposition()
        for j in range(parts.n_parts):
            k = len(parts.touching(j))
            table = parts.part_values(j, subsets(k)[:, ::-1])
            bounds = parts.marginal_bounds(j)
            for e in range(k):
                steps = table.reshape(-1, 2, 1 << e)
                assert (steps[:, 1] - steps[:, 0]).max() <= bounds[e]


@pytest.mark.parametrize("seed", range(4))
def test_overestimators_bound_every_set(seed):
    rng = np.random.default_rng([7, seed])
    for f in functions(seed):
        parts = f.decomposition()
        for j in range(parts.n_parts):
            sets = subsets(len(parts.touching(j)))
            values = parts.part_values(j, sets)
            for share in (np.zeros(sets.shape[1]), *(rng.random((4, sets.shape[1])) ** rng.integers(1, 4))):
                bound = parts.overestimator(j, share)
                assert (bound.gains >= 0).all()
                assert (bound.constant + sets @ bound.gains - values).min() >= 0


def parts_of_twelve(rng):
    """One function of every kind whose parts twelve elements touch at most: enumerated parts, maxima and criteria."""
    n = int(rng.integers(2, 13))
    yield ro.FacilityLocation(rng.random((n, 2)) * 10.0 ** rng.integers(-3, 4))
    yield ro.Coverage(rng.random((n, 2)) < rng.uniform(0.2, 0.9), rng.random(2))
    table = np.maximum.accumulate(rng.random(2**n)) if rng.random() < 0.5 else rng.random(2**n)
    mass = rng.random(n)
    root = ro.Part(range(n), lambda membership: np.sqrt(membership @ mass), weight=2.0)
    yield ro.SumFunction(n, [ro.Part(rng.permutation(n), table), root])
    for kind in CRITERIA:
        yield criterion(kind, rng, n=n, targets=2, d=int(rng.integers(1, 4)))


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(100))
def test_a_hundred_thousand_overestimators_bound_every_set(seed):
    """A thousand inequalities a seed, each against all sets of the elements that touch its part."""
    rng, done = np.random.default_rng([8, seed]), 0
    while done < 1000:
        for f in parts_of_twelve(rng):
            parts = f.decomposition()
            for j in range(parts.n_parts):
                sets = subsets(len(parts.touching(j)))
                values, whole = parts.part_values(j, sets), sets.astype(np.float64)
                for _ in range(20):
                    share = rng.random(sets.shape[1]) ** rng.integers(1, 4) * (rng.random(sets.shape[1]) < 0.8)
                    bound = parts.overestimator(j, share)
                    assert (bound.gains >= 0).all()
                    assert (bound.constant + whole @ bound.gains - values).min() >= 0
                    done += 1


def test_overestimators_of_maxima_hold_in_exact_arithmetic():
    rng = np.random.default_rng(3)
    for _ in range(30):
        f = ro.FacilityLocation(rng.random((5, 1)) * 10.0 ** rng.integers(-3, 4))
        bound = f.overestimator(0, rng.random(5))
        for members in subsets(5):
            best = max((Fraction(u) for u in f.utility[members, 0]), default=Fraction(0))
            assert Fraction(bound.constant) + sum(map(Fraction, bound.gains[members])) >= best


def envelope(values, sets, share):
    """The concave envelope at a point, by its definition: the best convex combination of sets."""
    rows = np.vstack([sets.T.astype(float), np.ones(len(sets))])
    return -linprog(-values, A_eq=rows, b_eq=np.append(share, 1.0)).fun


def test_overestimators_are_envelopes_of_maxima_and_of_enumerated_parts():
    rng = np.random.default_rng(4)
    for f in sums(rng):
        for j in range(f.n_parts):
            k = len(f.touching(j))
            share = rng.random(k)
            # At least 0 gains: the envelope of non-decreasing parts over all smaller points too.
            values, sets = f.part_values(j, subsets(k)), subsets(k)
            best = envelope(values, sets, share)
            assert f.overestimator(j, share).at(share) == pytest.approx(best, rel=1e-7, abs=1e-9)


def test_level_sets_bound_a_large_part_as_well_as_its_formula():
    rng = np.random.default_rng(5)
    utility = rng.integers(0, 8, (40, 2)).astype(float)

    class Own(ro.SumFunction):
        is_submodular = is_non_decreasing = True

        def touching(self, part):  # noqa: ARG002
            return np.arange(40)

        def part_values(self, part, membership):
            return (membership * utility[:, part]).max(axis=1, initial=0.0)

    own, known = Own(40, 2), ro.FacilityLocation(utility)
    for _ in range(20):
        share = rng.random(40) * rng.random() / 4
        for part in range(2):
            whole = np.zeros(40)
            whole[known.touching(part)] = share[known.touching(part)]
            best = known.overestimator(part, share[known.touching(part)]).at(share[known.touching(part)])
            assert own.overestimator(part, whole).at(whole) == pytest.approx(best)


class Roots(ro.SumFunction):
    """The root of a weight, and the largest weight: submodular parts of any size."""

    is_submodular = is_non_decreasing = True

    def __init__(self, weight):
        super().__init__(len(weight), 2, [1.0, 3.0])
        self.weight = weight

    def touching(self, part):  # noqa: ARG002
        return np.arange(self.n)

    def part_values(self, part, membership):
        return np.sqrt(membership @ self.weight) if part == 0 else (membership * self.weight).max(axis=1, initial=0.0)


@pytest.mark.parametrize("seed", range(6))
def test_base_sets_bound_every_set_of_a_large_submodular_part(seed):
    rng = np.random.default_rng([9, seed])
    f, sets = Roots(rng.exponential(size=14)), subsets(14)
    for part in range(2):
        values = f.part_values(part, sets)
        for share in (np.zeros(14), np.ones(14), rng.random(14), (rng.random(14) < 0.3) * 1.0):
            bound = f.overestimator(part, share)
            assert (bound.gains >= 0).all()
            assert (bound.constant + sets @ bound.gains - values).min() >= 0
            if set(share) <= {0.0, 1.0}:  # a set: the bound touches there
                assert bound.at(share) == pytest.approx(float(f.part_values(part, share[None] > 0)[0]))


def test_large_parts_of_unknown_kind_are_bounded_by_monotonicity():
    part = ro.Part(range(14), lambda membership: membership.sum(axis=1).astype(float) ** 2)
    f = ro.SumFunction(14, [part])
    assert (f.marginal_bounds(0) >= 196).all()
    assert f.overestimator(0, np.ones(14)).at(np.ones(14)) == 196
    assert f.overestimator(0, np.zeros(14)).at(np.zeros(14)) == 0


def test_extensions_and_batches_equal_single_values():
    rng = np.random.default_rng(6)
    for f in sums(rng):
        base, others = np.array([0, 3]), np.array([1, 2, 4, 5, 6])
        one_by_one = [f([0, 3, e]) for e in others]
        assert f.extensions(base, others).tolist() == pytest.approx(one_by_one)
        assert f.values_of([[0, 3, e] for e in others]).tolist() == pytest.approx(one_by_one)
    assert ro.TableFunction([0.0, 1.0, 2.0, 4.0]).values_of([[], [1, 0]]).tolist() == [0, 4]


def test_sums_are_what_theory_says():
    for f in sums(np.random.default_rng(8)):
        if f.is_submodular and f.n < 9:
            assert oracle.worst_slack(f.table(), "submodular") >= -1e-12
        copy = (
            pickle.loads(pickle.dumps(f))
            if not f.__class__.__module__.startswith("tests") and not any(callable(part.values) for part in f._parts)
            else f
        )
        assert copy([1, 2]) == f([1, 2])


def test_a_criterion_that_states_its_own_value_has_no_known_parts():
    class Own(RootTrace):
        def value(self, posterior_information):
            return np.sqrt(self._baseline.sum()) - np.sqrt(self.criterion(posterior_information).sum(axis=-1))

    assert criterion(Own, np.random.default_rng(0)).decomposition() is None
    assert ro.Modular([1.0, 2.0]).decomposition() is None


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: ro.Part([0, 0], [0.0, 1, 1, 1]), "elements"),
        (lambda: ro.Part([0, 2], [0.0, 1]), r"values must have 2\*\*2 entries; got 2"),
        (lambda: ro.Part([0], [0.0, 1], weight=-1), "weight must not be negative"),
        (lambda: ro.SumFunction(2, [ro.Part([5], [0.0, 1])]), r"elements index must be an integer in \[0, 1\]"),
        (lambda: ro.SumFunction(2, 3, [1.0, 2.0]), r"weights must have shape \(3,\)"),
        (lambda: ro.SumFunction(2, [], [1.0]), "weights must not be given beside parts"),
        (lambda: ro.SumFunction(2, 1)([0]), r"must define touching\(part\)"),
    ],
)
def test_bad_sums_are_refused(make, message):
    with pytest.raises(ro.InputError, match=message):
        make()
