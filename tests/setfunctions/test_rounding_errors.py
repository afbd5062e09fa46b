"""What computing an inverse may have rounded."""

from __future__ import annotations

import numpy as np

from ratt_opt.setfunctions.rounding_errors import inverse_error
from tests.coordinates.test_published_ends import spread_prior
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
