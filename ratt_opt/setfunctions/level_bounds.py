"""What inequalities between the smallest levels before, ``P``, and after, ``Q``, say about ``1/P - 1/Q``."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Sequence

    from ratt_opt._validation import FloatArray, IntArray
    from ratt_opt.setfunctions.planar import Options

__all__ = ["Average", "Forms", "ceilings", "least_marginal", "most_marginal"]

MARGIN = 1e-12
"""Safety margin for rounding, relative to the sum of the absolute terms."""


@dataclass(frozen=True, slots=True)
class Forms:
    """Lower bounds on levels: (S,) ``target``, (S, 3) ``direction``."""

    target: IntArray
    direction: FloatArray


@dataclass(frozen=True, slots=True)
class Average:
    """``t <= <cuts, total>`` with ``cuts`` (3, M), found for ``t - slope own``."""

    cuts: FloatArray
    slope: float


def least_marginal(ceiling: FloatArray, added: FloatArray, slope: FloatArray, highest: float) -> FloatArray:
    """Smallest ``1/P - 1/Q`` with ``P <= highest``, ``Q >= P + added`` and ``P - slope Q <= ceiling``, elementwise.

    Along ``Q = P + added`` it falls with ``P``; along ``Q = (P - ceiling) / slope`` it is stationary where
    ``P - ceiling = sqrt(slope) P``. So it is smallest there, where the two lines meet, or at ``highest``.
    """
    with np.errstate(all="ignore"):
        places = [
            np.full_like(ceiling, highest),
            (ceiling + slope * added) / (1 - slope),
            ceiling / (1 - np.sqrt(slope)),
        ]
        values = []
        for p in places:
            value = 1 / p - 1 / np.maximum(p + added, (p - ceiling) / slope)
            values.append(np.where((p > 0) & (p <= highest), value, np.inf))
    return np.asarray(np.minimum.reduce(values))


def most_marginal(ceiling: FloatArray, added: FloatArray, slope: FloatArray, lowest: FloatArray) -> FloatArray:
    """Largest ``1/P - 1/Q`` with ``P >= lowest``, ``Q <= P + added`` and ``Q - slope P <= ceiling``, elementwise.

    Along ``Q = P + added`` it falls with ``P``; along ``Q = ceiling + slope P`` it is stationary where
    ``Q = sqrt(slope) P``. So it is largest there, where the two lines meet, or at ``lowest``.
    """
    with np.errstate(all="ignore"):
        places = [lowest, (added - ceiling) / (slope - 1), -ceiling / (slope - np.sqrt(slope))]
        values = []
        for p in places:
            value = 1 / p - 1 / np.maximum(np.minimum(p + added, ceiling + slope * p), p)
            values.append(np.where(p >= lowest, value, 0.0))
    return np.asarray(np.maximum.reduce(values))


def ceilings(
    options: Options, base: FloatArray, own_base: FloatArray, forms: Forms, averages: Sequence[Average]
) -> FloatArray:
    """(B, S) bounds on ``t - slope own`` over all contexts, from each average's cuts, with its slope."""
    cuts = np.stack([average.cuts for average in averages])
    slope = np.array([average.slope for average in averages])[:, None]
    level = np.tensordot(options.parts, cuts, axes=((1, 2), (1, 2)))  # (K, B)
    start = np.tensordot(cuts, base, axes=((1, 2), (0, 1)))[:, None]
    own = np.einsum("kps,sp->ks", options.parts[:, :, forms.target], forms.direction)
    own_start = slope * np.einsum("ps,sp->s", own_base[:, forms.target], forms.direction)
    total, size = start - own_start, np.abs(start) + np.abs(own_start)
    if len(options.first):
        scores = level[:, :, None] - slope * own[:, None, :]
        best = np.maximum.reduceat(scores, options.first, axis=0)
        total, size = total + best.sum(axis=0), size + np.abs(best).sum(axis=0)
    return np.asarray(total + MARGIN * size)
