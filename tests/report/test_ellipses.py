"""Ellipses of maps: the share of points inside, and the axes of the definition."""

import numpy as np
import pytest

from ratt_opt.report.ellipses import SIGMAS, ellipse_of


@pytest.mark.parametrize("seed", range(4))
def test_an_ellipse_holds_its_share_of_a_gaussian(seed: int) -> None:
    rng = np.random.default_rng(seed)
    root = rng.normal(size=(2, 2))
    covariance = root @ root.T
    long, short, angle = ellipse_of(covariance)
    x, y = root @ rng.normal(size=(2, 40_000))
    along, across = x * np.cos(angle) + y * np.sin(angle), y * np.cos(angle) - x * np.sin(angle)
    assert np.mean((along / long) ** 2 + (across / short) ** 2 <= 1) == pytest.approx(0.95, abs=0.005)
    assert long >= short >= 0
    assert long * short == pytest.approx(SIGMAS**2 * np.sqrt(np.linalg.det(covariance)))
