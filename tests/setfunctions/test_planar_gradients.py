import numpy as np
import pytest

import ratt_opt as ro
from tests.strategies import OBJECTIVES, information_data


@pytest.mark.parametrize("name", ["trace", "logdet"])
@pytest.mark.parametrize("seed", range(5))
def test_the_planar_gradient_is_the_gradient_by_entries(name, seed):
    rng = np.random.default_rng(seed)
    objective = OBJECTIVES[name](*information_data(rng, 5, 4))
    point = objective.posterior_information(np.arange(3))
    gradient = objective.planar_gradient(point[:, 0, 0], point[:, 0, 1], point[:, 1, 1])
    full = objective.gradient(point)
    assert gradient == pytest.approx(np.stack([full[:, 0, 0], 2 * full[:, 0, 1], full[:, 1, 1]], axis=-1), rel=1e-12)


def test_only_one_criterion_is_decided_by_an_axis_and_it_has_no_planar_gradient():
    rng = np.random.default_rng(0)
    for name, criterion in OBJECTIVES.items():
        assert criterion.overrides("planar_levels") == (name == "maxeig")
    with pytest.raises(ro.InputError, match=r"planar_gradient\(a, b, c\)"):
        OBJECTIVES["maxeig"](*information_data(rng, 3, 2)).planar_gradient(1.0, 0.0, 1.0)
