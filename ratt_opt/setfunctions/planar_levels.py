"""Levels of planar targets: the smallest eigenvalues of sums of two-by-two matrices, in closed form (``maxeig.py``)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from ratt_opt._validation import FloatArray

__all__ = ["PlanarLevels"]


@dataclass(frozen=True, slots=True, eq=False)
class PlanarLevels:
    """``parts`` (n, 3, M) of each element and ``prior`` (3, M): mean, even and odd part about each target.

    Both are divided by ``scale``, a power of two, so that squares neither overflow nor vanish.
    ``rounding`` : of values ``1 / level``, in these units
    """

    parts: FloatArray
    prior: FloatArray
    scale: float
    rounding: float

    @classmethod
    def of(
        cls, prior_information: FloatArray, information: FloatArray, weights: FloatArray, rounding: float
    ) -> PlanarLevels:
        """Return the parts of (M, d, d) prior information and (n, M, d, d) information, ``d`` at most 2.

        ``rounding`` : of values [unit of the criterion]
        """
        prior = _parts(prior_information / weights[:, None, None])
        scale = float(2.0 ** np.round(np.log2(prior[0].max())))
        return cls(_parts(information / weights[:, None, None]) / scale, prior / scale, scale, rounding * scale)


def _parts(matrices: FloatArray) -> FloatArray:
    """(..., M, d, d) -> (..., 3, M)."""
    if matrices.shape[-1] == 1:
        mean = matrices[..., 0, 0]
        return np.stack([mean, np.zeros_like(mean), np.zeros_like(mean)], axis=-2)
    first, last = matrices[..., 0, 0], matrices[..., 1, 1]
    return np.stack([(first + last) / 2, (first - last) / 2, matrices[..., 0, 1]], axis=-2)
