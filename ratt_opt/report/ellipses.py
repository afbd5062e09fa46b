"""Ellipses that hold a share of a two-dimensional Gaussian, as every map draws them."""

from __future__ import annotations

from math import atan2, log, sqrt
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from ratt_opt._validation import FloatArray

__all__ = ["SIGMAS", "ellipse_of"]

SIGMAS = sqrt(-2 * log(1 - 0.95))
"""Half-axes of the ellipse that holds 95 % of a Gaussian, in standard deviations: its square is chi-square (2)."""


def ellipse_of(covariance: FloatArray) -> list[float]:
    """Half-axes [m], the long one first, and angle [rad] of the 95 % ellipse of a covariance (2, 2) [m^2]."""
    variances, axes = np.linalg.eigh(covariance)
    long, short = SIGMAS * np.sqrt(np.clip(variances[::-1], 0.0, None))
    return [float(long), float(short), atan2(axes[1, 1], axes[0, 1])]
