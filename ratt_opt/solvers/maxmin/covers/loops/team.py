"""The team whose plans are searched, and what groups of it are worth, compiled.

Symmetric matrices are packed by rows of the lower triangle; T = d (d + 1) / 2.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from ratt_opt.running.compiling import numba
from ratt_opt.setfunctions.criteria.trace import TraceObjective

__all__ = [
    "add",
    "bound_robot",
    "group_values",
    "log_determinant",
    "raised",
    "strongest_of",
    "tells",
    "total_of",
    "value_of",
]

PLANAR = 3
TRACE = TraceObjective.compiled_code
SWEEPS = 8
"""Rounds of Jacobi's rotations; the remaining other entries are rounding."""
ONE = np.uint64(1)


@numba.njit(cache=True)
def raised(first: Any, second: Any, out: Any) -> None:
    """``out = A + (B - A)_+``, no smaller than either of two packed matrices."""
    if len(first) != PLANAR:
        _raised_of_any_dimension(first, second, out)
        return
    a, b, c = second[0] - first[0], second[1] - first[1], second[2] - first[2]
    middle, half = (a + c) / 2, np.sqrt((a - c) ** 2 / 4 + b * b)
    if middle >= half:
        share, low = 1.0, 0.0
    elif middle <= -half:
        share, low = 0.0, 0.0
    else:
        share, low = (middle + half) / (2 * half), middle - half  # times the projector (X - low) / (high - low)
    x, y, z = first[0] + share * (a - low), first[1] + share * b, first[2] + share * (c - low)
    out[0], out[1], out[2] = x, y, z


@numba.njit(cache=True)
def _raised_of_any_dimension(first: Any, second: Any, out: Any) -> None:
    d = 1
    while d * (d + 1) // 2 < len(first):
        d += 1
    matrix, axes = np.empty((d, d)), np.zeros((d, d))
    for i in range(d):
        axes[i, i] = 1.0
        for j in range(i + 1):
            k = i * (i + 1) // 2 + j
            matrix[i, j] = matrix[j, i] = second[k] - first[k]
    for _ in range(SWEEPS):
        for p in range(d - 1):
            for q in range(p + 1, d):
                _rotate(matrix, axes, p, q)
    for i in range(d):
        for j in range(i + 1):
            k = i * (i + 1) // 2 + j
            more = 0.0
            for m in range(d):
                more += max(matrix[m, m], 0.0) * axes[i, m] * axes[j, m]
            out[k] = first[k] + more


@numba.njit(cache=True)
def _rotate(matrix: Any, axes: Any, p: int, q: int) -> None:
    """Jacobi's rotation: the entry (p, q) becomes 0."""
    if matrix[p, q] == 0.0:
        return
    angle = 0.5 * np.arctan2(2 * matrix[p, q], matrix[q, q] - matrix[p, p])
    cosine, sine = np.cos(angle), np.sin(angle)
    for k in range(len(matrix)):
        x, y = matrix[k, p], matrix[k, q]
        matrix[k, p], matrix[k, q] = cosine * x - sine * y, sine * x + cosine * y
    for k in range(len(matrix)):
        x, y = matrix[p, k], matrix[q, k]
        matrix[p, k], matrix[q, k] = cosine * x - sine * y, sine * x + cosine * y
        x, y = axes[k, p], axes[k, q]
        axes[k, p], axes[k, q] = cosine * x - sine * y, sine * x + cosine * y


@numba.njit(cache=True)
def strongest_of(team: Any) -> Any:
    """(N, M, T) no smaller than what any element of the robot tells about the target."""
    bound = np.zeros((len(team.count), team.prior.shape[0], team.prior.shape[1]))
    for e in range(len(team.information)):
        for j in range(team.prior.shape[0]):
            if team.sees[e, j]:
                raised(bound[team.owner[e], j], team.information[e, j], bound[team.owner[e], j])
    return bound


