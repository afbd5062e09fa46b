"""A lower bound on what choices at the slopes of one cell are worth (``slope_cells.py``): compiled.

For weights ``t`` of the corners ``C_v``, 0 or more and 1 together, the matrix ``X`` whose gradient is the mean of the
corners makes the least ``phi(X) - <C_v, X> + h(C_v)`` over the corners a bound, and their mean ``g(t)``, the conjugate
of ``phi`` at that mean of slopes plus ``sum_v t_v h(C_v)``, is at least any such bound (duality). So weights go from
the corner where they add most to the one where they add least until the bound suffices or ``g(t)`` says that no matrix
will do. At 60 robots half of the cells that four likely matrices left open are closed by the best one.

Imported only where a large team is attacked: compiling takes seconds, once per machine (cached).
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from ratt_opt.running.compiling import numba
from ratt_opt.setfunctions.criteria.compiled import matrix_of_gradient, target_value

__all__ = ["ROUNDING", "Corners", "as_gradient", "bound_again", "cell_bound", "clipped_middle"]

ROUNDING = 1e-12
"""Margin of a bound, relative to the sizes of its terms."""
SHIFTS, TRIALS = 12, 5
"""Times that weights of corners go from one to another, and how often the amount is tried; 30 and 8 save no cells, with
6 and 3 some cells do not end."""
DEFINITE = 1e-12
"""Determinant of slopes, over the square of their trace, from which a matrix has that gradient."""
SAFELY = 1e-6
"""The same where weights begin."""


class Corners(NamedTuple):
    """``white`` (V, 3) : entries of slopes in the coordinates; ``slopes`` (V, 3) in (a, b, c); ``heights`` (V,)."""

    white: Any
    slopes: Any
    heights: Any


@numba.njit(cache=True)
def as_gradient(axes: Any, white: Any) -> Any:
    """The matrix of slopes whose entries in the coordinates are ``white``."""
    p, r, s = axes
    a, b, c = white
    return p * p * a + 2 * p * r * b + r * r * c, s * (p * b + r * c), s * s * c


@numba.njit(cache=True)
def _clipped(white: Any, low: float) -> Any:
    """A triple with eigenvalues raised to ``low``, the smaller one before, and the axis that it belongs to."""
    a, b, c = white
    middle, radius = (a + c) / 2, np.sqrt(((a - c) / 2) ** 2 + b * b)
    one, two = max(middle - radius, low), max(middle + radius, low)
    x, y = ((a - c) / 2 / radius, b / radius) if radius > 0 else (1.0, 0.0)
    mean, half = (one + two) / 2, (two - one) / 2
    angle = np.arctan2(y, x) / 2 + np.pi / 2
    return (mean + half * x, half * y, mean - half * x), middle - radius, (np.cos(angle), np.sin(angle))


@numba.njit(cache=True)
def _is_outside(corners: Any, cell: Any, axis: Any, low: float) -> bool:
    """Whether slopes of the cell are too small along an axis to be gradients, or in all."""
    u, v = axis
    most, largest = -np.inf, -np.inf
    for k in cell:
        a, b, c = corners.white[k]
        most = max(most, a * u * u + 2 * b * u * v + c * v * v)
        largest = max(largest, a + c)
    return most < low or largest < 2 * low


@numba.njit(cache=True)
def _bound_with(family: Any, corners: Any, cell: Any, matrix: Any) -> float:
    """The bound of a cell with one matrix."""
    value = target_value(family.code, family.weights[0], family.prior[0], matrix)
    if value == -np.inf:
        return -np.inf
    bound, size = np.inf, 0.0
    for k in cell:
        along = 0.0
        for t in range(3):
            along += corners.slopes[k, t] * matrix[t]
            size += abs(corners.slopes[k, t] * matrix[t])
        bound = min(bound, value - along + corners.heights[k])
        size += abs(corners.heights[k])
    return bound - ROUNDING * (abs(value) + size)


@numba.njit(cache=True)
def _matrix_at(family: Any, slopes: Any) -> Any:
    """The matrix whose gradient is these slopes; zeros where there is none."""
    a, b, c = slopes[0], slopes[1] / 2, slopes[2]
    if not (a + c > 0 and a * c - b * b > DEFINITE * (a + c) ** 2):
        return 0.0, 0.0, 0.0
    return matrix_of_gradient(family.code, family.weights[0], (a, b, c))


@numba.njit(cache=True)
def _levelling(corners: Any, cell: Any) -> Any:
    """The matrix that makes all corners of a cell alike (Cramer's rule); zeros where there is none."""
    rows, right, first = np.empty((3, 3)), np.empty(3), cell[0]
    for r in range(3):
        right[r] = corners.heights[cell[r + 1]] - corners.heights[first]
        for t in range(3):
            rows[r, t] = corners.slopes[cell[r + 1], t] - corners.slopes[first, t]
    x, y, z = rows[:, 0], rows[:, 1], rows[:, 2]
    determinant = _triple_product(x, y, z)
    if determinant == 0:
        return 0.0, 0.0, 0.0
    one, two = _triple_product(right, y, z) / determinant, _triple_product(x, right, z) / determinant
    return one, two, _triple_product(x, y, right) / determinant


@numba.njit(cache=True)
def _triple_product(x: Any, y: Any, z: Any) -> float:
    return float(
        x[0] * (y[1] * z[2] - y[2] * z[1]) - y[0] * (x[1] * z[2] - x[2] * z[1]) + z[0] * (x[1] * y[2] - x[2] * y[1])
    )


@numba.njit(cache=True)
def _excess(corners: Any, pair: Any, matrix: Any) -> float:
    """By how much ``h - <C, matrix>`` of one corner exceeds that of another."""
    one, other = pair
    excess = corners.heights[one] - corners.heights[other]
    for t in range(3):
        excess -= (corners.slopes[one, t] - corners.slopes[other, t]) * matrix[t]
    return float(excess)


@numba.njit(cache=True)
def _extremes(corners: Any, cell: Any, weights: Any, matrix: Any) -> Any:
    """Where ``h - <C, matrix>`` is least, where largest among corners of some weight, and the mean less the least."""
    low, high, least, most, mean = 0, 0, 0.0, -np.inf, 0.0
    for k in range(4):
        excess = _excess(corners, (cell[k], cell[0]), matrix)
        mean += weights[k] * excess
        if excess < least:
            low, least = k, excess
        if weights[k] > 0 and excess > most:
            high, most = k, excess
    return low, high, mean - least


@numba.njit(cache=True)
def _moved(corners: Any, pair: Any, point: Any, step: float) -> Any:
    """The mean of slopes after some weight has gone from the second corner of a pair to the first."""
    slopes, (one, other) = corners.slopes, pair
    return (
        point[0] + step * (slopes[one, 0] - slopes[other, 0]),
        point[1] + step * (slopes[one, 1] - slopes[other, 1]),
        point[2] + step * (slopes[one, 2] - slopes[other, 2]),
    )


@numba.njit(cache=True)
def _shift(family: Any, corners: Any, pair: Any, point: Any, most: float) -> float:
    """How much weight to take from the second corner of a pair to the first, by false position."""
    left, right, fall, rise, step = 0.0, most, 0.0, np.inf, most
    for _ in range(TRIALS):
        matrix = _matrix_at(family, _moved(corners, pair, point, step))
        slope = np.inf if matrix[0] == 0 else _excess(corners, pair, matrix)
        if slope <= 0:
            left, fall = step, slope
            if step == most:
                break
        else:
            right, rise = step, slope
        part = 0.5 if rise == np.inf or left == 0 else min(max(fall / (fall - rise), 0.1), 0.9)
        step = left + (right - left) * part
    return left if left > 0 else right / 2 if rise < np.inf else 0.0


@numba.njit(cache=True)
def _mean(corners: Any, cell: Any, weights: Any) -> Any:
    """The mean of the slopes of a cell's corners."""
    x, y, z = 0.0, 0.0, 0.0
    for k in range(4):
        one = corners.slopes[cell[k]]
        x, y, z = x + weights[k] * one[0], y + weights[k] * one[1], z + weights[k] * one[2]
    return x, y, z


@numba.njit(cache=True)
def _best_bound(family: Any, corners: Any, cell: Any, weights: Any, enough: float) -> float:
    """The bound with the best weights found, from those given, which are changed in place."""
    best, point = -np.inf, _mean(corners, cell, weights)
    for _ in range(SHIFTS):
        matrix = _matrix_at(family, point)
        if matrix[0] == 0:
            break
        bound = _bound_with(family, corners, cell, matrix)
        low, high, lost = _extremes(corners, cell, weights, matrix)
        best = max(best, bound)
        if best >= enough or bound + lost < enough or low == high:
            break
        pair = cell[low], cell[high]
        taken = _shift(family, corners, pair, point, weights[high])
        if taken <= 0:
            break
        point = _moved(corners, pair, point, taken)
        weights[low] += taken
        weights[high] -= taken
    return best


@numba.njit(cache=True)
def clipped_middle(corners: Any, cell: Any, low: float) -> Any:
    """The middle of a cell in the coordinates, clipped as by :func:`_clipped`."""
    a, b, c = 0.0, 0.0, 0.0
    for k in cell:
        a, b, c = a + corners.white[k, 0] / 4, b + corners.white[k, 1] / 4, c + corners.white[k, 2] / 4
    return _clipped((a, b, c), low)


@numba.njit(cache=True)
def _start(corners: Any, cell: Any, weights: Any) -> None:
    """The same weight for all corners that are some matrix's gradient, or for all."""
    for k in range(4):
        a, b, c = corners.white[cell[k]]
        weights[k] = 1.0 if a + c > 0 and a * c - b * b > SAFELY * (a + c) ** 2 else 0.0
    weights[:] = weights / weights.sum() if weights.sum() > 0 else np.full(4, 0.25)


@numba.njit(cache=True)
def cell_bound(family: Any, corners: Any, cell: Any, setting: Any, weights: Any, enough: float) -> float:  # noqa: PLR0917
    """What choices of the only target of a family are worth at least whose gradients are in a cell; infinite for none.

    ``cell`` (4,) : of corners; ``setting`` : axes of the coordinates, and the least eigenvalue of a gradient there;
    ``weights`` (4,) : become those of the corners, or 0; ``enough`` : no better bound is needed
    """
    axes, low = setting
    middle, smaller, axis = clipped_middle(corners, cell, low)
    weights[:] = 0.0
    if smaller < low and _is_outside(corners, cell, axis, low):
        return np.inf
    weights[:] = 0.25
    gradient = as_gradient(axes, middle)
    bound = -np.inf
    if gradient[0] * gradient[2] - gradient[1] * gradient[1] > 0:  # not where rounding hides the smaller eigenvalue
        bound = _bound_with(family, corners, cell, matrix_of_gradient(family.code, family.weights[0], gradient))
    if bound < enough:
        bound = max(bound, _bound_with(family, corners, cell, _levelling(corners, cell)))
    if bound < enough:
        if smaller < low:
            _start(corners, cell, weights)
        bound = max(bound, _best_bound(family, corners, cell, weights, enough))
    return bound


@numba.njit(cache=True)
def bound_again(family: Any, corners: Any, cell: Any, setting: Any, weights: Any, enough: float) -> float:  # noqa: PLR0917
    """The same, where ``weights`` are those of a family much like this one: most cells take one matrix or two."""
    low = setting[1]
    if weights.sum() > 0:
        bound = _bound_with(family, corners, cell, _matrix_at(family, _mean(corners, cell, weights)))
        if bound < enough:
            bound = max(bound, _bound_with(family, corners, cell, _levelling(corners, cell)))
        if bound >= enough:
            return bound
        _, smaller, axis = clipped_middle(corners, cell, low)
        if not (smaller < low and _is_outside(corners, cell, axis, low)):
            return max(bound, _best_bound(family, corners, cell, weights, enough))
    return cell_bound(family, corners, cell, setting, weights, enough)
