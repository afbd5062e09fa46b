"""Measures of solvers: gaps, their integral over time, penalised means, performance profiles."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from ratt_opt._validation import FloatArray

__all__ = ["Profile", "gap_integral", "gap_of", "par10", "profile", "time_to"]


def gap_of(value: float, best: float) -> float:
    """Gap of a value to the best known one, in [0, 1]: their distance over the larger size, 1 if signs differ.

    Source: Berthold, Measuring the impact of primal heuristics, Operations Research Letters 41, 2013.
    """
    if value == best:
        return 0.0
    return 1.0 if value * best < 0 else min(abs(value - best) / max(abs(value), abs(best)), 1.0)


def gap_integral(steps: Sequence[tuple[float, float]], limit: float) -> float:
    """Mean gap over the time to the limit, in [0, 1]: 1 before the first answer, then the least gap so far.

    ``steps`` : (when [s], gap), in the order of time
    """
    total, since, gap = 0.0, 0.0, 1.0
    for at, found in steps:
        if at >= limit:
            break
        if found < gap:
            total, since, gap = total + gap * (at - since), at, found
    return (total + gap * (limit - since)) / limit


def time_to(steps: Sequence[tuple[float, float]], tolerance: float) -> float:
    """First time [s] at which the gap is at most a tolerance; infinite if it never is."""
    return next((at for at, gap in steps if gap <= tolerance), math.inf)


def par10(times: Sequence[float], limit: float) -> float:
    """Mean time to solve, an instance that is not solved within the limit counting ten limits (PAR10)."""
    return float(np.mean([at if at <= limit else 10 * limit for at in times])) if times else math.nan


@dataclass(frozen=True, slots=True)
class Profile:
    """Performance profile: ``factors`` of the best solver's time, ascending, and the ``shares`` solved within them."""

    factors: FloatArray
    shares: FloatArray


def profile(times: Mapping[str, Sequence[float]]) -> dict[str, Profile]:
    """Return the performance profile of each solver.

    ``times`` : of each solver on the same instances [s], infinite if not solved

    Source: Dolan, Moré, Benchmarking optimization software with performance profiles, Mathematical Programming 91,
    2002.
    """
    if not times:
        return {}
    table = np.maximum(np.array(list(times.values()), dtype=np.float64), 1e-3)
    best = table.min(axis=0)
    found = {}
    for name, row in zip(times, table, strict=True):
        solved = np.isfinite(row)
        factors = np.sort(row[solved] / best[solved])
        found[name] = Profile(factors, np.arange(1, len(factors) + 1) / max(len(row), 1))
    return found
