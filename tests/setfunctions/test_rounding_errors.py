"""What computing an inverse may have rounded, and how far rounding leaves matrices from semidefinite."""

import numpy as np

from ratt_opt.setfunctions.rounding_errors import inverse_error, is_definite, negative_parts, shrunk_to_semidefinite
from tests.coordinates.test_published_ends import spread_prior
from tests.exact_values import is_definite as is_positive
from tests.exact_values import matrix, rational


def test_the_error_of_an_inverse_is_no_larger_than_needed():
    rng = np.random.default_rng(1)
    for digits in range(12):
        prior = np.array([spread_prior(rng, 3, digits) for _ in range(3)])
        inverse = np.linalg.inv(prior)
        for a, y, bound in zip(prior, inverse, inverse_error(prior, inverse), strict=True):
            rest = matrix(y.tolist()) - matrix(a.tolist()).inv()
            size = sum(rest[i, j] ** 2 for i in range(3) for j in range(3))
            assert size <= rational(bound) ** 2 <= size * rational(1.1)


def drawn(rng):
    """Symmetric matrices that are singular, or nearly, of all sizes; with zeros and huge ratios now and then."""
    d = int(rng.integers(1, 5))
    rows = rng.normal(size=(int(rng.integers(1, d + 1)), d)) * 10.0 ** rng.uniform(-8, 8)
    rows *= rng.choice([0.0, 1.0, 1e-3, 1e-200], p=[0.2, 0.6, 0.15, 0.05], size=d)
    if rng.random() < 0.3:
        rows = np.round(rows)
    square = rows.T @ rows
    square[np.diag_indices(d)] *= 1 + rng.choice([0, 1e-16, -1e-16, 2e-16, -1e-12, 1e-9], size=d)
    return (square + square.T) / 2


def test_no_eigenvalue_is_further_below_zero_than_is_said():
    rng, sizes = np.random.default_rng(5), set()
    for _ in range(2000):
        given = drawn(rng)
        missing = float(negative_parts(given[None])[0])
        moved = matrix(given.tolist())
        for i in range(len(given)):
            # Positive definite with any more: a smaller number than any entry's square.
            moved[i, i] += rational(missing) + rational(1e-300) ** 4
        assert is_positive(moved)
        assert missing <= 200 * 2.0**-53 * np.abs(given).max() + max(0.0, -2.01 * np.linalg.eigvalsh(given)[0])
        sizes.add((len(given), missing > 0))
    assert sizes == {(d, below) for d in range(1, 5) for below in (False, True)} - {(1, True)}


def test_planar_and_diagonal_matrices_are_told_semidefinite_exactly():
    for exact in (np.outer([1, 3], [1, 3]), np.diag([0.0, 2.0, 5e-9]), np.outer([0, 2, 1], [0, 2, 1])):
        assert negative_parts(exact[None].astype(float)).tolist() == [0.0]
    rng, found = np.random.default_rng(7), set()
    for _ in range(200):
        row = rng.normal(size=2)
        rank_one = np.outer(row, row)
        found.add(is_semidefinite(rank_one))
        assert (negative_parts(rank_one[None])[0] == 0) == is_semidefinite(rank_one)
    assert found == {True, False}


def test_rounding_in_planar_blocks_is_taken_back():
    rng = np.random.default_rng(9)
    rows = rng.normal(size=(500, 2, 1, 4)) * [1.0, 0.0, 1e-5, 0.0]
    given = np.swapaxes(rows, -1, -2) @ rows
    given[:, 1, 3, 3] = 1.0  # another block, of one coordinate
    found = shrunk_to_semidefinite(given)
    assert (negative_parts(given) > 0).mean() > 0.1
    assert not negative_parts(found).any()
    assert (np.abs(found - given) <= 8 * 2.0**-52 * np.abs(given)).all()
    assert shrunk_to_semidefinite(found) is found
    beyond = np.array([[[1.0, 1.0], [1.0, 1 - 1e-12]]])
    assert (shrunk_to_semidefinite(beyond) == beyond).all()


def is_semidefinite(square):
    exact = matrix(square.tolist())
    return exact[0, 0] * exact[1, 1] >= exact[0, 1] ** 2


def test_definiteness_is_decided_exactly():
    rng, found = np.random.default_rng(6), set()
    for _ in range(300):
        given = drawn(rng)
        found.add(is_definite(given))
        assert is_definite(given) == is_positive(matrix(given.tolist()))
    assert found == {True, False}
