"""Quotients of computed marginals, and what they leave of 1, moved outward by what may have been rounded."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.setfunctions.rounding_errors import UNIT

if TYPE_CHECKING:
    from ratt_opt._validation import FloatArray

__all__ = ["complement_above", "complement_below", "quotient_above", "quotient_below"]

QUOTIENT = 8 * UNIT
"""Relative error of a quotient of a difference, and a difference, of exact numbers, with the noise added to both: seven
roundings (two differences, two sums, the quotient, the factor and the product with it), and their products."""


def quotient_below(part: FloatArray, whole: FloatArray, noise: float) -> FloatArray:
    """A lower bound on ``part / whole``, neither negative and ``whole`` positive, if each is off by up to ``noise``."""
    with np.errstate(over="ignore"):
        return np.asarray(np.maximum(part - noise, 0.0) / (whole + noise) * _share(part, whole, noise, -1.0))


def quotient_above(part: FloatArray, whole: FloatArray, noise: float) -> FloatArray:
    """An upper bound on the same; ``whole`` is more than ``noise``."""
    with np.errstate(over="ignore"):
        return np.asarray((np.maximum(part, 0.0) + noise) / (whole - noise) * _share(part, whole, noise, 1.0))


def _share(part: FloatArray, whole: FloatArray, noise: float, sign: float) -> FloatArray:
    """The factor for the quotient's own rounding: 1 if it is 1 exactly."""
    return np.where((part == whole) & (noise == 0.0), 1.0, 1.0 + sign * QUOTIENT)


def complement_above(ratio: float) -> float:
    """``1 - ratio``, rounded up, within [0, 1]."""
    return min(max(_complement(ratio, 2.0), 0.0), 1.0)


def complement_below(ratio: float) -> float:
    """``1 - ratio``, rounded down, within [0, 1]."""
    return min(max(_complement(ratio, -1.0), 0.0), 1.0)


def _complement(ratio: float, towards: float) -> float:
    return 1.0 - ratio if ratio in (0.0, 1.0) else float(np.nextafter(1.0 - ratio, towards))
