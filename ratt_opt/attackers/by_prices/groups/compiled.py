"""Values of groups of robots in compiled code, for the registered criteria and targets of any dimension.

Imported only where compiled loops are used. Symmetric matrices are packed by rows of the lower triangle, so that
planar ones are the triples of ``setfunctions/criteria/compiled.py``. Sums are written element by element: expressions
of whole arrays and their errors take several times as long to compile.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from ratt_opt.compiling import numba
from ratt_opt.setfunctions.criteria.compiled import LOG_DET, TRACE, team_criterion

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
def _factor(packed: Any, factor: Any) -> float:
    """Cholesky factor of a packed matrix into ``factor`` (d, d); returns the determinant."""
    d, determinant = factor.shape[0], 1.0
    for i in range(d):
        for j in range(i + 1):
            rest = packed[i * (i + 1) // 2 + j]
            for k in range(j):
                rest -= factor[i, k] * factor[j, k]
            if i == j:
                determinant *= rest
                factor[i, i] = np.sqrt(rest)
            else:
                factor[i, j] = rest / factor[j, j]
    return determinant


@numba.njit(cache=True)
def _invert(factor: Any, inverse: Any) -> None:
    """Inverse of a lower-triangular ``factor`` into ``inverse``, both (d, d)."""
    d = factor.shape[0]
    for j in range(d):
        for i in range(j):
            inverse[i, j] = 0.0
        inverse[j, j] = 1.0 / factor[j, j]
        for i in range(j + 1, d):
            rest = 0.0
            for k in range(j, i):
                rest -= factor[i, k] * inverse[k, j]
            inverse[i, j] = rest / factor[i, i]


@numba.njit(cache=True)
def _criterion(code: int, weights: Any, matrices: Any) -> float:
    """Weighted criterion over all targets from packed matrices (M, T), lower is better."""
    if matrices.shape[1] == 3:
        return float(team_criterion(code, weights, matrices))
    d = int((np.sqrt(8.0 * matrices.shape[1] + 1.0) - 1.0) / 2.0 + 0.5)
    factor, inverse, total = np.zeros((d, d)), np.zeros((d, d)), 0.0
    for j in range(matrices.shape[0]):
        determinant = _factor(matrices[j], factor)
        if code == LOG_DET:
            total -= weights[j] * np.log(determinant)
            continue
        _invert(factor, inverse)  # L^-1 = inverse' inverse
        if code == TRACE:
            for row in inverse:
                for entry in row:
                    total += weights[j] * entry * entry
        else:
            total = max(total, weights[j] * np.linalg.eigvalsh(inverse.T @ inverse)[d - 1])
    return total


@numba.njit(cache=True)
def value_of(team: Any, sums: Any) -> float:
    """Value of a group whose posterior information is ``sums`` (M, T), never below 0."""
    return float(max(team.baseline - _criterion(team.code, team.weights, sums), 0.0))


@numba.njit(cache=True)
def level_of(team: Any, sums: Any) -> float:
    """A concave function of ``sums`` (M, T) that rises with the value: the inverse of the error, or the log-det value.

    The inverse of a trace of inverses or of their largest eigenvalue is concave (a parallel sum, a least eigenvalue),
    and where values saturate it does not.
    """
    error = _criterion(team.code, team.weights, sums)
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
