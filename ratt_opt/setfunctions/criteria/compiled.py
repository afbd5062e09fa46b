"""The criteria, compiled: of planar targets as ``two_by_two.py`` has them; imported only if such loops are used.

``code`` is a criterion's ``compiled_code``; symmetric matrices are packed by rows of the lower triangle, so that planar
ones are ``(a, b, c)`` triples of ``[[a, b], [b, c]]``.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from ratt_opt.running.compiling import numba
from ratt_opt.setfunctions.criteria import two_by_two
from ratt_opt.setfunctions.criteria.logdet import LogDetObjective
from ratt_opt.setfunctions.criteria.trace import TraceObjective

__all__ = ["matrix_of_gradient", "target_gradient", "target_value", "team_criteria", "team_criterion"]

PLANAR, SPATIAL, FOUR = 3, 6, 10
"""Entries of packed matrices of two, three and four dimensions."""
TRACE, LOG_DET = TraceObjective.compiled_code, LogDetObjective.compiled_code

_determinant = numba.njit(two_by_two.determinant)
_trace_of_inverse = numba.njit(two_by_two.trace_of_inverse)
_largest_of_inverse = numba.njit(two_by_two.largest_of_inverse)
_trace_gradient = numba.njit(two_by_two.trace_gradient)
_logdet_gradient = numba.njit(two_by_two.logdet_gradient)
_of_trace_gradient = numba.njit(two_by_two.matrix_of_trace_gradient)
_of_logdet_gradient = numba.njit(two_by_two.matrix_of_logdet_gradient)


@numba.njit(cache=True)
def _determinant_and_trace(packed: Any) -> Any:
    """The determinant of a packed matrix, and the trace of its inverse."""
    if len(packed) != SPATIAL and len(packed) != FOUR:
        factor, inverse = _inverse_factor(packed)
        return np.prod(np.diag(factor)) ** 2, (inverse * inverse).sum()
    a, b, c, d, e, f = packed[0], packed[1], packed[2], packed[3], packed[4], packed[5]
    low, left = b / a, d / a  # unit lower triangular factor L, L D L', and the last row of its inverse
    second = c - b * low
    rest = e - d * low
    right = rest / second
    third = f - d * left - rest * right
    corner = low * right - left
    determinant = a * second * third
    trace = 1 / a + (1 + low * low) / second + (1 + right * right + corner * corner) / third
    if len(packed) == FOUR:
        g, h, i, j = packed[6], packed[7], packed[8], packed[9]
        x, y_rest = g / a, h - g * low
        y, z_rest = y_rest / second, i - g * left - y_rest * right
        z = z_rest / third
        fourth = j - g * x - y_rest * y - z_rest * z
        one, two = y * low - x - z * corner, z * right - y
        determinant *= fourth
        trace += (1 + z * z + two * two + one * one) / fourth
    return determinant, trace


@numba.njit(cache=True)
def _inverse_factor(packed: Any) -> Any:
    """Cholesky factor (d, d) of a packed matrix, and its inverse."""
    d = int((np.sqrt(8.0 * len(packed) + 1.0) - 1.0) / 2.0 + 0.5)
    factor, inverse = np.zeros((d, d)), np.zeros((d, d))
    for i in range(d):
        for j in range(i + 1):
            rest = packed[i * (i + 1) // 2 + j]
            for k in range(j):
                rest -= factor[i, k] * factor[j, k]
            factor[i, j] = np.sqrt(rest) if i == j else rest / factor[j, j]
    for j in range(d):
        inverse[j, j] = 1.0 / factor[j, j]
        for i in range(j + 1, d):
            rest = 0.0
            for k in range(j, i):
                rest -= factor[i, k] * inverse[k, j]
            inverse[i, j] = rest / factor[i, i]
    return factor, inverse


@numba.njit(cache=True)
def _largest_eigenvalue(packed: Any) -> float:
    """Of the inverse ``L^{-1}' L^{-1}`` of a packed matrix."""
    _, inverse = _inverse_factor(packed)
    return float(np.linalg.eigvalsh(inverse.T @ inverse)[-1])


@numba.njit(cache=True)
def _of_any_dimension(code: int, weights: Any, matrices: Any) -> float:
    total, product = 0.0, 1.0
    for j in range(matrices.shape[0]):
        determinant, trace = _determinant_and_trace(matrices[j])
        if code == TRACE:
            total += weights[j] * trace
        elif code == LOG_DET and weights[j] == weights[0]:
            product *= determinant
            if product > 1e150 or product < 1e-150:
                total -= weights[0] * np.log(product)
                product = 1.0
        elif code == LOG_DET:
            total -= weights[j] * np.log(determinant)
        elif weights[j] * trace > total:  # the largest eigenvalue is no larger
            total = max(total, weights[j] * _largest_eigenvalue(matrices[j]))
    return total if code != LOG_DET else total - weights[0] * np.log(product)


@numba.njit(cache=True)
def team_criterion(code: int, weights: Any, matrices: Any) -> float:
    """Weighted criterion over all targets, lower is better, of packed matrices: (M,), (M, T) -> scalar."""
    if matrices.shape[1] != PLANAR:
        return float(_of_any_dimension(code, weights, matrices))
    total, product = 0.0, 1.0
    for j in range(matrices.shape[0]):
        a, b, c = matrices[j, 0], matrices[j, 1], matrices[j, 2]
        if code == TRACE:
            total += weights[j] * _trace_of_inverse(a, b, c)
        elif code == LOG_DET and weights[j] == weights[0]:
            product *= _determinant(a, b, c)  # one logarithm for many targets
            if product > 1e150 or product < 1e-150:
                total -= weights[0] * np.log(product)
                product = 1.0
        elif code == LOG_DET:
            total -= weights[j] * np.log(_determinant(a, b, c))
        else:
            total = max(total, weights[j] * _largest_of_inverse(a, b, c))
    return total if code != LOG_DET else total - weights[0] * np.log(product)


@numba.njit(cache=True)
def team_criteria(code: int, weights: Any, matrices: Any) -> Any:
    """The same of many teams: (K, M, T) -> (K,)."""
    criteria = np.empty(len(matrices))
    for k in range(len(matrices)):
        criteria[k] = team_criterion(code, weights, matrices[k])
    return criteria


@numba.njit(cache=True)
def target_value(code: int, weight: float, prior: Any, matrix: Any) -> float:
    """One target's value, trace or log-det, of a triple; minus infinity if it is not positive definite."""
    a, b, c = matrix
    determinant = _determinant(a, b, c)
    if not (determinant > 1e-12 * (a + c) ** 2 and a + c > 0):
        return -np.inf
    if code == TRACE:
        return float(weight * (_trace_of_inverse(prior[0], prior[1], prior[2]) - _trace_of_inverse(a, b, c)))
    return float(weight * np.log(determinant / _determinant(prior[0], prior[1], prior[2])))


@numba.njit(cache=True)
def target_gradient(code: int, weight: float, matrix: Any) -> Any:
    """Slopes in (a, b, c) of one target's value, trace or log-det, at a triple."""
    a, b, c = matrix
    x, y, z = _trace_gradient(a, b, c) if code == TRACE else _logdet_gradient(a, b, c)
    return weight * x, weight * y, weight * z


@numba.njit(cache=True)
def matrix_of_gradient(code: int, weight: float, gradient: Any) -> Any:
    """The triple at which one target's value has a positive definite gradient, given as a triple of a matrix."""
    a, b, c = gradient[0] / weight, gradient[1] / weight, gradient[2] / weight
    return _of_trace_gradient(a, b, c) if code == TRACE else _of_logdet_gradient(a, b, c)
