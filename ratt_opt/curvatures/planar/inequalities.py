"""Bounds on ``1/P - 1/Q`` from linear inequalities between the smallest levels before, ``P``, and after, ``Q``."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from ratt_opt._validation import FloatArray

__all__ = ["least_enough", "least_marginal", "most_enough", "most_marginal"]


def least_marginal(ceiling: FloatArray, added: FloatArray, slope: FloatArray, highest: float) -> FloatArray:
    """Smallest ``1/P - 1/Q`` with ``P <= highest``, ``Q >= P + added`` and ``P - slope Q <= ceiling``, elementwise.

    Along ``Q = P + added`` it falls with ``P``; along ``Q = (P - ceiling) / slope`` it is stationary where
    ``P - ceiling = sqrt(slope) P``. So it is smallest there, at the point
    at which the two lines meet, or at ``highest``.
    """
    with np.errstate(all="ignore"):
        end = np.full_like(ceiling, highest)
        places = [end, (ceiling + slope * added) / (1 - slope), ceiling / (1 - np.sqrt(slope))]
        values = []
        for p in places:
            value = 1 / p - 1 / np.maximum(p + added, (p - ceiling) / slope)
            values.append(np.where((p > 0) & (p <= highest), value, np.inf))
    return np.asarray(np.minimum.reduce(values))


def most_marginal(ceiling: FloatArray, added: FloatArray, slope: FloatArray, lowest: FloatArray) -> FloatArray:
    """Largest ``1/P - 1/Q`` with ``P >= lowest``, ``Q <= P + added`` and ``Q - slope P <= ceiling``, elementwise.

    Along ``Q = P + added`` it falls with ``P``; along ``Q = ceiling + slope P`` it is stationary where
    ``Q = sqrt(slope) P``. So it is largest there, at the point at which the two lines meet, or at ``lowest``.
    """
    with np.errstate(all="ignore"):
        places = [lowest, (added - ceiling) / (slope - 1), -ceiling / (slope - np.sqrt(slope))]
        values = []
        for p in places:
            value = 1 / p - 1 / np.maximum(np.minimum(p + added, ceiling + slope * p), p)
            values.append(np.where(p >= lowest, value, 0.0))
    return np.asarray(np.maximum.reduce(values))


def least_enough(target: float, added: float, slope: float, highest: float) -> float:
    """Largest ``ceiling`` for which :func:`least_marginal` is at least ``target > 0``.

    The pairs with a smaller marginal, ``Q < P / (1 - target P)``, lie between a line and a convex curve, so
    ``P - slope Q`` is smallest where these meet, or at ``highest``.
    """
    meet = _meet(target, added)
    if highest <= meet:
        return np.inf
    if target * highest >= 1:
        return -np.inf
    return min(meet - slope * (meet + added), highest - slope * highest / (1 - target * highest))


def most_enough(target: float, added: float, slope: float, lowest: float) -> float:
    """Largest ``ceiling`` for which :func:`most_marginal` is at most ``target > 0``.

    The pairs with a larger marginal lie above the convex curve ``Q = P / (1 - target P)``, on which ``Q - slope P``
    is smallest where ``Q = sqrt(slope) P``.
    """
    meet = _meet(target, added)
    if lowest >= meet:
        return np.inf
    p = min(max((1 - slope**-0.5) / target, lowest), meet)
    return float(p / (1 - target * p) - slope * p)


def _meet(target: float, added: float) -> float:
    """The ``P`` at which ``1/P - 1/(P + added)`` is ``target``."""
    product = target * added
    return 2 * added / (product + float(np.sqrt(product * (product + 4))))