@numba.njit(cache=True)
def bound_robot(team: Any, robot: int, mask: Any, out: Any) -> None:
    """``out`` (M, T) = no less than what any element of the mask tells."""
    for j in range(len(out)):
        for k in range(out.shape[1]):
            out[j, k] = 0.0
    place = 0
    while mask:
        if mask & ONE:
            e = team.element[robot, place]
            for j in range(len(out)):
                if team.sees[e, j]:
                    raised(out[j], team.information[e, j], out[j])
        mask >>= ONE
        place += 1


@numba.njit(cache=True)
def value_of(team: Any, j: int, matrix: Any) -> float:
    """What is gained about a target (trace or log-det) if its posterior information is a packed matrix."""
    if len(matrix) == PLANAR:
        a, c = matrix[0], matrix[2]
        determinant = a * c - matrix[1] * matrix[1]
        trace = (a + c) / determinant
    else:
        determinant, trace = _of_any_dimension(matrix)
    return float(team.baseline[j] - team.weights[j] * (trace if team.code == TRACE else -np.log(determinant)))


@numba.njit(cache=True)
def log_determinant(matrix: Any) -> float:
    """Of a packed matrix."""
    if len(matrix) == PLANAR:
        return float(np.log(matrix[0] * matrix[2] - matrix[1] * matrix[1]))
    return float(np.log(_of_any_dimension(matrix)[0]))


@numba.njit(cache=True)
def _of_any_dimension(packed: Any) -> Any:
    """The determinant of a packed matrix and the trace of its inverse, by its Cholesky factor."""
    d = 1
    while d * (d + 1) // 2 < len(packed):
        d += 1
    factor, inverse = packed.copy(), np.zeros(len(packed))
    determinant, trace = 1.0, 0.0
    for i in range(d):
        row = i * (i + 1) // 2
        for j in range(i + 1):
            other = j * (j + 1) // 2
            for k in range(j):
                factor[row + j] -= factor[row + k] * factor[other + k]
            factor[row + j] = np.sqrt(factor[row + j]) if i == j else factor[row + j] / factor[other + j]
        determinant *= factor[row + i] * factor[row + i]
        inverse[row + i] = 1.0 / factor[row + i]
        for j in range(i):
            for k in range(j, i):
                inverse[row + j] -= factor[row + k] * inverse[k * (k + 1) // 2 + j]
            inverse[row + j] /= factor[row + i]
        for j in range(i + 1):
            trace += inverse[row + j] * inverse[row + j]
    return determinant, trace


@numba.njit(cache=True)
def group_values(team: Any, strongest: Any, robots: Any) -> Any:
    """(G, M) what groups can be worth for each target; ``strongest`` (N, M, T), ``robots`` (G, N) members."""
    values, matrix = np.empty((len(robots), len(team.prior))), np.empty(team.prior.shape[1])
    for g in range(len(robots)):
        for j in range(len(team.prior)):
            for k in range(len(matrix)):
                matrix[k] = team.prior[j, k]
                for i in range(len(strongest)):
                    if robots[g, i]:
                        matrix[k] += strongest[i, j, k]
            values[g, j] = value_of(team, j, matrix)
    return values


@numba.njit(cache=True)
def total_of(team: Any, sums: Any, values: Any) -> float:
    """What is gained about all targets; ``values`` (M,) : set to what about each."""
    total = 0.0
    for j in range(len(values)):
        values[j] = value_of(team, j, sums[j])
        total += values[j]
    return total


@numba.njit(cache=True)
def add(matrices: Any, sign: float, sums: Any) -> None:
    """Add (M, T) matrices, or take them away, in place."""
    for j in range(len(sums)):
        for k in range(sums.shape[1]):
            sums[j, k] += sign * matrices[j, k]


@numba.njit(cache=True)
def tells(matrices: Any, j: int) -> bool:
    """Whether there is information about a target: no diagonal of it is zero otherwise."""
    return bool(matrices[j, 0] != 0.0 or matrices[j, -1] != 0.0)
