"""Every family of the zoo against the definitions over all pairs of sets."""

import numpy as np
import pytest

from ratt_opt import (
    REFERENCE_FAMILIES,
    ConcaveOfModular,
    Coverage,
    Cut,
    FacilityLocation,
    InputError,
    Modular,
    PartitionMatroidRank,
    curvature,
    reference,
    total_curvature,
)
from tests.setfunctions import oracle


@pytest.mark.parametrize("family", REFERENCE_FAMILIES)
def test_what_a_reference_states_holds_by_definition(family):
    rng = np.random.default_rng([3, list(REFERENCE_FAMILIES).index(family)])
    for _ in range(25):
        known = reference(family, int(rng.integers(2, 7)), rng)
        f = known.function
        values = f.table()
        tolerance = 1e-9 * np.abs(values).max()
        assert (oracle.worst_slack(values, "non-decreasing") >= -tolerance) == known.non_decreasing
        if known.submodular is not None:
            assert (oracle.worst_slack(values, "submodular") >= -tolerance) == known.submodular
        if known.curvature is not None:
            assert known.curvature == pytest.approx(oracle.curvature(values), abs=1e-12)
            assert curvature(f).upper == pytest.approx(known.curvature, abs=1e-9)
        if known.total_curvature is not None:
            assert known.total_curvature == pytest.approx(oracle.total_curvature(values), abs=1e-12)
            found = total_curvature(f)
            assert found.lower == pytest.approx(known.total_curvature, abs=1e-9)
            assert found.upper == pytest.approx(known.total_curvature, abs=1e-9)


def test_the_same_generator_state_gives_the_same_function():
    for family in REFERENCE_FAMILIES:
        tables = [reference(family, 4, np.random.default_rng(8)).function.table() for _ in range(2)]
        assert (tables[0] == tables[1]).all()


def brute(f, worth):
    """Whether a closed form agrees with a plain definition on every subset."""
    masks = range(2**f.n)
    sets = [[e for e in range(f.n) if m >> e & 1] for m in masks]
    return np.allclose(f.table(), [worth(s) for s in sets])


def test_values_are_those_of_the_definitions():
    rng = np.random.default_rng(9)
    weights = rng.uniform(0, 3, 5)
    covers = rng.random((5, 7)) < 0.4
    items = rng.uniform(0, 2, 7)
    utility = rng.uniform(0, 2, (5, 4))
    edges = np.triu(rng.uniform(0, 1, (5, 5)), 1)
    edges = edges + edges.T
    block, capacity = np.array([0, 1, 0, 1, 0]), np.array([2, 1])

    def rank(s):
        return sum(sum(sorted((weights[e] for e in s if block[e] == b), reverse=True)[: capacity[b]]) for b in (0, 1))

    assert brute(Modular(weights), lambda s: weights[s].sum())
    assert brute(Coverage(covers, items), lambda s: items[covers[s].any(axis=0)].sum())
    assert brute(FacilityLocation(utility), lambda s: utility[s].max(axis=0, initial=0).sum())
    assert brute(Cut(edges), lambda s: sum(edges[a, b] for a in s for b in range(5) if b not in s))
    assert brute(ConcaveOfModular(weights), lambda s: np.sqrt(weights[s].sum()))
    assert brute(PartitionMatroidRank(weights, block, capacity), rank)


@pytest.mark.parametrize(
    ("make", "text"),
    [
        (lambda: Modular([1.0, np.nan]), "weights must be finite"),
        (lambda: Coverage([[True, False]], [1.0]), "covers"),
        (lambda: Coverage([[True]], [-1.0]), "item_weights must not be negative"),
        (lambda: PartitionMatroidRank([1.0], [1], [1]), "block"),
        (lambda: PartitionMatroidRank([1.0, 1.0], [0], [1]), "block"),
        (lambda: PartitionMatroidRank([1.0], [0], [-1]), "capacity"),
        (lambda: FacilityLocation([[-1.0]]), "utility must not be negative"),
        (lambda: Cut([[0.0, 1.0], [2.0, 0.0]]), "symmetric"),
        (lambda: Cut([[0.0, 1.0]]), "square"),
        (lambda: ConcaveOfModular([-1.0]), "weights must not be negative"),
        (lambda: reference("unknown", 3, np.random.default_rng(0)), "family must be one of"),
        (lambda: reference("cut", 1, np.random.default_rng(0)), "n must be an integer >= 2"),
    ],
)
def test_bad_data_is_refused(make, text):
    with pytest.raises(InputError, match=text):
        make()
