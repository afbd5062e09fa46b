"""A criterion that the library does not know: exact where sets can be listed, honestly wide beyond, never refused."""

from itertools import product
from typing import ClassVar

import numpy as np
import pytest

import ratt_opt as ro
from ratt_opt.budget import Budget
from ratt_opt.setfunctions.information import InformationObjective
from tests.curvatures.engine import SEARCHED
from tests.setfunctions import oracle
from tests.strategies import SquaredVariances, information_data

OWNERS = np.array([0, 0, 1, 1, 2, 3])


class RootOfLogDet(InformationObjective):
    """``sqrt(1 + sum of log-dets) - 1``, given as a value alone: submodular, as a concave shape of log-det."""

    is_submodular: ClassVar[bool] = True

    def value(self, posterior_information):
        logdets = np.linalg.slogdet(posterior_information)[1] - np.linalg.slogdet(self.prior_information)[1]
        return np.sqrt(1 + np.maximum(logdets.sum(axis=-1), 0.0)) - 1


CRITERIA = [SquaredVariances, RootOfLogDet]


def draw(rng, criterion):
    return criterion(*information_data(rng, 6, int(rng.integers(1, 4)), int(rng.integers(1, 4))))


@pytest.mark.parametrize("criterion", CRITERIA)
def test_curvatures_that_can_be_listed_are_their_definitions(criterion):
    rng = np.random.default_rng(61)
    for trial in range(25):
        f, owners = draw(rng, criterion), OWNERS if trial % 2 else None
        values = f.table()
        assert ro.total_curvature(f, owners).lower == pytest.approx(oracle.total_curvature(values, owners), abs=1e-8)
        if f.is_submodular:
            assert ro.curvature(f, owners).upper == pytest.approx(oracle.curvature(values, owners), abs=1e-8)
            assert "submodular by theory" in ro.curvature(f).how
        plan = [1, 3, 5]
        tables = np.array(
            [f([e for e, taken in zip(plan, s[::-1], strict=True) if taken]) for s in product([0, 1], repeat=3)]
        )
        assert ro.total_curvature(f, plan=plan).upper == pytest.approx(oracle.total_curvature(tables), abs=1e-8)


@pytest.mark.parametrize("criterion", CRITERIA)
def test_beyond_that_the_bracket_holds_and_says_what_it_rests_on(criterion):
    rng = np.random.default_rng(62)
    informative = 0
    for _ in range(25):
        f = draw(rng, criterion)
        floor, ceiling = f.marginal_ends(OWNERS, Budget())
        values, allowed = f.table(), oracle.allowed_sets(6, OWNERS)
        for x in range(6):
            found = oracle.marginals(values, x, allowed)
            assert floor[x] <= min(found) + 1e-12 * f.prior_magnitude
            assert max(found) <= ceiling[x] * (1 + 1e-9)
        exact = oracle.total_curvature(values, OWNERS)
        found = ro.total_curvature(f, OWNERS, gap=0.0, time_limit=None, params=SEARCHED)
        bent = ro.curvature(f, OWNERS, gap=0.0, time_limit=None, params=SEARCHED) if f.is_submodular else found
        for bracket in (found, bent):
            assert bracket.lower - 1e-8 <= exact <= bracket.upper + 1e-8
            assert bracket.stop in {ro.Stop.EXHAUSTED, ro.Stop.GAP, ro.Stop.CLOSED}
            assert bracket.how.startswith("bounds for all contexts and attained contexts")
        informative += found.upper < 1
    assert informative > 15 if criterion.is_submodular else informative == 0
