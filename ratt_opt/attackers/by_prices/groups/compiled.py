"""Values of groups of robots in compiled code, for the registered criteria and targets of any dimension.

Imported only where compiled loops are used. Symmetric matrices are packed by rows of the lower triangle, so that
planar ones are the triples of ``setfunctions/criteria/compiled.py``. Sums are written element by element: expressions
of whole arrays and their errors take several times as long to compile.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from ratt_opt.running.compiling import numba
from ratt_opt.setfunctions.criteria.compiled import LOG_DET, team_criterion

__all__ = ["add", "copy", "copy_row", "gather_seeing", "least_level", "level_of", "value_of"]

ROUNDING = 1e-12
"""Relative, of a value."""


@numba.njit(cache=True)
def copy(target: Any, source: Any) -> None:
    """``target[:] = source`` for two axes."""
    for j in range(target.shape[0]):
        for k in range(target.shape[1]):
            target[j, k] = source[j, k]


@numba.njit(cache=True)
def copy_row(target: Any, source: Any) -> None:
    """``target[:] = source`` for one axis."""
    for i in range(target.shape[0]):
        target[i] = source[i]


@numba.njit(cache=True)
def add(target: Any, sums: Any, times: float, team: Any, robot: int) -> None:
    """``target[:] = sums + times * (the robot's information)``, all (M, T)."""
    for j in range(target.shape[0]):
        for k in range(target.shape[1]):
            target[j, k] = sums[j, k] + times * team.information[robot, j, k]


@numba.njit(cache=True)
def value_of(team: Any, sums: Any) -> float:
    """Value of a group whose posterior information is ``sums`` (M, T), never below 0."""
    return float(max(team.baseline - team_criterion(team.code, team.weights, sums), 0.0))


@numba.njit(cache=True)
def level_of(team: Any, sums: Any) -> float:
    """A concave function of ``sums`` (M, T) that rises with the value: the inverse of the error, or the log-det value.

    The inverse of a trace of inverses or of their largest eigenvalue is concave (a parallel sum, a least eigenvalue),
    and where values saturate it does not.
    """
    error = team_criterion(team.code, team.weights, sums)
    return float(team.baseline - error if team.code == LOG_DET else 1.0 / error)


@numba.njit(cache=True)
def least_level(team: Any, threshold: float) -> float:
    """Sets whose level is this high are worth the threshold, rounding included; infinite where that is not sure."""
    error = team.baseline - threshold - ROUNDING * (abs(team.baseline) + abs(threshold))
    if team.code == LOG_DET:
        return float(team.baseline - error)
    return float(1.0 / error if error > 0.0 else np.inf)


@numba.njit(cache=True)
def gather_seeing(team: Any, group: Any, blind: Any, sums: Any) -> float:
    """Fill ``sums`` (M, T) with the information of those of ``group`` (N,) not ``blind`` (N,); returns their value."""
    copy(sums, team.prior)
    for i in range(len(group)):
        if group[i] and not blind[i]:
            add(sums, sums, 1.0, team, i)
    return float(value_of(team, sums))
