"""Compiled inner loops of the level program: what its multipliers prove, and the cuts its mixture violates."""

from __future__ import annotations

from typing import Any

import numba
import numpy as np

__all__ = ["ceiling", "violated"]

MARGIN = 1e-12
"""Safety margin for rounding, relative to the sum of the absolute terms."""


@numba.njit(cache=True)
def ceiling(scores: Any, constants: Any, weights: Any, robot: Any) -> float:
    """Largest weighted sum of forms ``constants + scores . z`` over all contexts: each robot's best option.

    Parameters
    ----------
    scores : (F, n); constants, weights : (F,); robot : (n,) ascending
    """
    n = len(robot)
    combined = np.zeros(n)
    total, size = 0.0, 0.0
    for c, weight in enumerate(weights):
        if weight != 0.0:
            total += weight * constants[c]
            size += abs(weight * constants[c])
            for k in range(n):
                combined[k] += weight * scores[c, k]
    best = -np.inf
    for k in range(n):
        best = max(best, combined[k])
        if k + 1 == n or robot[k + 1] != robot[k]:
            total += best
            size += abs(best)
            best = -np.inf
    return float(total + MARGIN * size)


@numba.njit(cache=True)
def violated(parts: Any, base: Any, z: Any, limit: float, most: int) -> Any:
    """Targets of the mixture ``z`` (n,) whose level is below a limit, weakest first, and their weakest angles."""
    total = base.copy()
    for k, share in enumerate(z):
        if share != 0.0:
            for p in range(3):
                for j in range(total.shape[1]):
                    total[p, j] += share * parts[k, p, j]
    level = total[0] - np.hypot(total[1], total[2])
    targets = np.argsort(level)[:most]
    targets = targets[level[targets] < limit]
    return targets, np.arctan2(-total[2][targets], -total[1][targets])
